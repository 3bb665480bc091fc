//! Points in, a mesh or a model out.

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use zeroset::cloud::Cloud;
use zeroset::model::{Model, Provenance, Solid as Tree};
use zeroset::monitor::Monitor;
use zeroset::reconstruct::{PlanReport, ReconstructError, ReconstructParams, plan};

use crate::arrays::{attributes, check_finite, dictionary, points, positions};
use crate::mesh;
use crate::options::Options;
use crate::solid::Solid;

/// The cloud of an array of points, read where it lies: the one copy is the cloud itself, whose positions are local.
pub(crate) fn cloud(object: &Bound<'_, PyAny>, options: &Options<'_, '_>) -> PyResult<Cloud> {
    let array = points::<3>(object, "points")?;
    let positions = positions::<3>(&array)?;
    let [colors, intensities, classes] =
        [options.given("colors")?, options.given("intensities")?, options.given("classes")?];
    let attributes = attributes(positions.len(), colors.as_ref(), intensities.as_ref(), classes.as_ref())?;
    let crs = options.get("crs")?;
    // With the GIL held, so that no Python code writes to the array meanwhile. It takes milliseconds.
    check_finite(positions, "points")?;
    let cloud = Cloud::from_world(positions.to_vec());
    Ok(Cloud { attributes, crs, ..cloud })
}

/// A mesh of points, and what was done.
#[pyfunction]
#[pyo3(signature = (points, options: "dict[str, Any]") -> "tuple[dict[str, Any], dict[str, Any]]")]
pub(crate) fn reconstruct<'py>(
    points: &Bound<'py, PyAny>,
    options: &Bound<'py, PyDict>,
) -> PyResult<(Bound<'py, PyDict>, Bound<'py, PyDict>)> {
    let (py, options) = (points.py(), Options(options));
    let params =
        ReconstructParams { simplify: options.simplify()?, attributes: options.attributes()?, ..options.fit()? };
    let (running, cloud) = (options.running()?, cloud(points, &options)?);
    let work = move |monitor: &dyn Monitor| plan(&cloud, &params, monitor)?.run(monitor);
    let (made, report) = running.run::<_, ReconstructError>(py, work)?;
    Ok((mesh::to_python(py, made)?, dictionary(py, &report)?))
}

/// A model of points, and what was done.
#[pyfunction]
#[pyo3(signature = (points, options: "dict[str, Any]") -> "tuple[Solid, dict[str, Any]]")]
pub(crate) fn fit<'py>(
    points: &Bound<'py, PyAny>,
    options: &Bound<'py, PyDict>,
) -> PyResult<(Solid, Bound<'py, PyDict>)> {
    let (py, options) = (points.py(), Options(options));
    let params = options.fit()?;
    let (running, cloud) = (options.running()?, cloud(points, &options)?);
    let crs = cloud.crs.clone();
    let work = move |monitor: &dyn Monitor| plan(&cloud, &params, monitor)?.fit(monitor);
    let (fitted, report) = running.run::<_, ReconstructError>(py, work)?;
    let provenance = provenance(&report.plan);
    let model = Model { solid: Tree::Fitted(Arc::new(fitted)), crs, provenance };
    Ok((Solid(model), dictionary(py, &report)?))
}

/// What was decided, for whoever finds the model.
fn provenance(plan: &PlanReport) -> Provenance {
    let name = |value: serde_json::Value| value.as_str().unwrap_or_default().to_owned();
    let parameters = [
        ("points", plan.points.to_string()),
        ("scene", name(serde_json::json!(plan.scene))),
        ("up", name(serde_json::json!(plan.up))),
        ("resolution", plan.resolution.to_string()),
        ("quality", name(serde_json::json!(plan.quality))),
        ("screening", plan.screening.to_string()),
    ];
    Provenance {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        inputs: Vec::new(),
        parameters: parameters.map(|(name, value)| (name.to_owned(), value)).to_vec(),
    }
}
