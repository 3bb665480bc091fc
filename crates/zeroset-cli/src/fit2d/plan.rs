//! From what was typed to what is fitted: every default resolved.

use zeroset::basis::{Basis, Derivatives, Kernel, P1, P2, Radial, Tail, Terms, farthest_points};
use zeroset::domain::SimplicialMesh;
use zeroset::fit::normalized::Data;
use zeroset_io::PlanarData;

use super::Fit2dError;
use super::measure::{self, Extent};
use crate::args::{BasisChoice, DomainChoice, Fit2dArgs};

/// The box is that of the data, grown by this share of its longer side.
const MARGIN_REL: f64 = 0.1;
/// The flatness of the contour, as a share of the longer side of the domain.
const TOLERANCE_REL: f64 = 1e-3;
/// Least flatness: a finer contour has more points than anyone can use.
const LEAST_TOLERANCE_REL: f64 = 1e-7;
/// Smoothness of order 1 over the data's weight and the side of a cell in longer sides of the domain. A curve three sides long then
/// has four times the weight of the smoothness in each cell, as in the cascade, whose noise is a quarter of a cell.
const SMOOTHNESS_1_REL: f64 = 1.0 / 12.0;
/// Smoothness of order 2 over the data's weight and the square of the longer side. A circle bends by about ten over that square.
const SMOOTHNESS_2_REL: f64 = 1e-6;
/// Radial functions.
const MOST_CENTRES: usize = 60;
/// Width of radial functions over the spacing of their centres. With noisy clovers, peanuts, ellipses and pairs of circles every kernel
/// gives the curve alone; at 2 Gaussians and Wendland's functions add curves away from the data, where they have decayed.
const WIDE: f64 = 5.0;
/// The same without smoothness, where wide functions are hardly told apart, and for thin plates, which do not decay: at 5 they add curves
/// to the ellipse.
const NARROW: f64 = 2.0;
/// Wendland's functions end at their width; so far out others have decayed.
const WENDLAND: f64 = 3.0;

/// The side of a square that is as large as two mean triangles.
fn cell_side(mesh: &SimplicialMesh<2>) -> f64 {
    let area: f64 = (0..mesh.len()).map(|triangle| mesh.volume(triangle)).sum();
    (2.0 * area / mesh.len() as f64).sqrt()
}

/// What is fitted.
pub(super) struct Plan {
    pub(super) basis: Box<dyn Basis<2>>,
    /// Where F is known, in words.
    pub(super) domain_text: String,
    /// The same in the words of the option, or `file`.
    pub(super) domain_name: &'static str,
    /// What a user may want to do otherwise.
    pub(super) note: Option<&'static str>,
    /// The box around the domain.
    pub(super) extent: Extent,
    /// The width of radial functions.
    pub(super) width: Option<f64>,
    pub(super) smoothness: f64,
    pub(super) tolerance: f64,
}

pub(super) fn resolve(args: &Fit2dArgs, input: &PlanarData, data: &Data<2>) -> Result<Plan, Fit2dError> {
    let centres = Centres::new(args, input);
    let domain = Domain::new(args, input, data, centres.as_ref())?;
    let extent = Extent::of(domain.mesh.vertices().iter());
    let longer = extent.longer_side();
    let weight = input.points.iter().map(|p| p.weight).sum::<f64>() + args.line_weight * measure::length(input);
    let smoothness = match args.order {
        0 => 0.0,
        1 => args.smoothness.unwrap_or(SMOOTHNESS_1_REL * weight * cell_side(&domain.mesh) / longer),
        _ => args.smoothness.unwrap_or(SMOOTHNESS_2_REL * weight * longer * longer),
    };
    let width = centres.as_ref().map(|c| c.width);
    Ok(Plan {
        basis: basis(args.basis, domain.mesh, centres)?,
        domain_text: domain.text,
        domain_name: domain.name,
        note: domain.note,
        extent,
        width,
        smoothness,
        tolerance: args.tolerance.unwrap_or(TOLERANCE_REL * longer).max(LEAST_TOLERANCE_REL * longer),
    })
}

