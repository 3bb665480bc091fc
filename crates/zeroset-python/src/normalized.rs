//! The small exact fit, in the plane and in space.

use numpy::{IntoPyArray, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use zeroset::basis::{Basis, Kernel, P1, P2, Radial, Tail, farthest_points};
use zeroset::contour::simplicial::{Branches, zero_lines, zero_surface};
use zeroset::domain::{Place, SimplicialMesh};
use zeroset::fit::normalized::{
    Coefficients, Data, Fitted, MeanGradient, Normalization, NormalizedFit as Fit, Order0, Order1, Order2, Smoothness,
    Solver, SquaredGradient,
};
use zeroset::monitor::Monitor;

use crate::arrays::{column, numbers, points, positions, table};
use crate::error::Failure;
use crate::options::Options;

/// The box of the data grows by this share of its longest side.
const MARGIN_REL: f64 = 0.1;
/// The weights of smoothness by default: those of `zeroset fit2d`.
const SMOOTHNESS_REL: [f64; 3] = [0.0, 1.0 / 12.0, 1e-6];
/// Cells along the longest side without smoothness, which bears few.
const FEW_CELLS: u32 = 4;
/// Most cells along the longest side by default with smoothness, in the plane and in space.
const MOST_CELLS: [f64; 2] = [64.0, 16.0];
/// Most centres of radial functions by default.
const MOST_CENTRES: usize = 60;
/// Widths of radial functions by default, in mean spacings of the centres: without smoothness and with.
const WIDTHS: [f64; 2] = [2.0, 5.0];

/// A fit that was made.
#[pyclass(frozen, module = "zeroset._core")]
pub(crate) struct NormalizedFit(Space);

enum Space {
    Plane(Kept<2>),
    Volume(Kept<3>),
}

struct Kept<const D: usize> {
    basis: Box<dyn Basis<D> + Send + Sync>,
    data: Data<D>,
    fitted: Fitted,
    smoothness: f64,
}

/// What is fitted, as arrays that are read where they lie.
struct Given<'a, const D: usize> {
    points: &'a [[f64; D]],
    weights: Option<&'a [f64]>,
    segments: &'a [[f64; D]],
    line_weight: f64,
}

/// What was asked for, without defaults.
struct Choices {
    order: usize,
    smoothness: Option<f64>,
    cells: Option<u32>,
    basis: String,
    centres: Option<usize>,
    width: Option<f64>,
    normalization: Box<str>,
    solver: Solver,
}

impl Choices {
    fn new(options: &Options<'_, '_>) -> PyResult<Self> {
        let known = ["coefficients", "squared-gradient", "mean-gradient"];
        let normalization = options.word("normalization", &known.map(|name| (name, name)))?;
        let solvers = [
            ("auto", Solver::Auto),
            ("dense", Solver::Dense),
            ("shift-invert", Solver::ShiftInvert),
            ("lobpcg", Solver::Lobpcg),
        ];
        let kinds = [
            "p1",
            "p2",
            "gaussian",
            "multiquadric",
            "inverse-multiquadric",
            "thin-plate",
            "wendland-c2",
            "wendland-c4",
        ];
        let order: usize = options.get("order")?;
        if order > 2 {
            return Err(Failure::parameter(format!("order of {order} is not known; give 0, 1 or 2")).into());
        }
        Ok(Self {
            order,
            smoothness: options.get("smoothness")?,
            cells: options.get("cells")?,
            basis: options.word("basis", &kinds.map(|name| (name, name)))?.to_owned(),
            centres: options.get("centres")?,
            width: options.get("width")?,
            normalization: normalization.into(),
            solver: options.word("solver", &solvers)?,
        })
    }
}

