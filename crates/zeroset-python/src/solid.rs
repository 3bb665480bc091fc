//! Solids: what is fitted, primitives, and what is made of them.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use numpy::{IntoPyArray, PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use zeroset::field::Placement;
use zeroset::model::{
    MeshParams, Model, Provenance, Solid as Tree, VolumeParams, cut_and_fill, evaluate, mesh, volume,
};
use zeroset_io::{SolidFiles, is_model, read_model, write_model};

use crate::arrays::{check_finite, dictionary, points, positions, table};
use crate::error::Failure;
use crate::options::Options;
use crate::watch::Running;

/// A solid in world coordinates.
#[pyclass(frozen, module = "zeroset._core")]
pub(crate) struct Solid(pub(crate) Model);

/// Values and gradients of F.
type Evaluated<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>);
/// A volume and its error.
type Measured = (f64, f64);

impl Solid {
    /// A solid of one's own making. That it can be is checked at once.
    fn new(solid: Tree) -> Result<Self, Failure> {
        solid.field([0.0; 3])?;
        let provenance = Provenance { version: env!("CARGO_PKG_VERSION").to_owned(), ..Provenance::default() };
        Ok(Self(Model { solid, crs: None, provenance }))
    }

    /// Another solid made of this one, and perhaps of a second.
    fn made(&self, other: Option<&Self>, solid: Tree) -> Self {
        let other = other.map(|other| &other.0);
        let crs = self.0.crs.clone().or_else(|| other.and_then(|other| other.crs.clone()));
        let mut provenance = self.0.provenance.clone();
        provenance.inputs.extend(other.into_iter().flat_map(|other| other.provenance.inputs.iter().cloned()));
        Self(Model { solid, crs, provenance })
    }

    fn tree(&self) -> Tree {
        self.0.solid.clone()
    }
}

/// Both lists of operands in one: long chains stay shallow.
fn joined(a: Tree, b: Tree, operands: fn(Tree) -> Result<Vec<Tree>, Tree>) -> Vec<Tree> {
    let [mut a, b] = [a, b].map(|tree| operands(tree).unwrap_or_else(|one| vec![one]));
    a.extend(b);
    a
}

fn union(a: Tree, b: Tree) -> Tree {
    Tree::Union(joined(a, b, |tree| match tree {
        Tree::Union(of) => Ok(of),
        other => Err(other),
    }))
}

fn intersection(a: Tree, b: Tree) -> Tree {
    Tree::Intersection(joined(a, b, |tree| match tree {
        Tree::Intersection(of) => Ok(of),
        other => Err(other),
    }))
}

/// a - b - c is a - (b | c), to the last bit.
fn difference(a: Tree, b: Tree) -> Tree {
    match a {
        Tree::Difference(of) => {
            let [a, first] = *of;
            Tree::Difference(Box::new([a, union(first, b)]))
        }
        a => Tree::Difference(Box::new([a, b])),
    }
}

#[pymethods]
impl Solid {
    /// An expression, such as `box(0,0,0; 1,1,1)`.
    #[staticmethod]
    #[pyo3(signature = (text: "str") -> "Solid")]
    fn expression(text: &str) -> PyResult<Self> {
        let solid = SolidFiles::default().expression(text).map_err(Failure::from)?;
        Ok(Self::new(solid)?)
    }