/// Where radial functions sit.
struct Centres {
    positions: Vec<[f64; 2]>,
    width: f64,
}

impl Centres {
    /// `None` for functions that are not radial.
    fn new(args: &Fit2dArgs, input: &PlanarData) -> Option<Self> {
        if matches!(args.basis, BasisChoice::P1 | BasisChoice::P2) {
            return None;
        }
        let places = measure::places(input);
        let count = args.centres.map_or(MOST_CENTRES, |n| n as usize);
        let positions: Vec<[f64; 2]> = farthest_points(&places, count).into_iter().map(|i| places[i]).collect();
        let spacing = measure::mean_spacing(&positions);
        // One centre alone has no spacing: then the size of the data tells, and where they have none any length serves.
        let lengths = [spacing, Extent::of(places.iter()).longer_side()];
        let spacing = lengths.into_iter().find(|&length| length > 0.0).unwrap_or(1.0);
        let over = match args.basis {
            BasisChoice::ThinPlate => NARROW,
            _ if args.order == 0 => NARROW,
            _ => WIDE,
        };
        let ends = matches!(args.basis, BasisChoice::WendlandC2 | BasisChoice::WendlandC4);
        let default = spacing * over * if ends { WENDLAND } else { 1.0 };
        Some(Self { positions, width: args.width.unwrap_or(default) })
    }
}

/// The functions.
fn basis(
    choice: BasisChoice,
    mesh: SimplicialMesh<2>,
    centres: Option<Centres>,
) -> Result<Box<dyn Basis<2>>, Fit2dError> {
    let Some(Centres { positions, width }) = centres else {
        return Ok(if choice == BasisChoice::P2 { Box::new(P2::new(mesh)) } else { Box::new(P1::new(mesh)) });
    };
    let kernel = match choice {
        BasisChoice::Multiquadric => Kernel::Multiquadric { width },
        BasisChoice::InverseMultiquadric => Kernel::InverseMultiquadric { width },
        BasisChoice::ThinPlate => Kernel::ThinPlate { width },
        BasisChoice::WendlandC2 => Kernel::WendlandC2 { width },
        BasisChoice::WendlandC4 => Kernel::WendlandC4 { width },
        BasisChoice::Gaussian | BasisChoice::P1 | BasisChoice::P2 => Kernel::Gaussian { width },
    };
    // A constant beside functions that decay would give both sides of the curve one sign away from the data.
    Ok(Box::new(Radial::new(mesh, kernel, positions, Tail::None)?))
}

/// Where F is known, and how that came about.
struct Domain {
    mesh: SimplicialMesh<2>,
    text: String,
    name: &'static str,
    note: Option<&'static str>,
}

/// What is said where the data bear next to no cells.
const FEW_CELLS: &str = "without smoothness the data bear no more cells; `--normalization squared-gradient --order 2` bears finer ones, --cells takes any";

impl Domain {
    fn new(
        args: &Fit2dArgs,
        input: &PlanarData,
        data: &Data<2>,
        centres: Option<&Centres>,
    ) -> Result<Self, Fit2dError> {
        if let (None, Some(given)) = (args.domain, &input.domain) {
            for (is_given, option) in [(args.bounds.is_some(), "--bounds"), (args.cells.is_some(), "--cells")] {
                if is_given {
                    return Err(Fit2dError::DomainGiven { option });
                }
            }
            let mesh = SimplicialMesh::from_triangles(given.vertices.clone(), &given.triangles)?;
            let text = format!("{} triangles of the file", mesh.len());
            return Ok(Self { mesh, text, name: "file", note: None });
        }
        let extent = extent(args, input)?;
        match args.domain.unwrap_or(DomainChoice::Lattice) {
            DomainChoice::Four => {
                let mesh = SimplicialMesh::four_triangles(extent.low, extent.high)?;
                Ok(Self { mesh, text: "four triangles".into(), name: "four", note: None })
            }
            DomainChoice::Delaunay => Self::delaunay(args, input, extent),
            DomainChoice::Lattice => {
                let along = match (args.cells, centres) {
                    (Some(cells), _) => cells,
                    (None, Some(centres)) => cells_for_width(extent, centres.width),
                    (None, None) => cells_for_data(args, input, data, extent),
                };
                let cells = cells(extent, along);
                let mesh = SimplicialMesh::lattice(extent.low, extent.high, cells)?;
                let text = format!("a lattice of {} x {} cells", cells[0], cells[1]);
                let is_poor = args.cells.is_none() && args.order == 0 && along <= 2;
                Ok(Self { mesh, text, name: "lattice", note: is_poor.then_some(FEW_CELLS) })
            }
        }
    }

