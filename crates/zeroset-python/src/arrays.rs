//! Arrays of NumPy in and out.
//!
//! What comes in as C-contiguous float64 is read where it lies. Anything else is converted once, by NumPy. What goes out is moved: NumPy
//! takes the memory over.

use numpy::{Element, IntoPyArray, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArrayDyn};
use numpy::{PyArray, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use zeroset::cloud::Attributes;
use zeroset_io::MAX_COORDINATE;

use crate::error::Failure;

/// What an array is to be, for messages.
#[derive(Clone, Copy)]
pub(crate) struct Wanted<'a> {
    /// Its name.
    pub(crate) name: &'a str,
    /// The types of numbers that are converted, as NumPy's letters for kinds.
    kinds: &'a str,
    /// The type that it becomes.
    dtype: &'a str,
}

impl<'a> Wanted<'a> {
    /// Numbers.
    pub(crate) fn numbers(name: &'a str) -> Self {
        Self { name, kinds: "fiu", dtype: "float64" }
    }
}

/// An array of the wanted type, C-contiguous and aligned: the caller's own where it is so already.
///
/// The guard refuses an array that other Rust code writes to. That Python writes to it meanwhile, from another thread, cannot be refused.
fn read<'py, T: Element>(
    object: &Bound<'py, PyAny>,
    wanted: Wanted<'_>,
    fits: impl Fn(&[usize]) -> bool,
    shape: &str,
) -> PyResult<PyReadonlyArrayDyn<'py, T>> {
    let py = object.py();
    let Wanted { name, kinds, dtype } = wanted;
    let numpy = py.import("numpy")?;
    let array = numpy
        .call_method1("asarray", (object,))
        .map_err(|why| Failure::input(format!("{name} cannot be made an array: {}", why.value(py))))?;
    let given = array.cast::<PyUntypedArray>()?;
    let kind: String = given.dtype().getattr("kind")?.extract()?;
    if !kinds.contains(&kind) {
        let given = given.dtype();
        return Err(
            Failure::input(format!("{name} are of type {given}; give {dtype}, or what NumPy can make it of")).into()
        );
    }
    if !fits(given.shape()) {
        let given: String = array.getattr("shape")?.str()?.extract()?;
        return Err(Failure::input(format!("{name} have shape {given}; give an array of shape {shape}")).into());
    }
    let array = numpy.call_method1("require", (array, dtype, "CA"))?;
    let array = array.cast::<PyArray<T, numpy::IxDyn>>()?;
    array
        .try_readonly()
        .map_err(|_| Failure::input(format!("{name} are being written to; wait, or give a copy")).into())
}

/// Points of `D` coordinates.
pub(crate) fn points<'py, const D: usize>(
    object: &Bound<'py, PyAny>,
    name: &str,
) -> PyResult<PyReadonlyArray2<'py, f64>> {
    let fits = |shape: &[usize]| matches!(shape, [_, width] if *width == D);
    let array = read::<f64>(object, Wanted::numbers(name), fits, &format!("(n, {D})"))?;
    Ok(array.cast::<PyArray2<f64>>()?.readonly())
}

/// The positions of an array of points.
///
/// # Errors
/// If the array is not contiguous, which [`points`] sees to.
pub(crate) fn positions<'a, const D: usize>(array: &'a PyReadonlyArray2<'_, f64>) -> PyResult<&'a [[f64; D]]> {
    Ok(array.as_slice()?.as_chunks::<D>().0)
}

/// Refuses positions that are not finite, or too large.
pub(crate) fn check_finite<const D: usize>(positions: &[[f64; D]], name: &str) -> Result<(), Failure> {
    let count = |bad: fn(f64) -> bool| positions.par_iter().filter(|p| p.iter().any(|&c| bad(c))).count();
    let all = positions.len();
    match count(|c| !c.is_finite()) {
        0 => {}
        bad => {
            return Err(Failure::input(format!(
                "{bad} of {all} {name} are NaN or infinite; keep the others: p[numpy.isfinite(p).all(axis=1)]"
            )));
        }
    }
    match count(|c| c.abs() > MAX_COORDINATE) {
        0 => Ok(()),
        bad => Err(Failure::input(format!(
            "{bad} of {all} {name} have coordinates beyond {MAX_COORDINATE:e}; drop them, or shift or scale the data"
        ))),
    }
}

