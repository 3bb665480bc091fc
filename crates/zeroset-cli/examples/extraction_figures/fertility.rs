//! A noisy cloud of a known body, fitted and extracted with each placement.

use std::path::Path;
use std::time::Instant;

use zeroset::contour::{ContourParams, contour_with};
use zeroset::fit::cascade::{FitParams, Scene, fit};
use zeroset::mesh::{CompareParams, Mesh, compare};
use zeroset::sample::sample_surface;

/// Points of the cloud, and the deviation of their noise in parts of the diagonal of the body.
const POINTS: usize = 100_000;
const NOISE_REL: [f64; 2] = [0.0, 0.002];

pub(crate) fn figures(path: &Path) -> Result<String, Box<dyn std::error::Error>> {
    let truth = zeroset_io::read_mesh(path)?;
    let diagonal = diagonal(&truth);
    let samples = sample_surface(&truth, POINTS, 1).ok_or("the body has no area")?;
    let resolution = 1.5 * (area(&truth) / POINTS as f64).sqrt();
    let mut text = format!(
        "\n## Fertility\n\n{POINTS} points of the body, fitted with cells of {:.4} of its diagonal. Distance is the mean both ways, in thousandths of the diagonal. Noise is normal along each axis, in parts of the diagonal.\n\n| noise | placement | distance | normal consistency | extraction, s |\n|--:|---|--:|--:|--:|\n",
        resolution / diagonal
    );
    for noise in NOISE_REL {
        let points = shaken(&samples.points, noise * diagonal);
        let (field, _) = fit(&points, &FitParams::new(Scene::Object, resolution), &())?;
        for (name, placement) in crate::placements() {
            let start = Instant::now();
            let (mesh, _) = contour_with(&field, &ContourParams { placement }, |_| true);
            let seconds = start.elapsed().as_secs_f64();
            let mesh = Mesh { world_from_local: truth.world_from_local, ..mesh };
            let report = compare(&mesh, &truth, &CompareParams::default(), &())?;
            text += &format!(
                "| {noise} | {name} | {:.4} | {:.4} | {seconds:.2} |\n",
                1e3 * report.overall.distances.combined.mean / diagonal,
                report.overall.normal_consistency
            );
        }
    }
    Ok(text)
}

fn diagonal(mesh: &Mesh) -> f64 {
    let end = |pick: fn(f64, f64) -> f64, start: f64| -> [f64; 3] {
        std::array::from_fn(|a| mesh.vertices.iter().fold(start, |end, v| pick(end, v[a])))
    };
    let (low, high) = (end(f64::min, f64::INFINITY), end(f64::max, f64::NEG_INFINITY));
    crate::shapes::norm(crate::shapes::minus(high, low))
}

fn area(mesh: &Mesh) -> f64 {
    use crate::shapes::{cross, minus, norm};
    let triangle = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| mesh.vertices[v as usize]);
        0.5 * norm(cross(minus(b, a), minus(c, a)))
    };
    mesh.triangles.iter().map(triangle).sum()
}

/// Points with normal noise (Box and Muller 1958) from a linear congruential generator (Knuth's MMIX).
fn shaken(points: &[[f64; 3]], deviation: f64) -> Vec<[f64; 3]> {
    let mut state = 1_u64;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    };
    let mut normal = || (-2.0 * uniform().ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos();
    points.iter().map(|p| p.map(|c| c + deviation * normal())).collect()
}