    fn delaunay(args: &Fit2dArgs, input: &PlanarData, extent: Extent) -> Result<Self, Fit2dError> {
        let places = measure::places(input);
        let count = args.sites.map_or((places.len() / 4).clamp(4, 60), |n| n as usize);
        let Extent { low, high } = extent;
        let mut sites = vec![low, [high[0], low[1]], high, [low[0], high[1]]];
        let chosen = farthest_points(&places, count);
        sites.extend(chosen.into_iter().map(|i| places[i]));
        let mesh = SimplicialMesh::<2>::delaunay(&sites)?;
        let text = format!("{} Delaunay triangles of {} sites", mesh.len(), mesh.vertices().len());
        Ok(Self { mesh, text, name: "delaunay", note: None })
    }
}

fn extent(args: &Fit2dArgs, input: &PlanarData) -> Result<Extent, Fit2dError> {
    if let Some(bounds) = args.bounds {
        return Ok(Extent { low: bounds.low, high: bounds.high });
    }
    let tight = Extent::of(measure::positions(input));
    let longer = tight.longer_side();
    if longer > 0.0 { Ok(tight.grown(MARGIN_REL * longer)) } else { Err(Fit2dError::OnePlace) }
}

/// Cells that are about square.
fn cells(extent: Extent, along: u32) -> [u32; 2] {
    let longer = extent.longer_side();
    extent.sides().map(|side| ((f64::from(along) * side / longer).round() as u32).clamp(1, along))
}

/// The integrals of radial functions and their zero set need cells no longer than half the width.
fn cells_for_width(extent: Extent, width: f64) -> u32 {
    /// The zero set is traced by the signs at the corners of the cells: fewer would miss what F does between them.
    const LEAST: f64 = 40.0;
    /// Beyond this the cells are too small to see.
    const MOST: f64 = 120.0;
    (2.0 * extent.longer_side() / width).ceil().clamp(LEAST, MOST) as u32
}

/// The most cells along the longer side that data bear.
///
/// With smoothness, about twice the root of the number of data. Without, the most with which no function is left to a few data at
/// the rim of where it lives: such a function costs next to no energy, and F would sit on it alone.
fn cells_for_data(args: &Fit2dArgs, input: &PlanarData, data: &Data<2>, extent: Extent) -> u32 {
    /// More data than this choose no finer lattice.
    const MOST_DATA: usize = 4096;
    /// A function must have this share of the mean energy.
    const LEAST_SHARE: f64 = 0.05;
    let root = (measure::places(input).len().min(MOST_DATA) as f64).sqrt();
    if args.order > 0 {
        return (2.0 * root).ceil().clamp(8.0, 64.0) as u32;
    }
    let most = (root / 2.0).ceil().clamp(1.0, 32.0) as u32;
    let is_borne = |along: u32| -> Option<bool> {
        let mesh = SimplicialMesh::lattice(extent.low, extent.high, cells(extent, along)).ok()?;
        let basis = basis(args.basis, mesh, None).ok()?;
        let mut sums = vec![0.0; basis.len()];
        let mut terms = Terms::new();
        for sample in data.samples(basis.as_ref()).ok()? {
            basis.evaluate(&sample.place, Derivatives::None, &mut terms);
            for (&j, value) in terms.indices.iter().zip(&terms.values) {
                sums[j as usize] += sample.weight * value * value;
            }
        }
        let mean = sums.iter().sum::<f64>() / sums.len() as f64;
        Some(sums.iter().all(|&sum| sum >= LEAST_SHARE * mean))
    };
    (2..=most).rev().find(|&along| is_borne(along) == Some(true)).unwrap_or(1)
}