impl<const D: usize> Given<'_, D> {
    fn data(&self) -> Result<Data<D>, Failure> {
        let mut data = Data::new();
        if let Some(weights) = self.weights
            && weights.len() != self.points.len()
        {
            let message = format!("{} weights for {} points; give one for each", weights.len(), self.points.len());
            return Err(Failure::input(message));
        }
        for (i, &point) in self.points.iter().enumerate() {
            data.point(point, self.weights.map_or(1.0, |weights| weights[i]))?;
        }
        for &ends in self.segments.as_chunks::<2>().0 {
            data.segment(ends, self.line_weight)?;
        }
        Ok(data)
    }

    /// The weight of all data: one for each point and each unit of length.
    fn weight(&self) -> f64 {
        let points = self.weights.map_or(self.points.len() as f64, |weights| weights.iter().sum());
        let lines = self.segments.as_chunks::<2>().0.iter().map(|[p, q]| distance(p, q)).sum::<f64>();
        points + self.line_weight * lines
    }

    /// The box of the data, grown.
    fn bounds(&self) -> Result<[[f64; D]; 2], Failure> {
        let mut low = [f64::INFINITY; D];
        let mut high = [f64::NEG_INFINITY; D];
        for p in self.points.iter().chain(self.segments) {
            for a in 0..D {
                low[a] = low[a].min(p[a]);
                high[a] = high[a].max(p[a]);
            }
        }
        let longest = longest([low, high]);
        if longest.is_nan() || longest <= 0.0 {
            return Err(Failure::input("the data lie in one place, or there are none; give bounds, or more data"));
        }
        Ok([low.map(|c| c - MARGIN_REL * longest), high.map(|c| c + MARGIN_REL * longest)])
    }
}

fn distance<const D: usize>(p: &[f64; D], q: &[f64; D]) -> f64 {
    (0..D).map(|a| (p[a] - q[a]).powi(2)).sum::<f64>().sqrt()
}

fn longest<const D: usize>([low, high]: [[f64; D]; 2]) -> f64 {
    (0..D).map(|a| high[a] - low[a]).fold(f64::NEG_INFINITY, f64::max)
}

/// A lattice over a box, of nearly cubic cells.
fn lattice<const D: usize>(
    bounds: [[f64; D]; 2],
    choices: &Choices,
    count: usize,
) -> Result<SimplicialMesh<D>, Failure> {
    let by_data = (2.0 * (count as f64).powf(1.0 / (D - 1) as f64)).ceil().clamp(8.0, MOST_CELLS[D - 2]) as u32;
    let along = choices.cells.unwrap_or(if choices.order == 0 { FEW_CELLS } else { by_data });
    let longest = longest(bounds);
    let cells = std::array::from_fn(|a| {
        let share = (bounds[1][a] - bounds[0][a]) / longest;
        ((f64::from(along) * share).round() as u32).clamp(along.min(1), along)
    });
    SimplicialMesh::lattice(bounds[0], bounds[1], cells).map_err(|why| Failure::parameter(why.to_string()))
}

fn basis<const D: usize>(
    mesh: SimplicialMesh<D>,
    choices: &Choices,
    given: &Given<'_, D>,
) -> Result<Box<dyn Basis<D> + Send + Sync>, Failure> {
    match choices.basis.as_str() {
        "p1" => return Ok(Box::new(P1::new(mesh))),
        "p2" => return Ok(Box::new(P2::new(mesh))),
        _ => {}
    }
    let places: Vec<[f64; D]> = given.points.iter().chain(given.segments).copied().collect();
    let chosen = farthest_points(&places, choices.centres.unwrap_or(MOST_CENTRES));
    let centres: Vec<[f64; D]> = chosen.into_iter().map(|i| places[i]).collect();
    let wide = if choices.order == 0 || choices.basis == "thin-plate" { WIDTHS[0] } else { WIDTHS[1] };
    let width = choices.width.unwrap_or_else(|| wide * mean_spacing(&centres));
    let kernel = match choices.basis.as_str() {
        "gaussian" => Kernel::Gaussian { width },
        "multiquadric" => Kernel::Multiquadric { width },
        "inverse-multiquadric" => Kernel::InverseMultiquadric { width },
        "thin-plate" => Kernel::ThinPlate { width },
        // These end at their width, so it is three times as long.
        "wendland-c2" => Kernel::WendlandC2 { width: choices.width.unwrap_or(3.0 * width) },
        _ => Kernel::WendlandC4 { width: choices.width.unwrap_or(3.0 * width) },
    };
    let radial = Radial::new(mesh, kernel, centres, Tail::None);
    Ok(Box::new(radial.map_err(|why| Failure::parameter(why.to_string()))?))
}

