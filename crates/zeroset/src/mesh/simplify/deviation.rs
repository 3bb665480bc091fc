//! How far two surfaces are apart, and what the one can tell the other.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::cloud::Attributes;
use crate::mesh::{Mesh, OneWay};
use crate::monitor::{Cancelled, Monitor, Steps};
use crate::sample::sample_surface;
use crate::spatial::TriangleTree;
use crate::vec3::{self, Vec3};

/// Samples on each surface: one for each triangle of the larger mesh, within these.
const SAMPLES: [usize; 2] = [100_000, 1_000_000];
/// Samples that are searched between two looks at the monitor.
const CHUNK: usize = 1 << 12;

/// Distances between the original and the simplified surface, in the mesh's unit. Mean, root of the mean square and
/// percentile are over samples spread by area; the maximum is over the vertices, too.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Deviation {
    /// From the original to the simplified surface.
    pub original_to_simplified: OneWay,
    /// From the simplified to the original surface.
    pub simplified_to_original: OneWay,
}

impl Deviation {
    /// The largest distance either way.
    #[must_use]
    pub fn max(&self) -> f64 {
        self.original_to_simplified.max.max(self.simplified_to_original.max)
    }

    /// Measures both ways; `None` if a surface has no area.
    pub(super) fn between(
        original: (&Mesh, &TriangleTree),
        simplified: &Mesh,
        monitor: &dyn Monitor,
    ) -> Result<Option<Self>, Cancelled> {
        let samples = original.0.triangles.len().clamp(SAMPLES[0], SAMPLES[1]);
        let tree = TriangleTree::new(simplified);
        let total = 2 * samples + original.0.vertices.len() + simplified.vertices.len();
        let steps = Steps::new(monitor, 0.0..1.0, total);
        let forth = one_way(original.0, &tree, samples, &steps)?;
        let back = one_way(simplified, original.1, samples, &steps)?;
        Ok(forth.zip(back).map(|(original_to_simplified, simplified_to_original)| Self {
            original_to_simplified,
            simplified_to_original,
        }))
    }
}

fn one_way(from: &Mesh, to: &TriangleTree, samples: usize, steps: &Steps) -> Result<Option<OneWay>, Cancelled> {
    let distances = |points: &[Vec3]| -> Result<Vec<f64>, Cancelled> {
        let chunks = points.par_chunks(CHUNK).map(|chunk| {
            let near = chunk.iter().filter_map(|&p| to.closest(p));
            let distances: Vec<f64> = near.map(|closest| closest.distance_squared.sqrt()).collect();
            steps.advance(chunk.len()).map(|()| distances)
        });
        Ok(chunks.collect::<Result<Vec<_>, _>>()?.concat())
    };
    let Some(spread) = sample_surface(from, samples, 0) else { return Ok(None) };
    let farthest = distances(&used(from))?.into_iter().fold(0.0, f64::max);
    Ok(OneWay::of(distances(&spread.points)?).map(|all| OneWay { max: all.max.max(farthest), ..all }))
}

/// The vertices that triangles use.
fn used(mesh: &Mesh) -> Vec<Vec3> {
    let mut used = vec![false; mesh.vertices.len()];
    for &v in mesh.triangles.iter().flatten() {
        used[v as usize] = true;
    }
    mesh.vertices.iter().zip(used).filter(|(_, used)| *used).map(|(v, _)| *v).collect()
}

/// The values of the original at the place nearest to each vertex: colours and intensities are interpolated within the triangle
/// there, the class is that of its corner with the greatest weight.
pub(super) fn carried(original: &Mesh, tree: &TriangleTree, vertices: &[Vec3]) -> Attributes {
    let from = &original.attributes;
    if from.colors.is_none() && from.intensities.is_none() && from.classes.is_none() {
        return Attributes::default();
    }
    let place = |&v: &Vec3| -> ([usize; 3], [f64; 3]) {
        let Some(closest) = tree.closest(v) else { return ([0; 3], [1.0, 0.0, 0.0]) };
        let triangle = original.triangles[closest.triangle].map(|v| v as usize);
        (triangle, weights(triangle.map(|v| original.vertices[v]), closest.position))
    };
    let places: Vec<_> = vertices.par_iter().map(place).collect();
    let mean = |value: &dyn Fn(usize) -> f64, (corners, weights): &([usize; 3], [f64; 3])| {
        corners.iter().zip(weights).map(|(&corner, weight)| weight * value(corner)).sum::<f64>()
    };
    let heaviest = |(corners, weights): &([usize; 3], [f64; 3])| {
        corners[(0..3).fold(0, |best, i| if weights[i] > weights[best] { i } else { best })]
    };
    Attributes {
        colors: from.colors.as_ref().map(|values| {
            let channel = |place, c: usize| mean(&|v| f64::from(values[v][c]), place).round() as u8;
            places.iter().map(|place| [0, 1, 2].map(|c| channel(place, c))).collect()
        }),
        intensities: from
            .intensities
            .as_ref()
            .map(|values| places.iter().map(|place| mean(&|v| f64::from(values[v]), place) as f32).collect()),
        classes: from.classes.as_ref().map(|values| places.iter().map(|place| values[heaviest(place)]).collect()),
    }
}

/// The weights of the corners at a position in a triangle, by areas; the first corner's alone without an area.
fn weights([a, b, c]: [Vec3; 3], position: Vec3) -> [f64; 3] {
    let normal = vec3::cross(vec3::sub(b, a), vec3::sub(c, a));
    let area =
        |p: Vec3, q: Vec3| vec3::dot(vec3::cross(vec3::sub(p, position), vec3::sub(q, position)), normal).max(0.0);
    let areas = [area(b, c), area(c, a), area(a, b)];
    let sum: f64 = areas.iter().sum();
    if sum > 0.0 { areas.map(|area| area / sum) } else { [1.0, 0.0, 0.0] }
}
