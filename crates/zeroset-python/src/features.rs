//! Planes, edges and corners.

use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use serde_json::{Value, json};
use zeroset::cloud::Cloud;
use zeroset::feature::{FeatureClass, FeatureParams, Features as Found, Posture, detect};
use zeroset_io::{FeatureOutput, WriteOptions, write_features};

use crate::arrays::{column, dictionary, table};
use crate::options::Options;
use crate::reconstruct::cloud;
use crate::watch::Running;

/// What was found, with the cloud that it was found in.
#[pyclass(frozen, module = "zeroset._core")]
pub(crate) struct Features {
    found: Found,
    cloud: Cloud,
    parameters: Value,
    /// What is written as one place.
    resolution: f64,
}

/// Finds planes, edges and corners; tells what was done.
#[pyfunction]
#[pyo3(signature = (points, options: "dict[str, Any]") -> "tuple[Features, dict[str, Any]]")]
pub(crate) fn features<'py>(
    points: &Bound<'py, PyAny>,
    options: &Bound<'py, PyDict>,
) -> PyResult<(Features, Bound<'py, PyDict>)> {
    let (py, options) = (points.py(), Options(options));
    let (scene, up) = options.scene_and_up()?;
    let params = FeatureParams {
        scene,
        up,
        min_area: options.get("min_area")?,
        max_distance: options.get("max_distance")?,
        max_angle: options.get::<Option<f64>>("max_angle")?.map(f64::to_radians),
        sharp_angle: options.get::<f64>("sharp_angle")?.to_radians(),
        posture: options.word("posture", &[("upright", Posture::Upright), ("free", Posture::Free)])?,
        memory: options.memory()?,
    };
    let (running, cloud) = (options.running()?, cloud(points, &options)?);
    let (found, report) = running.run(py, |monitor| detect(&cloud, &params, monitor))?;
    let parameters = json!({
        "points": report.points,
        "spacing": report.spacing,
        "noise": report.noise,
        "scene": report.scene,
        "scene_reason": report.scene_reason,
        "up": up,
        "min_area": report.min_area,
        "max_distance": report.max_distance,
        "max_angle_deg": report.max_angle_deg,
        "sharp_angle_deg": report.sharp_angle_deg,
        "posture": params.posture,
    });
    let resolution = 0.1 * report.spacing;
    Ok((Features { found, cloud, parameters, resolution }, dictionary(py, &report)?))
}

impl Features {
    /// World positions of local ones.
    fn world(&self, positions: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let shift = self.found.world_from_local;
        positions.iter().map(|p| std::array::from_fn(|a| p[a] + shift[a])).collect()
    }
}

/// A kind as reports spell it.
fn name(kind: impl serde::Serialize) -> String {
    json!(kind).as_str().unwrap_or_default().to_owned()
}

#[pymethods]
impl Features {
    /// Flat regions as dictionaries, in world coordinates.
    #[pyo3(signature = () -> "list[dict[str, Any]]")]
    fn planes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let list = PyList::empty(py);
        for (i, plane) in self.found.planes.iter().enumerate() {
            let dict = PyDict::new(py);
            let rings = plane.rings.iter().map(|ring| table(py, self.world(ring))).collect::<PyResult<Vec<_>>>()?;
            dict.set_item("normal", column(py, plane.normal.to_vec()))?;
            dict.set_item("offset", self.found.world_offset(i))?;
            dict.set_item("oriented", plane.oriented)?;
            dict.set_item("points", plane.points)?;
            dict.set_item("rms", plane.rms)?;
            dict.set_item("area", plane.area)?;
            dict.set_item("rings", rings)?;
            list.append(dict)?;
        }
        Ok(list)
    }

    /// Sharp edges as dictionaries, in world coordinates.
    #[pyo3(signature = () -> "list[dict[str, Any]]")]
    fn edges<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let list = PyList::empty(py);
        for edge in &self.found.edges {
            let dict = PyDict::new(py);
            dict.set_item("kind", name(edge.kind))?;
            dict.set_item("planes", edge.planes.clone())?;
            dict.set_item("polyline", table(py, self.world(&edge.polyline))?)?;
            dict.set_item("angle", edge.angle.to_degrees())?;
            dict.set_item("length", edge.length())?;
            list.append(dict)?;
        }
        Ok(list)
    }

    /// Corners as dictionaries, in world coordinates.
    #[pyo3(signature = () -> "list[dict[str, Any]]")]
    fn corners<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let list = PyList::empty(py);
        for corner in &self.found.corners {
            let dict = PyDict::new(py);
            dict.set_item("kind", name(corner.kind))?;
            dict.set_item("position", column(py, self.world(&[corner.position]).concat()))?;
            dict.set_item("planes", corner.planes.clone())?;
            dict.set_item("edges", corner.edges.clone())?;
            list.append(dict)?;
        }
        Ok(list)
    }

    /// For each point the number of its plane, -1 for none.
    #[pyo3(signature = () -> "Any")]
    fn plane_of_point<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        let number = |plane: Option<u32>| plane.and_then(|plane| i32::try_from(plane).ok()).unwrap_or(-1);
        column(py, self.found.points.iter().map(|point| number(point.plane)).collect::<Vec<i32>>())
    }

    /// For each point what kind of place it is at: 0 unstructured, 1 flat, 2 edge, 3 corner.
    #[pyo3(signature = () -> "Any")]
    fn class_of_point<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        let number = |class| match class {
            FeatureClass::Unstructured => 0,
            FeatureClass::Flat => 1,
            FeatureClass::Edge => 2,
            FeatureClass::Corner => 3,
        };
        column(py, self.found.points.iter().map(|point| number(point.class)).collect::<Vec<u8>>())
    }

    /// The reference system.
    #[getter]
    fn crs(&self) -> Option<&str> {
        self.found.crs.as_deref()
    }

    /// Writes a file; the suffix tells the format. Returns the number of bytes.
    #[pyo3(signature = (path) -> "int")]
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<u64> {
        let options = WriteOptions { resolution: Some(self.resolution), ..WriteOptions::default() };
        let report = Running::quiet().run(py, |_| {
            let (features, cloud) = (&self.found, Some(&self.cloud));
            write_features(&path, FeatureOutput { features, cloud, parameters: &self.parameters, options: &options })
        })?;
        Ok(report.bytes)
    }
}