/// The mean distance of a position to its nearest; 1 if there are fewer than two.
fn mean_spacing<const D: usize>(positions: &[[f64; D]]) -> f64 {
    if positions.len() < 2 {
        return 1.0;
    }
    let nearest = |i: usize| {
        let others = (0..positions.len()).filter(|&j| j != i);
        others.map(|j| distance(&positions[i], &positions[j])).fold(f64::INFINITY, f64::min)
    };
    (0..positions.len()).map(nearest).sum::<f64>() / positions.len() as f64
}

/// Makes the fit on a domain.
fn fitted<const D: usize>(
    mesh: SimplicialMesh<D>,
    given: &Given<'_, D>,
    choices: &Choices,
    monitor: &dyn Monitor,
) -> Result<Kept<D>, Failure> {
    let data = given.data()?;
    let mut corners = [[f64::INFINITY; D], [f64::NEG_INFINITY; D]];
    for vertex in mesh.vertices() {
        for a in 0..D {
            corners[0][a] = corners[0][a].min(vertex[a]);
            corners[1][a] = corners[1][a].max(vertex[a]);
        }
    }
    let side = longest(corners);
    let content: f64 = (0..mesh.len()).map(|simplex| mesh.volume(simplex)).sum();
    let simplices_a_cell = if D == 2 { 2.0 } else { 6.0 };
    let cell = (simplices_a_cell * content / mesh.len() as f64).powf(1.0 / D as f64);
    // Integrals over squares of derivatives of that order, brought to the unit of the data's sum.
    let unit = match choices.order {
        1 => cell / side * side.powi(2 - D as i32),
        _ => side.powi(4 - D as i32),
    };
    let smoothness = choices.smoothness.unwrap_or(SMOOTHNESS_REL[choices.order] * given.weight() * unit);
    let (first, second) = (Order1 { weight: smoothness }, Order2 { weight: smoothness });
    let energy: &dyn Smoothness<D> = match choices.order {
        0 => &Order0,
        1 => &first,
        _ => &second,
    };
    let (squared, mean) = (SquaredGradient::default(), MeanGradient::default());
    let normalization: &dyn Normalization<D> = match &*choices.normalization {
        "squared-gradient" => &squared,
        "mean-gradient" => &mean,
        _ => &Coefficients,
    };
    let basis = basis(mesh, choices, given)?;
    let fit = Fit::new(basis.as_ref(), &data).smoothness(energy).normalization(normalization);
    let fitted = fit.solver(choices.solver).monitor(monitor).run()?;
    Ok(Kept { basis, data, fitted, smoothness })
}

/// The rows of an array of vertex numbers.
fn simplices(domain: &Bound<'_, PyAny>) -> PyResult<Vec<Vec<u32>>> {
    domain.extract().map_err(|_| Failure::input("the simplices of a domain are no lists of vertex numbers").into())
}

/// As many corners as a simplex has.
fn rows<const C: usize>(simplices: Vec<Vec<u32>>) -> Result<Vec<[u32; C]>, Failure> {
    let row = |simplex: Vec<u32>| {
        let found = simplex.len();
        simplex.try_into().map_err(|_| Failure::input(format!("a simplex of {found} vertices; give {C}")))
    };
    simplices.into_iter().map(row).collect()
}

/// The domain that was asked for: a box or simplices.
enum Domain<const D: usize> {
    Lattice(Option<[[f64; D]; 2]>),
    Four(Option<[[f64; D]; 2]>),
    Simplices(Vec<[f64; D]>, Vec<Vec<u32>>),
}

impl<const D: usize> Domain<D> {
    fn new(options: &Options<'_, '_>) -> PyResult<Self> {
        let bounds = options.given("bounds")?.map(|given| -> PyResult<[[f64; D]; 2]> {
            let array = points::<D>(&given, "bounds")?;
            <[[f64; D]; 2]>::try_from(positions::<D>(&array)?)
                .map_err(|_| Failure::input("bounds are two positions: the lowest and the highest corner").into())
        });
        let bounds = bounds.transpose()?;
        let domain = options.object("domain")?;
        if let Ok((vertices, corners)) = domain.extract::<(Bound<'_, PyAny>, Bound<'_, PyAny>)>() {
            let array = points::<D>(&vertices, "vertices of the domain")?;
            return Ok(Self::Simplices(positions::<D>(&array)?.to_vec(), simplices(&corners)?));
        }
        let is_four = options.word("domain", &[("lattice", false), ("four", true)])?;
        Ok(if is_four { Self::Four(bounds) } else { Self::Lattice(bounds) })
    }
}

