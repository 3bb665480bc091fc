//! The surface of any field, sharp where its sheets meet.

use rayon::prelude::*;
use serde::Serialize;

use super::clip::clip_at_box;
use super::dual::contour;
use super::sharp::{SharpReport, sharpen_field};
use super::wedges::mend;
use crate::domain::{BLOCK_NODES, Blocks, Lattice, LatticeError, Mask, block_key, dilate_box, mask_get};
use crate::field::{Field, LatticeField};
use crate::mesh::Mesh;
use crate::monitor::{Cancelled, Monitor, check};
use crate::vec3::Vec3;

/// Where and how finely a field is made into a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FieldContourParams {
    /// Side of the cubes in which the surface is looked for. What is smaller is missed or rounded off, but for edges and corners.
    pub cell: f64,
    /// The box to look in; where the surface goes on beyond it, it is cut there and left open. `None` for the field's own
    /// [`extent`](Field::extent).
    pub bounds: Option<[[f64; 3]; 2]>,
}

/// Why a field was not made into a mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FieldContourError {
    /// The surface has no end, and no box was given.
    #[error("the surface has no end that is known: give the box to look in")]
    NoBounds,
    /// The box given is empty, or not finite.
    #[error("the box given has no volume: its second corner must be beyond the first along each axis")]
    EmptyBounds,
    /// The cells are not possible.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// No surface lies in the box.
    #[error("there is no surface in the box: the solid is empty there, or fills it")]
    NoSurface,
    /// The monitor asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// What was found.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FieldContourReport {
    /// Positions at which the field was evaluated on the lattice.
    pub values: usize,
    /// Cubes of 8 cells a side that the surface may go through, of those looked at on the way.
    pub blocks: [usize; 2],
    /// Vertices put in along creases.
    pub on_creases: usize,
    /// Vertices put in at corners.
    pub at_corners: usize,
    /// Triangles that are still folded or flat.
    pub folded: usize,
    /// Vertices taken back towards the lattice's surface, as triangles there cut through others.
    pub taken_back: usize,
    /// Pairs of triangles that cut through each other.
    pub intersections: u64,
}

/// Lattice nodes come to lie this share of a cell off the corners of the box, in each direction: faces through nodes make needles.
const OFF_CENTER: [f64; 3] = [0.137, 0.289, 0.411];
/// Cells around the box.
const MARGIN: f64 = 2.0;
/// Vertices this near to the box, in cells, are moved onto it.
pub(crate) const SNAP: f64 = 0.05;

/// Extracts the surface of a field.
///
/// Space is halved as long as bounds leave it open whether the surface passes, so none of it is missed that the lattice can see. Vertices lie on
/// the sheets of the field, and mesh edges along the lines and corners in which they meet, each found by Newton's method.
///
/// Walls and gaps of two cells between parallel sheets, and of 2.5 cells between others, are kept. What is thinner, the tip of a wedge, say, may end a little before its
/// line, or be parted.
///
/// Not guaranteed: what is thinner than a cell within one sheet, as of a closed mesh or a fitted model, may have holes and fall to pieces.
///
/// Positions are those of the field. Closed where the field's own extent is used, or the box holds the surface.
///
/// # Errors
/// If the field has no extent and no box is given, if the cells are too fine or not positive, if there is no surface, or if the monitor
/// stops.
///
/// ```
/// use std::sync::Arc;
/// use zeroset::contour::{FieldContourParams, contour_field};
/// use zeroset::field::{Cuboid, Difference, Frustum};
/// use zeroset::mesh::topology;
///
/// let block = Cuboid::new([0.0; 3], [2.0, 2.0, 1.0])?;
/// let hole = Frustum::cylinder([[1.0, 1.0, -1.0], [1.0, 1.0, 2.0]], 0.5)?;
/// let part = Difference::new(Arc::new(block), Arc::new(hole));
/// let params = FieldContourParams { cell: 0.05, bounds: None };
/// let (mesh, _) = contour_field(&part, &params, &())?;
/// let topology = topology(&mesh)?;
/// assert_eq!(topology.genus, Some(1));
/// let exact = 4.0 - std::f64::consts::PI / 4.0;
/// assert!((topology.volume.unwrap() - exact).abs() < 0.001 * exact);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn contour_field(
    field: &dyn Field,
    params: &FieldContourParams,
    monitor: &dyn Monitor,
) -> Result<(Mesh, FieldContourReport), FieldContourError> {
    let [low, high] = params.bounds.or_else(|| field.extent()).ok_or(FieldContourError::NoBounds)?;
    if !(0..3).all(|a| low[a].is_finite() && high[a].is_finite() && low[a] < high[a]) {
        return Err(if params.bounds.is_some() {
            FieldContourError::EmptyBounds
        } else {
            FieldContourError::NoSurface
        });
    }
    let lattice = lattice_around([low, high], params.cell)?;
    monitor.stage("looking for the surface");
    let (sampled, looked_at) = sampled(field, lattice, monitor)?;
    let values = sampled.known_nodes();
    let blocks = [sampled.blocks.len(), looked_at];
    check(monitor)?;
    monitor.stage("extracting the surface");
    let (mut mesh, _) = contour(&sampled, |_| true);
    drop(sampled);
    if mesh.triangles.is_empty() {
        return Err(FieldContourError::NoSurface);
    }
    check(monitor)?;
    monitor.stage("making edges sharp");
    let SharpReport { on_creases, at_corners, folded, taken_back, intersections, .. } =
        sharpen_field(&mut mesh, field, &[], params.cell);
    if params.bounds.is_some() {
        clip_at_box(&mut mesh, [low, high], 0..3, SNAP * params.cell, None);
    }
    if mesh.triangles.is_empty() {
        return Err(FieldContourError::NoSurface);
    }
    Ok((mesh, FieldContourReport { values, blocks, on_creases, at_corners, folded, taken_back, intersections }))
}

