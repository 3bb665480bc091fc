//! A simulated airborne laser scanner.
//!
//! # What
//! Three parallel flight lines over the unit square. From each the scanner sends pulses in lines across the track,
//! evenly in angle; a pulse that meets the truth gives one point, if enough of it comes back.
//!
//! # Model
//! - Flight height 0.65, scan angle to +-25 degrees, neighbouring strips overlap by 30 % of their width on the ground.
//!   Scan lines are 1.4 times as far apart as the pulses in them.
//! - Occlusion is real: each pulse is a ray cast against the truth, and the first surface wins.
//! - A surface met at a grazing angle returns little: a pulse is kept with probability s^2 (3 - 2 s), where s runs from
//!   0 to 1 while the cosine of the angle of incidence runs from 0 to 0.5. Roofs and ground keep nearly all.
//! - The range is off by Gaussian noise of the given deviation; a fifth of it is added in every direction for the
//!   pointing.
//!
//! The density of points on walls comes out at about 3 % of that on roofs.
//!
//! # Cost
//! One ray a pulse, about a microsecond each; some of the pulses fall beside the square or are lost at walls. Beyond
//! the points themselves the memory does not grow with their number.
//!
//! # Not modelled
//! Several echoes of one pulse, the width of the beam, terrain, plants, and errors of the aircraft's own position.

use super::random::{CHUNK, Chance};
use crate::mesh::Mesh;
use crate::spatial::TriangleTree;
use crate::vec3::{self, Vec3};
use rayon::prelude::*;

/// Height of flight over the ground.
const HEIGHT: f64 = 0.65;
/// The largest scan angle, in degrees.
const HALF_ANGLE_DEG: f64 = 25.0;
/// Number of flight lines, evenly spread over the square.
const FLIGHT_LINES: usize = 3;
/// Distance between neighbouring flight lines: 0.7 of the strip's width of 0.606.
const LINE_SPACING: f64 = 0.424;
/// Distance between scan lines over distance between pulses in them.
const SCAN_LINE_RATIO: f64 = 1.4;
/// Cosines of the angle of incidence at which no pulse and every pulse returns. Set so that walls hold 3 % of the
/// density of roofs: with 0.1 and 0.6, and 22 degrees, they hold 1 %.
const RETURNING: [f64; 2] = [0.0, 0.5];
/// Deviation of the pointing noise over that of the range noise.
const POINTING: f64 = 0.2;
/// Pulses that measure which share returns.
const PILOT: usize = 1 << 14;
/// Chunks that are worked on before their points are stored.
const WAVE: usize = 32;

/// Where the pulses of one survey go.
struct Plan {
    pulses_per_line: usize,
    lines_per_strip: usize,
}

impl Plan {
    /// A plan with at least `pulses` pulses.
    fn new(pulses: usize) -> Self {
        let strip = pulses.div_ceil(FLIGHT_LINES) as f64;
        let swath = 2.0 * HEIGHT * HALF_ANGLE_DEG.to_radians().tan();
        let pulses_per_line = (SCAN_LINE_RATIO * swath * strip).sqrt().ceil().max(1.0);
        Self { pulses_per_line: pulses_per_line as usize, lines_per_strip: (strip / pulses_per_line).ceil() as usize }
    }

    fn pulses(&self) -> usize {
        FLIGHT_LINES * self.pulses_per_line * self.lines_per_strip
    }

    /// Where pulse `i` starts and where it goes.
    fn pulse(&self, i: usize, chance: &mut Chance) -> (Vec3, Vec3) {
        let (strip, i) =
            (i / (self.pulses_per_line * self.lines_per_strip), i % (self.pulses_per_line * self.lines_per_strip));
        let (line, place) = (i / self.pulses_per_line, i % self.pulses_per_line);
        // Vibration moves a pulse by up to a quarter of a step.
        let across = (place as f64 + 0.5 + chance.between(-0.25, 0.25)) / self.pulses_per_line as f64;
        let along = (line as f64 + 0.5 + chance.between(-0.25, 0.25)) / self.lines_per_strip as f64;
        let x = 0.5 + LINE_SPACING * (strip as f64 - 0.5 * (FLIGHT_LINES - 1) as f64);
        // The aircraft turns at the end of each line, so every other strip is flown back.
        let y = if strip % 2 == 0 { along } else { 1.0 - along };
        let angle = HALF_ANGLE_DEG.to_radians() * (2.0 * across - 1.0);
        ([x, y, HEIGHT], [angle.sin(), 0.0, -angle.cos()])
    }
}

/// The truth made ready for pulses.
struct Target<'a> {
    tree: TriangleTree,
    mesh: &'a Mesh,
}

impl Target<'_> {
    fn echo(&self, (origin, direction): (Vec3, Vec3), noise: f64, chance: &mut Chance) -> Option<Vec3> {
        let hit = self.tree.ray(origin, direction)?;
        let [a, b, c] = self.mesh.triangles[hit.triangle].map(|v| self.mesh.vertices[v as usize]);
        let normal = vec3::normalized(vec3::cross(vec3::sub(b, a), vec3::sub(c, a)))?;
        let [low, high] = RETURNING;
        let s = ((vec3::dot(normal, direction).abs() - low) / (high - low)).clamp(0.0, 1.0);
        if chance.uniform() >= s * s * (3.0 - 2.0 * s) {
            return None;
        }
        let measured = vec3::add_scaled(hit.position, direction, noise * chance.normal());
        Some(vec3::add(measured, chance.normal3(POINTING * noise)))
    }
}

/// Exactly `n` points of a survey of `mesh`, the city; range noise of deviation `noise`. In the order of the pulses.
pub(super) fn survey(mesh: &Mesh, n: usize, noise: f64, seed: u64) -> Vec<Vec3> {
    let target = Target { tree: TriangleTree::new(mesh), mesh };
    let pilot = fly(&target, &Plan::new(PILOT), noise, seed, 3, PILOT);
    let share = pilot.len() as f64 / Plan::new(PILOT).pulses() as f64;
    let mut wanted = n as f64 / share * 1.03 + 100.0;
    loop {
        let mut points = fly(&target, &Plan::new(wanted as usize), noise, seed, 4, n);
        if points.len() >= n {
            thin(&mut points, n);
            return points;
        }
        wanted *= 1.1;
    }
}

/// All echoes of a plan.
fn fly(target: &Target, plan: &Plan, noise: f64, seed: u64, purpose: u64, expected: usize) -> Vec<Vec3> {
    let pulses = plan.pulses();
    let mut points = Vec::with_capacity(expected + expected / 16);
    let chunks: Vec<usize> = (0..pulses.div_ceil(CHUNK)).collect();
    for wave in chunks.chunks(WAVE) {
        let echoes: Vec<Vec<Vec3>> = wave
            .par_iter()
            .map(|&chunk| {
                let mut chance = Chance::new(seed, purpose, chunk);
                let range = chunk * CHUNK..pulses.min((chunk + 1) * CHUNK);
                range.filter_map(|i| target.echo(plan.pulse(i, &mut chance), noise, &mut chance)).collect()
            })
            .collect();
        for part in echoes {
            points.extend(part);
        }
    }
    points
}

/// Keeps `n` of the points, evenly spread over the list.
fn thin(points: &mut Vec<Vec3>, n: usize) {
    let count = points.len() as u128;
    for i in 0..n {
        points[i] = points[(i as u128 * count / n as u128) as usize];
    }
    points.truncate(n);
}