/// An array of segments of shape (m, 2, D) as positions, two for each.
fn segments<'py, const D: usize>(options: &Options<'_, 'py>) -> PyResult<PyReadonlyArray2<'py, f64>> {
    let object = options.object("segments")?;
    let numpy = object.py().import("numpy")?;
    let array = numpy.call_method1("asarray", (object, "float64"))?;
    let shape: Vec<usize> = array.getattr("shape")?.extract()?;
    match shape[..] {
        [0, ..] => points::<D>(&numpy.call_method1("empty", ((0, D),))?, "segments"),
        [_, 2, width] if width == D => points::<D>(&array.call_method1("reshape", (-1, D))?, "segments"),
        _ => Err(Failure::input(format!("segments have shape {shape:?}; give an array of shape (m, 2, {D})")).into()),
    }
}

fn run<const D: usize>(
    object: &Bound<'_, PyAny>,
    options: &Options<'_, '_>,
    made: impl Fn(Domain<D>, &Given<'_, D>, &Choices) -> Result<SimplicialMesh<D>, Failure> + Sync + Send,
) -> PyResult<Kept<D>> {
    let (array, lines) = (points::<D>(object, "points")?, segments::<D>(options)?);
    let weights = options.given("weights")?.map(|given| numbers(&given, "weights")).transpose()?;
    let given = Given {
        points: positions::<D>(&array)?,
        weights: weights.as_ref().map(|weights| weights.as_slice()).transpose()?,
        segments: positions::<D>(&lines)?,
        line_weight: options.get("line_weight")?,
    };
    crate::arrays::check_finite(given.points, "points")?;
    crate::arrays::check_finite(given.segments, "ends of segments")?;
    let (choices, domain) = (Choices::new(options)?, Domain::<D>::new(options)?);
    let work = |monitor: &dyn Monitor| fitted(made(domain, &given, &choices)?, &given, &choices, monitor);
    options.running()?.run::<_, Failure>(object.py(), work)
}

/// Fits F to points and segments.
#[pyfunction]
#[pyo3(signature = (points, width, options: "dict[str, Any]") -> "NormalizedFit")]
pub(crate) fn normalized_fit(
    points: &Bound<'_, PyAny>,
    width: usize,
    options: &Bound<'_, PyDict>,
) -> PyResult<NormalizedFit> {
    let options = Options(options);
    let broken = |why: zeroset::domain::DomainError| Failure::parameter(why.to_string());
    Ok(NormalizedFit(match width {
        2 => Space::Plane(run::<2>(points, &options, |domain, given, choices| {
            let count = given.points.len() + given.segments.len();
            match domain {
                Domain::Lattice(bounds) => lattice(bounds.map_or_else(|| given.bounds(), Ok)?, choices, count),
                Domain::Four(bounds) => {
                    let [low, high] = bounds.map_or_else(|| given.bounds(), Ok)?;
                    SimplicialMesh::four_triangles(low, high).map_err(broken)
                }
                Domain::Simplices(vertices, simplices) => {
                    SimplicialMesh::from_triangles(vertices, &rows(simplices)?).map_err(broken)
                }
            }
        })?),
        3 => Space::Volume(run::<3>(points, &options, |domain, given, choices| {
            let count = given.points.len() + given.segments.len();
            match domain {
                Domain::Lattice(bounds) => lattice(bounds.map_or_else(|| given.bounds(), Ok)?, choices, count),
                Domain::Four(_) => {
                    Err(Failure::parameter("four triangles lie in the plane; give points of shape (n, 2)"))
                }
                Domain::Simplices(vertices, simplices) => {
                    SimplicialMesh::from_tetrahedra(vertices, &rows(simplices)?).map_err(broken)
                }
            }
        })?),
        _ => {
            let message = format!("points of {width} coordinates; give an array of shape (n, 2) or (n, 3)");
            return Err(Failure::input(message).into());
        }
    }))
}

impl<const D: usize> Kept<D> {
    /// F and its gradient; NaN where F is not known.
    fn evaluate<'py>(&self, object: &Bound<'py, PyAny>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let py = object.py();
        let array = points::<D>(object, "points")?;
        let positions = positions::<D>(&array)?;
        let (values, gradients) = py.detach(|| {
            let f = self.fitted.function(self.basis.as_ref());
            let both = |&p: &[f64; D]| (f.value(p).unwrap_or(f64::NAN), f.gradient(p).unwrap_or([f64::NAN; D]));
            positions.iter().map(both).unzip::<_, _, Vec<f64>, Vec<[f64; D]>>()
        });
        Ok((values.into_pyarray(py).into_any(), table(py, gradients)?.into_any()))
    }

    /// Where the data are.
    fn places(&self) -> Result<Vec<Place<D>>, Failure> {
        Ok(self.data.samples(self.basis.as_ref())?.iter().map(|sample| sample.place).collect())
    }

    fn figures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let fitted = &self.fitted;
        let dict = PyDict::new(py);
        dict.set_item("coefficients", column(py, fitted.coefficients.clone()))?;
        dict.set_item("rayleigh_quotient", fitted.rayleigh_quotient)?;
        dict.set_item("spectrum", column(py, fitted.spectrum.clone()))?;
        dict.set_item("residuals", column(py, fitted.residuals.clone()))?;
        dict.set_item("residual_rms", fitted.residual_rms)?;
        dict.set_item("distance_rms", fitted.distance_rms)?;
        dict.set_item("smoothness", self.smoothness)?;
        let warnings = fitted.diagnosis.warnings.iter().map(ToString::to_string);
        dict.set_item("warnings", warnings.collect::<Vec<_>>())?;
        let nodes: Vec<[f64; D]> = (0..self.basis.len()).map(|j| self.basis.node(j).unwrap_or([f64::NAN; D])).collect();
        dict.set_item("nodes", table(py, nodes)?)?;
        Ok(dict)
    }
}