    /// What a file holds: a model, a tree, or a closed mesh.
    #[staticmethod]
    #[pyo3(signature = (path) -> "Solid")]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        Running::quiet().run(py, move |_| {
            if is_model(&path) {
                return Ok(Self(read_model(&path)?));
            }
            let mut solid = Self::new(SolidFiles::default().read(&path)?)?;
            let name = Path::new(&path).file_name().unwrap_or_default();
            solid.0.provenance.inputs = vec![name.to_string_lossy().into_owned()];
            Ok::<_, Failure>(solid)
        })
    }

    /// What a closed mesh surrounds.
    #[staticmethod]
    #[pyo3(signature = (mesh) -> "Solid")]
    fn of_mesh(mesh: &Bound<'_, PyAny>) -> PyResult<Self> {
        let own = crate::mesh::from_python(mesh)?;
        let crs = own.crs.clone();
        let mut solid = Running::quiet().run(mesh.py(), move |_| Self::new(Tree::Mesh(Arc::new(own))))?;
        solid.0.crs = crs;
        Ok(solid)
    }

    #[staticmethod]
    #[pyo3(signature = (low, high) -> "Solid")]
    fn cuboid(low: [f64; 3], high: [f64; 3]) -> PyResult<Self> {
        Ok(Self::new(Tree::Cuboid { corners: [low, high] })?)
    }

    #[staticmethod]
    #[pyo3(signature = (center, radius) -> "Solid")]
    fn ball(center: [f64; 3], radius: f64) -> PyResult<Self> {
        Ok(Self::new(Tree::Ball { center, radius })?)
    }

    #[staticmethod]
    #[pyo3(signature = (ends, radii) -> "Solid")]
    fn frustum(ends: [[f64; 3]; 2], radii: [f64; 2]) -> PyResult<Self> {
        Ok(Self::new(Tree::Frustum { ends, radii })?)
    }

    #[staticmethod]
    #[pyo3(signature = (point, normal) -> "Solid")]
    fn half_space(point: [f64; 3], normal: [f64; 3]) -> PyResult<Self> {
        Ok(Self::new(Tree::HalfSpace { point, normal })?)
    }

    #[staticmethod]
    #[pyo3(signature = (rings: "list[list[tuple[float, float]]]", heights) -> "Solid")]
    fn prism(rings: Vec<Vec<[f64; 2]>>, heights: [f64; 2]) -> PyResult<Self> {
        Ok(Self::new(Tree::Prism { rings, heights })?)
    }

    #[staticmethod]
    #[pyo3(signature = (origin, step, heights) -> "Solid")]
    fn height_field(origin: [f64; 2], step: [f64; 2], heights: &Bound<'_, PyAny>) -> PyResult<Self> {
        let count: [usize; 2] = heights.getattr("shape")?.extract()?;
        let heights = crate::arrays::numbers(&heights.call_method0("ravel")?, "heights")?.as_slice()?.to_vec();
        let count = [count[1], count[0]];
        Ok(Self::new(Tree::HeightField { origin, step, count, heights: Arc::new(heights) })?)
    }

    #[pyo3(signature = (other: "Solid") -> "Solid")]
    fn union(&self, other: &Self) -> Self {
        self.made(Some(other), union(self.tree(), other.tree()))
    }

    #[pyo3(signature = (other: "Solid") -> "Solid")]
    fn intersection(&self, other: &Self) -> Self {
        self.made(Some(other), intersection(self.tree(), other.tree()))
    }

    #[pyo3(signature = (other: "Solid") -> "Solid")]
    fn difference(&self, other: &Self) -> Self {
        self.made(Some(other), difference(self.tree(), other.tree()))
    }

    #[pyo3(signature = () -> "Solid")]
    fn complement(&self) -> Self {
        match self.tree() {
            Tree::Complement(of) => self.made(None, *of),
            tree => self.made(None, Tree::Complement(Box::new(tree))),
        }
    }

    #[pyo3(signature = (other: "Solid", radius) -> "Solid")]
    fn smooth_union(&self, other: &Self, radius: f64) -> PyResult<Self> {
        self.made(Some(other), Tree::SmoothUnion { of: Box::new([self.tree(), other.tree()]), radius }).checked()
    }

    #[pyo3(signature = (distance) -> "Solid")]
    fn offset(&self, distance: f64) -> PyResult<Self> {
        self.made(None, Tree::Offset { of: Box::new(self.tree()), distance }).checked()
    }

    #[pyo3(signature = (thickness) -> "Solid")]
    fn shell(&self, thickness: f64) -> PyResult<Self> {
        self.made(None, Tree::Shell { of: Box::new(self.tree()), thickness }).checked()
    }

    /// Turned about an axis through `about`, then scaled about it, then moved.
    #[pyo3(signature = (axis, angle, about, scale, by) -> "Solid")]
    fn placed(&self, axis: [f64; 3], angle: f64, about: [f64; 3], scale: f64, by: [f64; 3]) -> PyResult<Self> {
        let placement = || Placement::default().turned(axis, angle, about)?.scaled(scale, about)?.moved(by);
        let placement = placement().map_err(Failure::from)?;
        Ok(self.made(None, Tree::Placed { of: Box::new(self.tree()), placement }))
    }

    /// F and its gradient.
    #[pyo3(signature = (points, options: "dict[str, Any]") -> "tuple[Any, Any]")]
    fn evaluate<'py>(&self, points: &Bound<'py, PyAny>, options: &Bound<'py, PyDict>) -> PyResult<Evaluated<'py>> {
        let py = points.py();
        let array = self::points::<3>(points, "points")?;
        let positions = positions::<3>(&array)?;
        let found = Options(options).running()?.run(py, |monitor| {
            check_finite(positions, "points")?;
            Ok::<_, Failure>(evaluate(&self.0.solid, positions, monitor)?)
        })?;
        Ok((found.values.into_pyarray(py), table(py, found.gradients)?))
    }

    /// A mesh, and what was done.
    #[pyo3(signature = (options: "dict[str, Any]") -> "tuple[dict[str, Any], dict[str, Any]]")]
    fn mesh<'py>(&self, options: &Bound<'py, PyDict>) -> PyResult<(Bound<'py, PyDict>, Bound<'py, PyDict>)> {
        let (py, options) = (options.py(), Options(options));
        let params = MeshParams {
            cell: options.get("cell")?,
            bounds: options.get("bounds")?,
            simplify: options.simplify()?,
            attributes: options.attributes()?,
        };
        let (mut made, report) = options.running()?.run(py, |monitor| mesh(&self.0.solid, &params, monitor))?;
        made.crs.clone_from(&self.0.crs);
        Ok((crate::mesh::to_python(py, made)?, dictionary(py, &report)?))
    }

    /// The volume and its error.
    #[pyo3(signature = (options: "dict[str, Any]") -> "tuple[float, float]")]
    fn volume(&self, options: &Bound<'_, PyDict>) -> PyResult<Measured> {
        let options = Options(options);
        let params = measure(&options)?;
        let found = options.running()?.run(options.0.py(), |monitor| volume(&self.0.solid, &params, monitor))?;
        Ok((found.volume, found.error))
    }

    /// What was cut and what was filled to make this one, each with its error.
    #[pyo3(signature = (before: "Solid", options: "dict[str, Any]") -> "dict[str, tuple[float, float]]")]
    fn change<'py>(&self, before: &Self, options: &Bound<'py, PyDict>) -> PyResult<Bound<'py, PyDict>> {
        let (py, options) = (options.py(), Options(options));
        let params = measure(&options)?;
        let work =
            |monitor: &dyn zeroset::monitor::Monitor| cut_and_fill(&before.0.solid, &self.0.solid, &params, monitor);
        let found = options.running()?.run(py, work)?;
        let dict = PyDict::new(py);
        for (name, volume) in [("cut", found.cut), ("fill", found.fill), ("net", found.net)] {
            dict.set_item(name, (volume.volume, volume.error))?;
        }
        Ok(dict)
    }

    /// Writes a model; returns the number of bytes.
    #[pyo3(signature = (path) -> "int")]
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<u64> {
        Running::quiet().run(py, |_| write_model(&path, &self.0))
    }

    /// The reference system.
    #[getter]
    fn crs(&self) -> Option<&str> {
        self.0.crs.as_deref()
    }

    /// What it was made from, and how.
    #[pyo3(signature = () -> "dict[str, Any]")]
    fn provenance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let Provenance { version, inputs, parameters } = &self.0.provenance;
        let own = parameters.iter().cloned().collect::<std::collections::BTreeMap<_, _>>();
        let dict = PyDict::new(py);
        dict.set_item("version", version)?;
        dict.set_item("inputs", inputs)?;
        dict.set_item("parameters", own)?;
        Ok(dict)
    }

    /// What it is: the name of the operation or shape, and the number of its operands.
    #[pyo3(signature = () -> "tuple[str, int]")]
    fn kind(&self) -> (&'static str, usize) {
        let name = match &self.0.solid {
            Tree::HalfSpace { .. } => "half space",
            Tree::Cuboid { .. } => "box",
            Tree::Ball { .. } => "ball",
            Tree::Frustum { .. } => "frustum",
            Tree::Prism { .. } => "prism",
            Tree::HeightField { .. } => "height field",
            Tree::Mesh(_) => "mesh",
            Tree::Fitted(_) => "fitted",
            Tree::Union(_) => "union",
            Tree::Intersection(_) => "intersection",
            Tree::Difference(_) => "difference",
            Tree::Complement(_) => "complement",
            Tree::SmoothUnion { .. } => "smooth union",
            Tree::Offset { .. } => "offset",
            Tree::Shell { .. } => "shell",
            Tree::Placed { .. } => "placed",
        };
        (name, self.0.solid.operands().len())
    }
}

impl Solid {
    /// Refuses what cannot be now, and not when it is asked.
    fn checked(self) -> PyResult<Self> {
        self.0.solid.field([0.0; 3]).map_err(Failure::from)?;
        Ok(self)
    }
}

fn measure(options: &Options<'_, '_>) -> PyResult<VolumeParams> {
    Ok(VolumeParams { bounds: options.get("bounds")?, above: options.get("above")?, step: options.get("step")? })
}
