//! The tree of nodes and their transforms.

use serde_json::Value;

/// An affine map: the rows of a 3 x 4 matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Affine(pub(super) [[f64; 4]; 3]);

impl Affine {
    pub(super) const IDENTITY: Self = Self([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]);

    pub(super) fn apply(&self, p: [f64; 3]) -> [f64; 3] {
        self.0.map(|row| row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3])
    }

    /// The map that applies `inner` first.
    fn after(&self, inner: &Self) -> Self {
        Self(self.0.map(|row| {
            std::array::from_fn(|column| {
                let sum: f64 = (0..3).map(|k| row[k] * inner.0[k][column]).sum();
                sum + if column == 3 { row[3] } else { 0.0 }
            })
        }))
    }

    /// Whether it turns the inside out: triangles must then change their order.
    pub(super) fn mirrors(&self) -> bool {
        let [a, b, c] = self.0;
        let determinant = a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0]);
        determinant < 0.0
    }

    /// The local transform of a node: a matrix, or translation after rotation after scale.
    fn of(node: &Value) -> Option<Self> {
        if let Some(matrix) = node.get("matrix") {
            let m: [f64; 16] = numbers(matrix)?;
            // Column after column.
            return Some(Self(std::array::from_fn(|row| std::array::from_fn(|column| m[4 * column + row]))));
        }
        let t: [f64; 3] = node.get("translation").map_or(Some([0.0; 3]), numbers)?;
        let s: [f64; 3] = node.get("scale").map_or(Some([1.0; 3]), numbers)?;
        let q: [f64; 4] = node.get("rotation").map_or(Some([0.0, 0.0, 0.0, 1.0]), numbers)?;
        let norm = q.iter().map(|c| c * c).sum::<f64>().sqrt();
        if !(norm > 0.0 && norm.is_finite()) {
            return None;
        }
        let [x, y, z, w] = q.map(|c| c / norm);
        let rotation = [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ];
        Some(Self(std::array::from_fn(|i| [rotation[i][0] * s[0], rotation[i][1] * s[1], rotation[i][2] * s[2], t[i]])))
    }
}

fn numbers<const N: usize>(value: &Value) -> Option<[f64; N]> {
    let values: Vec<f64> = value.as_array()?.iter().map(Value::as_f64).collect::<Option<_>>()?;
    values.try_into().ok()
}

/// The meshes that the scene shows, each with its transform, in the order of the tree.
///
/// `None` if the nodes are no tree or one of them is damaged.
pub(super) fn placed_meshes(root: &Value) -> Option<Vec<(usize, Affine)>> {
    let list = |key: &str| root.get(key).and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let index = |value: &Value| value.as_u64().and_then(|i| usize::try_from(i).ok());
    let (nodes, scenes) = (list("nodes"), list("scenes"));
    if scenes.is_empty() || nodes.is_empty() {
        // A library of meshes without a scene: take each as it is.
        return Some((0..list("meshes").len()).map(|mesh| (mesh, Affine::IDENTITY)).collect());
    }
    let scene = scenes.get(root.get("scene").map_or(Some(0), index)?)?;
    let roots = scene.get("nodes").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let mut stack = Vec::new();
    for node in roots.iter().rev() {
        stack.push((index(node)?, Affine::IDENTITY));
    }
    let mut seen = vec![false; nodes.len()];
    let mut meshes = Vec::new();
    while let Some((at, outer)) = stack.pop() {
        let node = nodes.get(at)?;
        // A node has one parent. Without this check a short file could ask for any number of copies.
        if std::mem::replace(seen.get_mut(at)?, true) {
            return None;
        }
        let transform = outer.after(&Affine::of(node)?);
        if let Some(mesh) = node.get("mesh") {
            meshes.push((index(mesh)?, transform));
        }
        for child in node.get("children").and_then(Value::as_array).into_iter().flatten().rev() {
            stack.push((index(child)?, transform));
        }
    }
    Some(meshes)
}