#[pymethods]
impl NormalizedFit {
    /// F and its gradient.
    #[pyo3(signature = (points) -> "tuple[Any, Any]")]
    fn evaluate<'py>(&self, points: &Bound<'py, PyAny>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        match &self.0 {
            Space::Plane(kept) => kept.evaluate(points),
            Space::Volume(kept) => kept.evaluate(points),
        }
    }

    /// All figures of the fit.
    #[pyo3(signature = () -> "dict[str, Any]")]
    fn figures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        match &self.0 {
            Space::Plane(kept) => kept.figures(py),
            Space::Volume(kept) => kept.figures(py),
        }
    }

    /// The zero set in the plane: polylines, each with whether it is closed.
    #[pyo3(signature = (tolerance, all_branches) -> "list[tuple[Any, bool]]")]
    fn lines<'py>(&self, py: Python<'py>, tolerance: f64, all_branches: bool) -> PyResult<Bound<'py, PyList>> {
        let Space::Plane(kept) = &self.0 else {
            return Err(Failure::parameter("the zero set of a fit in space is a surface; ask for its mesh").into());
        };
        let places = kept.places()?;
        let branches = if all_branches { Branches::All } else { Branches::WithData(&places) };
        let lines = py.detach(|| zero_lines(&kept.fitted.function(kept.basis.as_ref()), tolerance, branches));
        let list = PyList::empty(py);
        for line in lines {
            list.append((table(py, line.points)?, line.closed))?;
        }
        Ok(list)
    }

    /// The zero set in space.
    #[pyo3(signature = (subdivisions, all_branches) -> "dict[str, Any]")]
    fn surface<'py>(&self, py: Python<'py>, subdivisions: u32, all_branches: bool) -> PyResult<Bound<'py, PyDict>> {
        let Space::Volume(kept) = &self.0 else {
            return Err(Failure::parameter("the zero set of a fit in the plane is made of lines; ask for them").into());
        };
        let places = kept.places()?;
        let branches = if all_branches { Branches::All } else { Branches::WithData(&places) };
        let mesh = py.detach(|| zero_surface(&kept.fitted.function(kept.basis.as_ref()), subdivisions, branches));
        crate::mesh::to_python(py, mesh)
    }
}
