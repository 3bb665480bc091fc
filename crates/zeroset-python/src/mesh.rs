//! Meshes: dictionaries of arrays out, objects with the same names in.

use std::path::PathBuf;

use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use zeroset::mesh::{Mesh, self_intersections, simplify, topology};
use zeroset_io::{WriteOptions, read_mesh, write_mesh};

use crate::arrays::{attributes, check_finite, dictionary, points, positions, set_attributes, table};
use crate::error::Failure;
use crate::options::Options;
use crate::watch::Running;

/// A mesh as a dictionary of arrays, which take its memory over.
pub(crate) fn to_python(py: Python<'_>, mesh: Mesh) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("local", table(py, mesh.vertices)?)?;
    dict.set_item("triangles", table(py, mesh.triangles)?)?;
    dict.set_item("world_from_local", mesh.world_from_local)?;
    set_attributes(&dict, mesh.attributes)?;
    dict.set_item("crs", mesh.crs)?;
    Ok(dict)
}

/// A mesh out of an object that has such arrays.
pub(crate) fn from_python(mesh: &Bound<'_, PyAny>) -> PyResult<Mesh> {
    let local = points::<3>(&mesh.getattr("local")?, "vertices")?;
    let vertices = positions::<3>(&local)?;
    check_finite(vertices, "vertices")?;
    let triangles: PyReadonlyArray2<'_, u32> = mesh.getattr("triangles")?.extract()?;
    let given = |name| Ok::<_, PyErr>(Some(mesh.getattr(name)?).filter(|value| !value.is_none()));
    let [colors, intensities, classes] = [given("colors")?, given("intensities")?, given("classes")?];
    let attributes = attributes(vertices.len(), colors.as_ref(), intensities.as_ref(), classes.as_ref())?;
    let mesh = Mesh {
        world_from_local: mesh.getattr("world_from_local")?.extract()?,
        vertices: vertices.to_vec(),
        triangles: triangles.as_slice()?.as_chunks::<3>().0.to_vec(),
        attributes,
        crs: mesh.getattr("crs")?.extract()?,
    };
    mesh.check().map_err(Failure::from)?;
    Ok(mesh)
}

/// Reads a mesh.
#[pyfunction]
#[pyo3(signature = (path) -> "dict[str, Any]")]
pub(crate) fn load_mesh(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyDict>> {
    let mesh = Running::quiet().run(py, |_| read_mesh(&path))?;
    to_python(py, mesh)
}

/// Writes a mesh; the suffix tells the format.
#[pyfunction]
#[pyo3(signature = (mesh, path, resolution: "float | None") -> "int")]
pub(crate) fn save_mesh(mesh: &Bound<'_, PyAny>, path: PathBuf, resolution: Option<f64>) -> PyResult<u64> {
    let own = from_python(mesh)?;
    let options = WriteOptions { resolution, ..WriteOptions::default() };
    let report = Running::quiet().run(mesh.py(), move |_| write_mesh(&path, &own, &options))?;
    Ok(report.bytes)
}

/// A mesh of fewer triangles, and what was done.
#[pyfunction]
#[pyo3(signature = (mesh, options: "dict[str, Any]") -> "tuple[dict[str, Any], dict[str, Any]]")]
pub(crate) fn simplify_mesh<'py>(
    mesh: &Bound<'py, PyAny>,
    options: &Bound<'py, PyDict>,
) -> PyResult<(Bound<'py, PyDict>, Bound<'py, PyDict>)> {
    let (py, options) = (mesh.py(), Options(options));
    let params = options.simplify()?.unwrap_or_default();
    let own = from_python(mesh)?;
    let (simple, report) = options.running()?.run(py, move |monitor| simplify(&own, &params, monitor))?;
    Ok((to_python(py, simple)?, dictionary(py, &report)?))
}

/// How a mesh hangs together.
#[pyfunction]
#[pyo3(signature = (mesh) -> "dict[str, Any]")]
pub(crate) fn mesh_topology<'py>(mesh: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyDict>> {
    let own = from_python(mesh)?;
    let found = Running::quiet().run(mesh.py(), move |_| topology(&own))?;
    dictionary(mesh.py(), &found)
}

/// The number of pairs of triangles that cut through each other.
#[pyfunction]
#[pyo3(signature = (mesh) -> "int")]
pub(crate) fn mesh_self_intersections(mesh: &Bound<'_, PyAny>) -> PyResult<u64> {
    let own = from_python(mesh)?;
    let found = Running::quiet().run(mesh.py(), move |monitor| self_intersections(&own, 0, monitor))?;
    Ok(found.pairs)
}
