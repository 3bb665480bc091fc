//! Several flats at once through a handful of points.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use zeroset::feature::newe::{FlatCount, NeweParams, Normalization, corner, fit};

use crate::arrays::{column, points, positions, table};
use crate::error::Failure;
use crate::options::Options;

/// Flats through points in the plane or in space.
#[pyfunction]
#[pyo3(signature = (points, width, options: "dict[str, Any]") -> "dict[str, Any]")]
pub(crate) fn newe<'py>(
    points: &Bound<'py, PyAny>,
    width: usize,
    options: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyDict>> {
    let options = Options(options);
    let flats = match (options.get::<Option<usize>>("k")?, options.get::<usize>("most")?) {
        (Some(k), _) => FlatCount::Exactly(k),
        (None, most) => FlatCount::Between { least: 1, most },
    };
    let mut params = NeweParams {
        flats,
        normalization: options
            .word("normalization", &[("affine", Normalization::Affine), ("homogeneous", Normalization::Homogeneous)])?,
        starts: options.get("starts")?,
        noise: options.get("noise")?,
        seed: options.get("seed")?,
        ..NeweParams::default()
    };
    if let Some(schedule) = options.get("schedule")? {
        params.schedule = schedule;
    }
    match width {
        2 => run::<2>(points, &params, options),
        3 => run::<3>(points, &params, options),
        _ => {
            Err(Failure::input(format!("points of {width} coordinates; give an array of shape (n, 2) or (n, 3)"))
                .into())
        }
    }
}

fn run<'py, const D: usize>(
    points: &Bound<'py, PyAny>,
    params: &NeweParams,
    options: Options<'_, 'py>,
) -> PyResult<Bound<'py, PyDict>> {
    let py = points.py();
    let array = self::points::<D>(points, "points")?;
    let positions = positions::<D>(&array)?;
    let found = options.running()?.run(py, |_| fit(positions, params))?;
    let count = positions.len().max(1) as f64;
    let middle = positions.iter().fold([0.0; D], |sum: [f64; D], p| std::array::from_fn(|a| sum[a] + p[a] / count));
    let meeting = corner(&found.flats, middle);
    let number = |flat: &Option<usize>| flat.and_then(|flat| i32::try_from(flat).ok()).unwrap_or(-1);
    let dict = PyDict::new(py);
    dict.set_item("normals", table(py, found.flats.iter().map(|flat| flat.normal).collect())?)?;
    dict.set_item("offsets", column(py, found.flats.iter().map(|flat| flat.offset).collect::<Vec<f64>>()))?;
    dict.set_item("assignment", column(py, found.assignment.iter().map(number).collect::<Vec<i32>>()))?;
    dict.set_item("noise", found.noise)?;
    dict.set_item("objective", found.objective)?;
    dict.set_item("criterion", found.criterion)?;
    dict.set_item("corner", column(py, meeting.position.to_vec()))?;
    dict.set_item("rank", meeting.rank)?;
    Ok(dict)
}
