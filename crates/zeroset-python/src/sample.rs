//! Test scenes.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use zeroset::sample::{Scene, SceneKind};

use crate::arrays::table;
use crate::error::Failure;
use crate::mesh;
use crate::watch::Running;

/// Points of a scene, and its exact mesh.
#[pyfunction]
#[pyo3(signature = (kind: "str", points: "int", noise: "float | None", seed: "int") -> "tuple[Any, dict[str, Any]]")]
pub(crate) fn sample<'py>(
    py: Python<'py>,
    kind: &str,
    points: usize,
    noise: Option<f64>,
    seed: u64,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyDict>)> {
    let kind: SceneKind = kind.parse().map_err(|unknown| Failure::parameter(format!("{unknown}")))?;
    let noise = noise.unwrap_or_else(|| kind.default_noise());
    if !(noise.is_finite() && noise >= 0.0) {
        return Err(Failure::parameter(format!("a noise of {noise} is not possible; give 0 or more")).into());
    }
    let (cloud, truth) = Running::quiet().run(py, move |_| {
        let scene = Scene::new(kind, seed);
        Ok::<_, Failure>((scene.points(points, noise, seed).points, scene.truth))
    })?;
    Ok((table(py, cloud)?.into_any(), mesh::to_python(py, truth)?))
}

/// The names of all scenes.
#[pyfunction]
#[pyo3(signature = () -> "list[str]")]
pub(crate) fn sample_kinds() -> Vec<&'static str> {
    SceneKind::ALL.map(SceneKind::name).to_vec()
}
