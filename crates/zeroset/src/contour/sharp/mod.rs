//! Sharp features: vertices on the planes, edges and corners of the surface, and mesh edges along its creases.
//!
//! # What
//! F rounds edges off by up to a cell, and ripples on faces. This takes the extracted mesh and what is known of the surface, its
//! planes and its points, and gives a mesh whose vertices lie on the surface's smooth parts, here called *sheets*, and whose edges run where
//! two sheets meet.
//!
//! # How
//! 1. Each vertex gets its sheet: the plane whose polygon is nearest, as far as F reaches; or, where the nearest points lie on no
//!    plane, the curved part it is on. Neighbours agree on it by majority.
//! 2. Near a crease a curved sheet is a quadric through the vertices of that side at which F is not rounded yet, carried on to the crease. Sides are
//!    told apart by normals that were averaged along the surface, but not across creases. F overshoots beside an edge, by up to a
//!    tenth of a cell; so the quadric is moved to the mean of its points.
//! 3. A crease must be borne out by its points: if along a stretch of it they lie where F is rather than where the sheets are, it is round in
//!    truth, and its vertices stay where F has them. One decision for a stretch, so creases are not nibbled at.
//! 4. Vertices move to their sheets. A mesh edge between two sheets gets a vertex on the line where their tangent planes meet; a triangle
//!    between three gets one where the three meet, and is cut accordingly. So every crease is a chain of mesh edges.
//! 5. Vertices on curved parts settle until the triangles face the way of their sheets.
//! 6. Triangles that were folded over or flattened on the way are mended by collapses and flips within one sheet.
//! 7. Vertices go onto a raster that single precision holds. Where triangles still cut through each other there, their vertices go back
//!    towards their places on the surface of F.
//!
//! # Guaranteed
//! The mesh stays a manifold with the same boundary, as triangles are only cut, and collapsed where that keeps a disc a disc. The same bits
//! on any number of threads.
//!
//! # Not guaranteed
//! That no two triangles cut through each other: [`SharpReport::intersections`] counts pairs that are left near creases. Edges
//! rounder than about half a cell are made sharp.
//!
//! # Cost
//! Linear in the vertices, with a logarithm for the nearest points and polygons.
//!
//! # Source
//! Ours. Placing a vertex where tangent planes meet: Kobbelt et al. 2001; there, too, an edge is recognised by normals alone.

mod creases;
mod curved;
mod embed;
mod evidence;
mod insert;
mod of_field;
mod settle;
mod sheets;
mod stars;
mod tidy;

#[cfg(test)]
mod tests;

use rayon::prelude::*;
use serde::Serialize;

use super::seam::Seam;
use crate::feature::{Facets, Flat};
use crate::mesh::Mesh;
use crate::spatial::PointTree;
use crate::vec3::Vec3;
pub(crate) use embed::Raster;
use insert::{Inserted, insert_creases};
pub(crate) use of_field::sharpen_field;
use stars::{Fans, Stars};

/// What the surface is known to be.
pub(crate) struct Known<'a> {
    /// Its planes.
    pub(crate) facets: &'a Facets,
    /// The points.
    pub(crate) positions: &'a [Vec3],
    /// The same as a tree.
    pub(crate) points: &'a PointTree,
    /// The plane of each point.
    pub(crate) plane_of: &'a [Option<u32>],
    /// Whether curved parts may have creases; if not, they stay as F has them.
    pub(crate) curved_creases: bool,
    /// Standard deviation of the noise of the points.
    pub(crate) noise: f64,
    /// Spacing of the lattice that the mesh was made on.
    pub(crate) cell: f64,
}

/// What was made sharp.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Default)]
pub struct SharpReport {
    /// Vertices put on planes.
    pub on_planes: usize,
    /// Vertices put in along creases.
    pub on_creases: usize,
    /// Vertices put in at corners.
    pub at_corners: usize,
    /// Length of the mesh edges along creases, in the units of the points.
    pub crease_length: f64,
    /// The mean angle, in degrees, by which the surface turns there, weighted by length; `None` without creases.
    pub crease_angle: Option<f64>,
    /// Triangles that were still folded or flat before vertices were taken back.
    pub folded: usize,
    /// Vertices taken back towards F, as triangles there cut through others.
    pub taken_back: usize,
    /// Pairs of triangles near creases that still cut through each other.
    pub intersections: u64,
}

/// How a vertex may move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Seat {
    /// It stays where F put it.
    Loose,
    /// Within a plane.
    On(Flat),
    /// Along a line: a position and a unit direction.
    Along(Vec3, Vec3),
    /// Not at all.
    At,
    /// Not at all, as it is on a seam.
    Held,
}

/// Makes a mesh sharp. What is held at a seam stays; vertices are put on a raster in any case, the given one or that of the mesh.
pub(crate) fn sharpen(mesh: &mut Mesh, known: &Known, seam: Option<(&mut Seam, Raster)>) -> SharpReport {
    let stars = Stars::new(mesh);
    let sheets = sheets::sheets(mesh, &stars, known);
    drop(stars);
    let on_planes = (0..mesh.vertices.len() as u32).filter(|&v| sheets.of(v).plane.is_some()).count();
    let first = mesh.vertices.len();
    let (seam, raster) = seam.unzip();
    let raster = raster.unwrap_or_else(|| Raster::new(mesh));
    let mut inserted = insert_creases(mesh, &sheets, insert::REACH * known.cell, seam.as_deref());
    drop(sheets);
    let finish =
        Finish { first, cell: known.cell, settle: Some(known.curved_creases), moved: embed::MOVED * known.cell };
    let report = SharpReport { on_planes, ..finish.run(mesh, &mut inserted, raster, |_, _| ()) };
    match seam {
        Some(seam) => seam.own = inserted.own,
        None => {
            super::clip::drop_unused(mesh);
        }
    }
    report
}

/// What is done once creases are in.
struct Finish {
    /// Vertices before there were creases.
    first: usize,
    cell: f64,
    /// Whether vertices on curved parts settle, and if so whether everywhere.
    settle: Option<bool>,
    /// Vertices that moved farther have their surroundings searched for triangles that cut through others.
    moved: f64,
}

impl Finish {
    /// Lets vertices settle, takes folds away, and takes vertices back where triangles cut through others. `refine` moves vertices before that.
    /// Leaves vertices without triangles.
    fn run(
        &self,
        mesh: &mut Mesh,
        inserted: &mut Inserted,
        raster: Raster,
        refine: impl Fn(&mut Mesh, &[Seat]),
    ) -> SharpReport {
        let on_creases = inserted.seats.iter().filter(|s| matches!(s, Seat::Along(..))).count();
        let at_corners = inserted.seats.iter().filter(|s| matches!(s, Seat::At)).count();
        inserted.origins.par_iter_mut().for_each(|origin| *origin = raster.nearest(*origin));
        let fans = Fans::new(mesh);
        if let Some(everywhere) = self.settle {
            settle::settle(mesh, &fans, inserted, everywhere);
        }
        let folded = tidy::tidy(mesh, fans, inserted, self.cell);
        refine(mesh, &inserted.seats);
        let (taken_back, intersections) = embed::embed(mesh, self.first, &inserted.origins, raster, self.moved);
        let (crease_length, crease_angle) = creases::measure(mesh, &inserted.seats);
        SharpReport {
            on_planes: 0,
            on_creases,
            at_corners,
            crease_length,
            crease_angle,
            folded,
            taken_back,
            intersections,
        }
    }
}