/// A lattice over a box that holds a surface.
pub(crate) fn lattice_around([low, high]: [[f64; 3]; 2], cell: f64) -> Result<Lattice, LatticeError> {
    let first = Lattice::new(std::array::from_fn(|a| low[a] + OFF_CENTER[a] * cell), cell, 0, [1; 3])?;
    first.over(low.map(|c| c - MARGIN * cell), high.map(|c| c + MARGIN * cell))
}

/// Where a node of a block of the finest level is.
pub(super) fn position(lattice: &Lattice, blocks: &Blocks, block: usize, local: usize) -> Vec3 {
    let step = [local & 7, local >> 3 & 7, local >> 6];
    let node = std::array::from_fn(|a| f64::from(8 * blocks.coordinates[block][a] + step[a] as u32));
    lattice.position(lattice.finest, node)
}

/// The values of a field at the nodes around its surface, mended where sheets are near, and the number of cubes looked at to find it.
pub(crate) fn sampled(
    field: &dyn Field,
    lattice: Lattice,
    monitor: &dyn Monitor,
) -> Result<(LatticeField, usize), Cancelled> {
    let mut looked_at = 0;
    let [x, y, z] = lattice.blocks_at(0);
    let mut open: Vec<[u32; 3]> =
        (0..x).flat_map(|i| (0..y).flat_map(move |j| (0..z).map(move |k| [i, j, k]))).collect();
    for level in 0..=lattice.finest {
        check(monitor)?;
        looked_at += open.len();
        let may_cross = |block: &[u32; 3]| {
            let corner = |step: u32| lattice.position(level, block.map(|c| f64::from(8 * (c + step))));
            field.bounds(corner(0), corner(1)).contains(0.0)
        };
        open = open.into_par_iter().filter(may_cross).collect();
        if level < lattice.finest {
            let halves =
                |block: [u32; 3]| (0..8_u32).map(move |k| std::array::from_fn(|a| 2 * block[a] + (k >> a & 1)));
            open = open.into_iter().flat_map(halves).collect();
        }
    }
    let mut kept: Vec<u64> = open.into_iter().map(block_key).collect();
    kept.par_sort_unstable();
    let extent = lattice.blocks_at(lattice.finest);
    // Cells at the rim of these blocks need the nodes beyond it.
    let keys = Blocks::grown_keys(&kept, extent);
    let is_kept = |key: &u64| if kept.binary_search(key).is_ok() { [u64::MAX; 8] } else { [0; 8] };
    let masks: Vec<Mask> = keys.iter().map(is_kept).collect();
    let blocks = Blocks::new(keys, extent);
    let known = dilate_box(&blocks, &masks);
    let values = (0..blocks.len()).into_par_iter().flat_map_iter(|b| {
        let (known, lattice, blocks) = (&known[b], &lattice, &blocks);
        (0..BLOCK_NODES).map(move |local| {
            if !mask_get(known, local) {
                return 0.0;
            }
            field.value(position(lattice, blocks, b, local)) as f32
        })
    });
    let values: Vec<f32> = values.collect();
    let mut sampled = LatticeField::new(lattice, blocks, known, values);
    mend(&mut sampled, field);
    Ok((sampled, looked_at))
}
