//! Colours and light of what each sample shows, and pixels of samples.

use rayon::prelude::*;

use super::camera::Camera;
use super::raster::{Frame, OnPicture};
use super::{Background, Picture, View};
use crate::color::Rgb;
use crate::scene::{Layer, Paint, Shape};
use crate::vector;

/// A surface is smooth at a corner whose normal is within 25 degrees of that of the triangle: the cosine.
const SMOOTH: f32 = 0.906;
/// Where the two lamps are: right and up on the picture, and out of it. Of length 1.
const LAMPS: [[f32; 3]; 2] = [[-0.408_248, 0.577_35, std::f32::consts::FRAC_1_SQRT_2], [0.8, 0.0, 0.6]];
/// Shares of light from everywhere, from the sky, and from the lamps.
const SHARES: [f32; 4] = [0.32, 0.16, 0.48, 0.16];
/// What is left of the light on the inside of a surface.
const INSIDE: f32 = 0.66;
/// How much deeper things darken that lie behind their surroundings: surfaces, points, lines.
const DEPTH: [f32; 3] = [40.0, 160.0, 0.0];
/// The least light that depth leaves.
const DARKEST: f32 = 0.25;

/// A sample: its colour, and what it shows; see [`Kind`].
type Sample = [u8; 4];

/// What a sample shows, as its fourth byte.
#[derive(Clone, Copy)]
enum Kind {
    Nothing,
    Surface,
    Points,
    Lines,
}

/// The picture of a frame.
pub(super) fn picture(camera: &Camera, frame: &Frame<'_>, view: &View) -> Picture {
    let normals: Vec<Vec<[f32; 3]>> = frame.layers.iter().map(|on| normals(on.layer, camera)).collect();
    let across = frame.size[0];
    let samples: Vec<Sample> = frame
        .things
        .par_chunks(across)
        .enumerate()
        .flat_map_iter(|(y, row)| {
            let normals = &normals;
            row.iter().enumerate().map(move |(x, &thing)| seen(frame, normals, camera, thing, [x, y]))
        })
        .collect();
    let depths: Vec<f32> = frame
        .nearness
        .par_iter()
        .zip(&samples)
        .map(|(&near, sample)| if sample[3] == Kind::Nothing as u8 { f32::INFINITY } else { camera.log_depth(near) })
        .collect();
    let [width, height] = view.size.map(|side| side as usize);
    let n = view.antialias as usize;
    let pixel = |i: usize| -> [u8; 4] {
        let (x, y) = (i % width, i / width);
        let (mut sum, mut covered) = ([0.0_f32; 3], 0.0_f32);
        for sy in n * y..n * (y + 1) {
            for sx in n * x..n * (x + 1) {
                let sample = samples[sy * across + sx];
                if sample[3] == Kind::Nothing as u8 {
                    continue;
                }
                let light = light_of_depth(&depths, frame.size, [sx, sy], n, DEPTH[usize::from(sample[3]) - 1]);
                covered += 1.0;
                for c in 0..3 {
                    sum[c] += light * f32::from(sample[c]);
                }
            }
        }
        let all = (n * n) as f32;
        match view.background {
            Background::Plain(color) => {
                let [r, g, b] =
                    [0, 1, 2].map(|c| ((sum[c] + (all - covered) * f32::from(color[c])) / all).round() as u8);
                [r, g, b, 255]
            }
            Background::Transparent => {
                let [r, g, b] = sum.map(|c| if covered > 0.0 { (c / covered).round() as u8 } else { 0 });
                [r, g, b, (255.0 * covered / all).round() as u8]
            }
        }
    };
    let pixels = (0..width * height).into_par_iter().map(pixel).collect();
    Picture { size: view.size, pixels }
}

