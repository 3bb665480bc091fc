//! Parameters by name, as the Python functions pass them on.

use std::path::PathBuf;

use pyo3::exceptions::{PyOverflowError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use zeroset::constraint::Constraints;
use zeroset::fit::cascade::Scene;
use zeroset::mesh::SimplifyParams;
use zeroset::reconstruct::{AttributeChoice, MinComponent, Quality, ReconstructParams, Resolution, Trim, Up};
use zeroset_io::read_constraints;

use crate::error::Failure;
use crate::watch::Running;

/// Parameters by name. Every one is there: the Python functions have the defaults.
pub(crate) struct Options<'a, 'py>(pub(crate) &'a Bound<'py, PyDict>);

/// A number, or a word in its place.
#[derive(FromPyObject)]
enum NumberOrWord {
    Number(f64),
    Word(String),
}

impl<'py> Options<'_, 'py> {
    /// The value of a parameter as it came.
    pub(crate) fn object(&self, name: &str) -> PyResult<Bound<'py, PyAny>> {
        self.0.as_any().get_item(name)
    }

    /// The value of a parameter that may be `None`.
    pub(crate) fn given(&self, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        Ok(Some(self.object(name)?).filter(|value| !value.is_none()))
    }

    /// The value of a parameter.
    pub(crate) fn get<T>(&self, name: &str) -> PyResult<T>
    where
        T: for<'a> FromPyObject<'a, 'py, Error: Into<PyErr>>,
    {
        let value = self.object(name)?;
        let extracted = value.extract().map_err(Into::into);
        extracted.map_err(|why: PyErr| {
            if why.is_instance_of::<PyOverflowError>(value.py()) {
                return Failure::parameter(format!("{name} of {value} is out of range")).into();
            }
            match value.get_type().name() {
                Ok(class) => PyTypeError::new_err(format!("{name} cannot be of type {class}")),
                Err(error) => error,
            }
        })
    }

    /// One of some words.
    pub(crate) fn word<T: Copy>(&self, name: &str, known: &[(&str, T)]) -> PyResult<T> {
        let given: String = self.get(name)?;
        let found = known.iter().find(|(word, _)| *word == given).map(|(_, value)| *value);
        found.ok_or_else(|| unknown(name, &given, &known.iter().map(|(word, _)| *word).collect::<Vec<_>>()).into())
    }

    fn scene(&self) -> PyResult<Option<Scene>> {
        self.word(
            "scene",
            &[
                ("auto", None),
                ("object", Some(Scene::Object)),
                ("terrain", Some(Scene::Terrain)),
                ("airborne", Some(Scene::Airborne)),
                ("free", Some(Scene::Free)),
            ],
        )
    }

    fn up(&self) -> PyResult<Up> {
        let known =
            [("x", Up::X), ("y", Up::Y), ("z", Up::Z), ("-x", Up::MinusX), ("-y", Up::MinusY), ("-z", Up::MinusZ)];
        self.word("up", &known)
    }

    /// What is known of the scene.
    pub(crate) fn scene_and_up(&self) -> PyResult<(Option<Scene>, Up)> {
        Ok((self.scene()?, self.up()?))
    }

    fn trim(&self) -> PyResult<Trim> {
        match self.get::<NumberOrWord>("trim")? {
            NumberOrWord::Number(length) => Ok(Trim::Length(length)),
            NumberOrWord::Word(word) => match word.as_str() {
                "auto" => Ok(Trim::Auto),
                "off" => Ok(Trim::Off),
                other => Err(unknown("trim", other, &["a length", "auto", "off"]).into()),
            },
        }
    }

    fn min_component(&self) -> PyResult<MinComponent> {
        let value = self.object("min_component")?;
        match value.extract::<String>().as_deref() {
            Ok("auto") => Ok(MinComponent::Auto),
            Ok("off") => Ok(MinComponent::Off),
            Ok(other) => Err(unknown("min_component", other, &["a number", "auto", "off"]).into()),
            Err(_) => Ok(MinComponent::Triangles(self.get("min_component")?)),
        }
    }

    fn resolution(&self) -> PyResult<Resolution> {
        match (self.get::<Option<f64>>("resolution")?, self.get::<Option<u32>>("depth")?) {
            (Some(_), Some(_)) => Err(Failure::parameter("resolution and depth say the same; give one of them").into()),
            (Some(length), None) => Ok(Resolution::Length(length)),
            (None, Some(depth @ 1..=16)) => Ok(Resolution::Depth(depth)),
            (None, Some(depth)) => {
                Err(Failure::parameter(format!("a depth of {depth} is not possible; give 1 to 16")).into())
            }
            (None, None) => Ok(Resolution::Auto),
        }
    }

    /// How far a mesh is simplified.
    pub(crate) fn simplify(&self) -> PyResult<Option<SimplifyParams>> {
        let (triangles, max_error) = (self.get("triangles")?, self.get("max_error")?);
        let params = SimplifyParams { triangles, max_error, ..SimplifyParams::default() };
        Ok((params.triangles.is_some() || params.max_error.is_some()).then_some(params))
    }

    /// Which values the vertices get.
    pub(crate) fn attributes(&self) -> PyResult<AttributeChoice> {
        self.word(
            "attributes",
            &[
                ("off", AttributeChoice::Off),
                ("rgb", AttributeChoice::Rgb),
                ("intensity", AttributeChoice::Intensity),
                ("class", AttributeChoice::Class),
            ],
        )
    }

    /// A weight that must not be negative, where one is given.
    fn weight(&self, name: &str, zero_is_possible: bool) -> PyResult<Option<f64>> {
        let value: Option<f64> = self.get(name)?;
        match value {
            Some(value) if !(value.is_finite() && (value > 0.0 || zero_is_possible && value == 0.0)) => {
                Err(Failure::parameter(format!("a {name} of {value} is not possible; give a positive number")).into())
            }
            value => Ok(value),
        }
    }

    /// The limit of memory.
    pub(crate) fn memory(&self) -> PyResult<u64> {
        Ok(self.get::<Option<u64>>("memory")?.unwrap_or_else(zeroset_cli::memory::default_limit))
    }

    /// The user's lines and polygons, from files.
    fn constraints(&self) -> PyResult<Constraints> {
        let paths: Vec<PathBuf> = self.get("constraints")?;
        let outlines = self.word("constraint_polygons", &[("faces", false), ("outlines", true)])?;
        let mut all = Constraints::default();
        for path in paths {
            let read = read_constraints(&path).map_err(Failure::from)?.constraints;
            all.append(if outlines { read.into_outlines() } else { read });
        }
        Ok(all)
    }

    /// How to reconstruct or fit, but for what only meshes have.
    pub(crate) fn fit(&self) -> PyResult<ReconstructParams> {
        let (scene, up) = self.scene_and_up()?;
        let known = [("draft", Quality::Draft), ("normal", Quality::Normal), ("fine", Quality::Fine)];
        Ok(ReconstructParams {
            scene,
            up,
            resolution: self.resolution()?,
            quality: self.word("quality", &known)?,
            screening: self.weight("screening", false)?,
            smoothness: self.weight("smoothness", true)?,
            trim: self.trim()?,
            min_component: self.min_component()?,
            constraints: self.constraints()?,
            memory: self.memory()?,
            ..ReconstructParams::default()
        })
    }

    /// How to run.
    pub(crate) fn running(&self) -> PyResult<Running<'py>> {
        Ok(Running { progress: self.given("progress")?, threads: self.get("threads")? })
    }
}

fn unknown(name: &str, given: &str, known: &[&str]) -> Failure {
    Failure::parameter(format!("{name} of '{given}' is not known; give one of: {}", known.join(", ")))
}