/// Values beside `count` points, converted to the type that the library holds.
pub(crate) fn attributes(
    count: usize,
    colors: Option<&Bound<'_, PyAny>>,
    intensities: Option<&Bound<'_, PyAny>>,
    classes: Option<&Bound<'_, PyAny>>,
) -> PyResult<Attributes> {
    let line = |shape: &[usize]| shape == [count];
    let colors = colors.map(|object| -> PyResult<Vec<[u8; 3]>> {
        let wanted = Wanted { name: "colors", kinds: "u", dtype: "uint8" };
        let array = read::<u8>(object, wanted, |shape| shape == [count, 3], &format!("({count}, 3)"))?;
        check_bytes(object, "colors")?;
        Ok(array.as_slice()?.as_chunks::<3>().0.to_vec())
    });
    let intensities = intensities.map(|object| -> PyResult<Vec<f32>> {
        let wanted = Wanted { name: "intensities", kinds: "fiu", dtype: "float32" };
        Ok(read::<f32>(object, wanted, line, &format!("({count},)"))?.as_slice()?.to_vec())
    });
    let classes = classes.map(|object| -> PyResult<Vec<u8>> {
        let wanted = Wanted { name: "classes", kinds: "iu", dtype: "uint8" };
        let array = read::<u8>(object, wanted, line, &format!("({count},)"))?;
        check_bytes(object, "classes")?;
        Ok(array.as_slice()?.to_vec())
    });
    Ok(Attributes { colors: colors.transpose()?, intensities: intensities.transpose()?, classes: classes.transpose()? })
}

/// Refuses numbers that a byte does not hold.
fn check_bytes(object: &Bound<'_, PyAny>, name: &str) -> PyResult<()> {
    let array = object.py().import("numpy")?.call_method1("asarray", (object,))?;
    if array.getattr("size")?.extract::<usize>()? == 0 {
        return Ok(());
    }
    let ends = ["min", "max"].map(|end| array.call_method0(end).and_then(|value| value.extract::<i128>()));
    match ends {
        [Ok(0..), Ok(..=255)] => Ok(()),
        _ => Err(Failure::input(format!("{name} hold numbers outside of 0 to 255; scale them first")).into()),
    }
}

/// Positions as an array of shape (n, D), without a copy.
pub(crate) fn table<'py, T: Element, const D: usize>(
    py: Python<'py>,
    rows: Vec<[T; D]>,
) -> PyResult<Bound<'py, PyArray2<T>>> {
    let count = rows.len();
    rows.into_flattened().into_pyarray(py).reshape([count, D])
}

/// Numbers as an array of shape (n,), without a copy.
pub(crate) fn column<T: Element>(py: Python<'_>, values: Vec<T>) -> Bound<'_, PyAny> {
    values.into_pyarray(py).into_any()
}

/// Puts what there is of the values into a dictionary.
pub(crate) fn set_attributes(dict: &Bound<'_, PyDict>, attributes: Attributes) -> PyResult<()> {
    let py = dict.py();
    dict.set_item("colors", attributes.colors.map(|colors| table(py, colors)).transpose()?)?;
    dict.set_item("intensities", attributes.intensities.map(|values| column(py, values)))?;
    dict.set_item("classes", attributes.classes.map(|values| column(py, values)))
}

/// A list of numbers as an array of one axis; any length.
pub(crate) fn numbers<'py>(object: &Bound<'py, PyAny>, name: &str) -> PyResult<PyReadonlyArray1<'py, f64>> {
    let array = read::<f64>(object, Wanted::numbers(name), |shape| shape.len() == 1, "(n,)")?;
    Ok(array.cast::<numpy::PyArray1<f64>>()?.readonly())
}

/// A report as a dictionary.
pub(crate) fn dictionary<'py>(py: Python<'py>, report: &impl serde::Serialize) -> PyResult<Bound<'py, PyDict>> {
    let text = serde_json::to_string(report).map_err(|why| Failure::input(why.to_string()))?;
    Ok(py.import("json")?.call_method1("loads", (text,))?.cast_into::<PyDict>()?)
}

/// The address at which Rust reads an array of points, for tests that nothing is copied.
#[pyfunction]
#[pyo3(signature = (points) -> "int")]
pub(crate) fn address(points: &Bound<'_, PyAny>) -> PyResult<usize> {
    let array = self::points::<3>(points, "points")?;
    Ok(positions::<3>(&array)?.as_ptr() as usize)
}