/// How much light is left where the surroundings, a pixel away, are nearer.
fn light_of_depth(depths: &[f32], size: [usize; 2], [x, y]: [usize; 2], step: usize, strength: f32) -> f32 {
    if strength == 0.0 {
        return 1.0;
    }
    let own = depths[y * size[0] + x];
    let mut behind = 0.0;
    for (dx, dy) in [(-1_isize, -1_isize), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)] {
        let place = |c: usize, d: isize, most: usize| c.checked_add_signed(d * step as isize).filter(|&c| c < most);
        if let (Some(nx), Some(ny)) = (place(x, dx, size[0]), place(y, dy, size[1])) {
            behind += (own - depths[ny * size[0] + nx]).max(0.0);
        }
    }
    (-strength * behind / 8.0).exp().max(DARKEST)
}

/// The colour of a sample, with its light.
fn seen(frame: &Frame<'_>, normals: &[Vec<[f32; 3]>], camera: &Camera, thing: u32, [x, y]: [usize; 2]) -> Sample {
    let Some(thing) = thing.checked_sub(1) else { return [0, 0, 0, Kind::Nothing as u8] };
    let number = frame.layers.partition_point(|on| on.first <= thing) - 1;
    // Layers without things share their first number with the next.
    let on = &frame.layers[number];
    let kind = match on.layer.shape {
        Shape::Points { .. } => Kind::Points,
        Shape::Lines { .. } => Kind::Lines,
        Shape::Surface { .. } => Kind::Surface,
    };
    let [r, g, b] = match kind {
        Kind::Surface => on_surface(on, &normals[number], camera, thing, [x as f64 + 0.5, y as f64 + 0.5]),
        _ => color(&on.layer.paint, on.position_of(thing)),
    };
    [r, g, b, kind as u8]
}

fn color(paint: &Paint, position: usize) -> Rgb {
    match paint {
        Paint::Plain(color) => *color,
        Paint::Each(colors) => colors[position],
    }
}

fn on_surface(on: &OnPicture<'_>, normals: &[[f32; 3]], camera: &Camera, thing: u32, [x, y]: [f64; 2]) -> Rgb {
    let Some((triangle, face)) = on.face(thing) else { return [0; 3] };
    let shares = face.shares(x, y);
    let positions = triangle.map(|v| on.layer.positions[v as usize]);
    let own = vector::cross(vector::sub(positions[1], positions[0]), vector::sub(positions[2], positions[0]));
    let own = camera.turned(vector::normalized(own).unwrap_or([0.0, 0.0, 1.0]));
    let mut normal = [0.0_f32; 3];
    let mut base = [0.0_f32; 3];
    for (k, share) in shares.into_iter().enumerate() {
        let v = triangle[k] as usize;
        let at_corner = if dot(normals[v], own) > SMOOTH { normals[v] } else { own };
        let tint = color(&on.layer.paint, v);
        for c in 0..3 {
            normal[c] += share * at_corner[c];
            base[c] += share * f32::from(tint[c]);
        }
    }
    let length = dot(normal, normal).sqrt();
    let side = if face.is_front { 1.0 } else { -1.0 };
    let normal = normal.map(|c| side * c / length.max(f32::MIN_POSITIVE));
    let sky = 0.5 + 0.5 * dot(normal, camera.sky);
    let lamps = LAMPS.map(|lamp| dot(normal, lamp).max(0.0));
    let light = SHARES[0] + SHARES[1] * sky + SHARES[2] * lamps[0] + SHARES[3] * lamps[1];
    let light = if face.is_front { light } else { INSIDE * light };
    base.map(|c| (light * c).round().clamp(0.0, 255.0) as u8)
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The normals at the positions of a surface, as seen by the camera: right, up and out of the picture.
fn normals(layer: &Layer, camera: &Camera) -> Vec<[f32; 3]> {
    let Shape::Surface { triangles } = &layer.shape else { return Vec::new() };
    let mut sums = vec![[0.0; 3]; layer.positions.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|v| layer.positions[v as usize]);
        let normal = vector::cross(vector::sub(b, a), vector::sub(c, a));
        for v in triangle {
            sums[*v as usize] = vector::add(sums[*v as usize], normal);
        }
    }
    sums.into_par_iter().map(|sum| camera.turned(vector::normalized(sum).unwrap_or([0.0; 3]))).collect()
}
