//! Clouds from files.

use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use zeroset_io::{CloudFile, read_clouds};

use crate::arrays::{set_attributes, table};
use crate::watch::Running;

/// Reads files as one cloud: world positions with what was measured beside them.
#[pyfunction]
#[pyo3(signature = (paths: "list[Any]") -> "dict[str, Any]")]
pub(crate) fn read_points(py: Python<'_>, paths: Vec<PathBuf>) -> PyResult<Bound<'_, PyDict>> {
    let CloudFile { mut cloud, .. } = Running::quiet().run(py, move |_| read_clouds(&paths))?;
    let shift = cloud.world_from_local;
    if shift != [0.0; 3] {
        py.detach(|| cloud.points.iter_mut().for_each(|p| *p = std::array::from_fn(|a| p[a] + shift[a])));
    }
    let dict = PyDict::new(py);
    dict.set_item("points", table(py, cloud.points)?)?;
    set_attributes(&dict, cloud.attributes)?;
    dict.set_item("crs", cloud.crs)?;
    Ok(dict)
}
