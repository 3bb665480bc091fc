//! Seeded scenes with a known truth.
//!
//! # What
//! A [`Scene`] is an exact mesh, the truth, from which [`Scene::points`] draws raw clouds as a scanner would: positions
//! with noise, without normals. Tests, benches and examples stand on them. [`sample_surface`] spreads points over
//! any mesh by area.
//!
//! # The scenes
//! | kind | truth | points | noise by default |
//! |---|---|---|---|
//! | `city` | open ground, the unit square at z = 0, one connected surface with 40 houses welded to it: sides 0.03 to 0.1, up to 0.21 high, flat, gable and hip roofs | by area | 0.001 |
//! | `airborne-city` | the same | by a simulated airborne scanner (module `airborne`): walls are nearly bare | 0.001 along the ray, 0.0002 in each direction |
//! | `sphere` | radius 0.5 around the origin, 81,920 triangles | on the exact sphere | 0.001 |
//! | `torus` | radii 0.35 and 0.15 around z, 262,144 triangles | on the exact torus | 0.001 |
//! | `box` | 1 x 0.8 x 0.6 | by area | 0.001 |
//! | `l-block` | an L of 1 x 0.8, arms 0.4 and 0.3 wide, 0.5 high | by area | 0.001 |
//! | `stairs` | five steps, 1 long, 0.6 wide, 0.5 high | by area | 0.001 |
//! | `pocket-plate` | a plate of 1 x 0.7 x 0.15 with four pockets; floor and walls 0.01 thick | by area | 0.001 |
//!
//! Noise is Gaussian, the same in all directions but for `airborne-city`. All truths but the cities' are closed.
//! Triangles are counter-clockwise from outside, or from above the ground.
//!
//! # Guaranteed
//! Equal arguments give equal bytes on any number of threads. Exactly the wanted number of points.
//!
//! # Not guaranteed
//! Equal bytes on different platforms: sine and logarithm differ in the last bit between mathematics libraries. Points
//! come in the order in which they were made (along the triangles, or along the flight), not shuffled.
//!
//! ```
//! use zeroset::sample::{Scene, SceneKind};
//!
//! let scene = Scene::new(SceneKind::LBlock, 0);
//! let cloud = scene.points(1000, scene.kind.default_noise(), 7);
//! assert_eq!(cloud.len(), 1000);
//! assert_eq!("l-block".parse::<SceneKind>().unwrap(), SceneKind::LBlock);
//! ```

mod airborne;
mod city;
mod curved;
mod random;
mod solids;
mod surface;

#[cfg(test)]
mod tests;

pub(crate) use random::Chance;
pub use surface::{SurfaceSamples, sample_surface};

use crate::cloud::Cloud;
use crate::mesh::Mesh;
use crate::vec3::{self, Vec3};
use random::CHUNK;
use rayon::prelude::*;
use std::{fmt, str::FromStr};

/// What a scene shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SceneKind {
    /// Open ground with 40 houses, sampled by area.
    City,
    /// The city under a simulated airborne scanner.
    AirborneCity,
    /// A sphere.
    Sphere,
    /// A torus.
    Torus,
    /// A box.
    Box,
    /// An L-shaped block.
    LBlock,
    /// A flight of stairs.
    Stairs,
    /// A thin plate with pockets milled into it.
    PocketPlate,
}

impl SceneKind {
    /// All kinds, in the order in which they are listed for people.
    pub const ALL: [Self; 8] = [
        Self::City,
        Self::AirborneCity,
        Self::Sphere,
        Self::Torus,
        Self::Box,
        Self::LBlock,
        Self::Stairs,
        Self::PocketPlate,
    ];

    /// The name that [`FromStr`] understands.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::City => "city",
            Self::AirborneCity => "airborne-city",
            Self::Sphere => "sphere",
            Self::Torus => "torus",
            Self::Box => "box",
            Self::LBlock => "l-block",
            Self::Stairs => "stairs",
            Self::PocketPlate => "pocket-plate",
        }
    }

    /// The noise to use where the user names none: 0.001 of the scene's unit length. On the pocket plate that is a
    /// tenth of its walls.
    #[must_use]
    pub fn default_noise(self) -> f64 {
        0.001
    }
}

impl fmt::Display for SceneKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that is no scene's.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("no scene is called '{name}'; known are {}", SceneKind::ALL.map(SceneKind::name).join(", "))]
pub struct UnknownScene {
    /// The name as given.
    pub name: String,
}

impl FromStr for SceneKind {
    type Err = UnknownScene;

    fn from_str(name: &str) -> Result<Self, UnknownScene> {
        let found = Self::ALL.into_iter().find(|kind| kind.name() == name);
        found.ok_or_else(|| UnknownScene { name: name.to_owned() })
    }
}

/// A scene: its truth, and clouds of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// What it shows.
    pub kind: SceneKind,
    /// The exact surface; for sphere and torus a fine mesh inscribed in it.
    pub truth: Mesh,
}

impl Scene {
    /// Builds the truth. `seed` lays out the houses of the cities (both kinds alike); the other kinds do not use it.
    #[must_use]
    pub fn new(kind: SceneKind, seed: u64) -> Self {
        let truth = match kind {
            SceneKind::City | SceneKind::AirborneCity => city::city(seed),
            SceneKind::Sphere => curved::sphere(),
            SceneKind::Torus => curved::torus(),
            SceneKind::Box => solids::brick(),
            SceneKind::LBlock => solids::l_block(),
            SceneKind::Stairs => solids::stairs(),
            SceneKind::PocketPlate => solids::pocket_plate(),
        };
        Self { kind, truth }
    }

    /// `n` points with Gaussian noise of deviation `noise` (its absolute value; 0 for none).
    #[must_use]
    pub fn points(&self, n: usize, noise: f64, seed: u64) -> Cloud {
        let noise = noise.abs();
        let points = match self.kind {
            SceneKind::AirborneCity => airborne::survey(&self.truth, n, noise, seed),
            SceneKind::Sphere => scatter(n, noise, seed, curved::on_sphere),
            SceneKind::Torus => scatter(n, noise, seed, curved::on_torus),
            _ => {
                let samples = sample_surface(&self.truth, n, seed).expect("the truth has area");
                let mut points = samples.points;
                points.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, points)| {
                    let mut chance = Chance::new(seed, 5, chunk);
                    for point in points {
                        *point = vec3::add(*point, chance.normal3(noise));
                    }
                });
                points
            }
        };
        Cloud { points, ..Cloud::default() }
    }
}

/// `n` points of an exact surface, with noise.
fn scatter(n: usize, noise: f64, seed: u64, on_surface: impl Fn(&mut Chance) -> Vec3 + Sync) -> Vec<Vec3> {
    let mut points = vec![[0.0; 3]; n];
    points.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, points)| {
        let mut chance = Chance::new(seed, 6, chunk);
        for point in points {
            *point = vec3::add(on_surface(&mut chance), chance.normal3(noise));
        }
    });
    points
}
