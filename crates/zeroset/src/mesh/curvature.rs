//! How much a mesh bends at its vertices.

use super::{Mesh, MeshError};
use crate::vec3::{self, Vec3};

/// The cotangent beyond which an angle counts as no larger or smaller: 0.6 degrees. A sliver must not decide alone.
const MOST_COTANGENT: f64 = 100.0;

/// The mean curvature at each vertex: the mean of the two principal curvatures, one over a length. Positive where the surface is convex
/// seen from outside, 1/r on a ball of radius r. `None` at borders, and where there is no area.
///
/// The cotangent formula: H n = (1 / 4 A) sum over edges of (cot a + cot b) (x - y), with the angles a and b across the edge from x to y, and A a third
/// of the area of the triangles around x.
///
/// # Errors
/// If a triangle names a vertex that is not there, or a coordinate is not finite.
///
/// Source: Meyer, Desbrun, Schroeder, Barr 2003, equation 8, with a third of the triangles for the mixed area.
///
/// ```
/// use zeroset::mesh::mean_curvature;
/// use zeroset::sample::{Scene, SceneKind};
/// let ball = Scene::new(SceneKind::Sphere, 0).truth;
/// let radius = ball.vertices[0].iter().map(|c| c * c).sum::<f64>().sqrt();
/// let found = mean_curvature(&ball)?;
/// let mean = found.iter().flatten().sum::<f64>() / found.len() as f64;
/// assert!((mean * radius - 1.0).abs() < 0.01);
/// # Ok::<(), zeroset::mesh::MeshError>(())
/// ```
pub fn mean_curvature(mesh: &Mesh) -> Result<Vec<Option<f64>>, MeshError> {
    let edges = super::Edges::new(mesh)?;
    let n = mesh.vertices.len();
    let (mut bends, mut normals, mut areas) = (vec![[0.0; 3]; n], vec![[0.0; 3]; n], vec![0.0; n]);
    for triangle in &mesh.triangles {
        let corners = triangle.map(|v| v as usize);
        let positions = corners.map(|v| mesh.vertices[v]);
        let normal = across(positions);
        let double_area = vec3::norm(normal);
        if double_area == 0.0 {
            continue;
        }
        for k in 0..3 {
            let [opposite, from, to] = [0, 1, 2].map(|step| (k + step) % 3);
            let sides = [from, to].map(|end| vec3::sub(positions[end], positions[opposite]));
            let cotangent = (vec3::dot(sides[0], sides[1]) / double_area).clamp(-MOST_COTANGENT, MOST_COTANGENT);
            let edge = vec3::sub(positions[from], positions[to]);
            bends[corners[from]] = vec3::add_scaled(bends[corners[from]], edge, cotangent);
            bends[corners[to]] = vec3::add_scaled(bends[corners[to]], edge, -cotangent);
            normals[corners[k]] = vec3::add(normals[corners[k]], normal);
            areas[corners[k]] += double_area / 6.0;
        }
    }
    let mut is_border = vec![false; n];
    for edge in edges.iter().filter(|edge| edge.count() == 1) {
        (is_border[edge.low as usize], is_border[edge.high as usize]) = (true, true);
    }
    let value = |v: usize| {
        let normal = vec3::normalized(normals[v])?;
        (!is_border[v] && areas[v] > 0.0).then(|| vec3::dot(bends[v], normal) / (4.0 * areas[v]))
    };
    Ok((0..n).map(value).collect())
}

/// Twice the area of a triangle, along its normal.
fn across([a, b, c]: [Vec3; 3]) -> Vec3 {
    vec3::cross(vec3::sub(b, a), vec3::sub(c, a))
}
