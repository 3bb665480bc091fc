//! What was fitted to a cloud, with all that a mesh of it needs.

use std::sync::Arc;

use rayon::prelude::*;

use super::ModelError;
use crate::cloud::Attributes;
use crate::constraint::{Local, LocalPolygon};
use crate::contour::Known;
use crate::domain::BLOCK_NODES;
use crate::feature::{Facets, Flat};
use crate::field::{Field, LatticeField, LatticeSolid, Metric, Placed, Placement};
use crate::fit::Frame;
use crate::fit::cascade::Scene;
use crate::spatial::PointTree;
use crate::vec3::{self, Vec3};

/// The distance between samples on constraints, over the cell.
pub(crate) const SAMPLES_REL: f64 = 0.5;

/// What is known beside F, as plain data. Positions are local: the world position is the local one plus `world_from_local`.
#[derive(Debug, Clone)]
pub struct FittedParts {
    /// What to add to a local position to get the world position.
    pub world_from_local: [f64; 3],
    /// The scene that was fitted.
    pub scene: Scene,
    /// The frame of the fit: the rows of the rotation that leads there from the local frame.
    pub frame: [[f64; 3]; 3],
    /// What |F| is.
    pub metric: Metric,
    /// The box of the points.
    pub bounds: [[f64; 3]; 2],
    /// Standard deviation of the noise of the points.
    pub noise: f64,
    /// Surface farther than this from the points is dropped.
    pub trim: Option<f64>,
    /// Pieces of a mesh with fewer triangles are dropped.
    pub min_component: Option<usize>,
    /// The points.
    pub points: Vec<[f32; 3]>,
    /// What was measured beside them.
    pub attributes: Attributes,
    /// The planes among them; `None` in a draft.
    pub structure: Option<Structure>,
    /// The user's lines that the surface passes through, as segments.
    pub lines: Vec<Vec<[[f64; 3]; 2]>>,
    /// The user's polygons that it passes through, as triangles.
    pub polygons: Vec<[[f64; 3]; 3]>,
}

/// The planes of a surface, and which points lie on them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Structure {
    /// Unit normal, which points outward, and `normal . x` of the positions x of each plane.
    pub planes: Vec<([f64; 3], f64)>,
    /// The polygons of the planes, as triangles.
    pub triangles: Vec<[[f64; 3]; 3]>,
    /// The plane of each triangle.
    pub plane_of_triangle: Vec<u32>,
    /// The plane of each point.
    pub plane_of_point: Vec<Option<u32>>,
    /// Whether curved parts may have creases.
    pub curved_creases: bool,
}

/// What was fitted to a cloud: F, and what is known of its surface.
#[derive(Debug)]
pub struct Fitted {
    solid: Arc<LatticeSolid>,
    frame: Frame,
    parts: FittedParts,
}

impl Fitted {
    /// Takes F, in the frame of the fit, and what is known beside it.
    ///
    /// # Errors
    /// If a list is not as long as it should be, an index is out of range, or a number is not finite.
    pub fn new(field: LatticeField, parts: FittedParts) -> Result<Self, ModelError> {
        Self::with(field, parts, LatticeSolid::new)
    }

    /// Takes a fit that was kept: the nodes of F whose value is not known have a sign.
    ///
    /// # Errors
    /// As for [`Self::new`].
    pub fn kept(field: LatticeField, parts: FittedParts) -> Result<Self, ModelError> {
        Self::with(field, parts, LatticeSolid::filled)
    }

    fn with(
        field: LatticeField,
        parts: FittedParts,
        solid: impl Fn(LatticeField, Metric) -> LatticeSolid,
    ) -> Result<Self, ModelError> {
        check_lattice(&field)?;
        parts.check()?;
        let frame = Frame::from_rows(parts.frame).ok_or(ModelError::Inconsistent("its frame is no rotation"))?;
        Ok(Self { solid: Arc::new(solid(field, parts.metric)), frame, parts })
    }

    /// Everything but F: see [`Self::lattice`].
    #[must_use]
    pub fn parts(&self) -> &FittedParts {
        &self.parts
    }

    /// F on its lattice, in the frame of the fit.
    #[must_use]
    pub fn lattice(&self) -> &LatticeField {
        self.solid.fitted()
    }

    /// The spacing of the lattice.
    #[must_use]
    pub fn cell(&self) -> f64 {
        self.lattice().lattice.spacing
    }

    /// What was measured beside the points.
    pub(super) fn attributes(&self) -> &Attributes {
        &self.parts.attributes
    }

    /// The points.
    pub(super) fn positions(&self) -> Vec<Vec3> {
        self.parts.points.par_iter().map(|p| p.map(f64::from)).collect()
    }

    pub(super) fn frame(&self) -> Frame {
        self.frame
    }

    /// Whether the surface is open ground, which ends where its points do.
    pub(super) fn is_ground(&self) -> bool {
        matches!(self.parts.scene, Scene::Terrain | Scene::Airborne)
    }

    /// The user's lines and polygons.
    pub(crate) fn held(&self) -> Local {
        let lines = self.parts.lines.clone();
        let polygons = match self.parts.polygons.as_slice() {
            [] => Vec::new(),
            triangles => {
                let area = triangles.iter().map(|t| crate::domain::polygon_area(t)).sum();
                vec![LocalPolygon { triangles: triangles.to_vec(), normal: [0.0, 0.0, 1.0], area }]
            }
        };
        Local { lines, polygons, ..Local::default() }
    }

    /// F as a function of the world position less `origin`.
    pub(super) fn field(&self, origin: Vec3) -> Placed {
        let shift = vec3::sub(self.parts.world_from_local, origin);
        Placed::new(Arc::clone(&self.solid) as Arc<dyn Field>, self.frame.exit(shift))
    }

    /// What the points show of the surface, elsewhere: local positions are first moved by `shift` and then placed.
    pub(super) fn evidence(&self, shift: Vec3, placement: &Placement, is_reversed: bool) -> Option<Evidence> {
        let structure = self.parts.structure.as_ref()?;
        let at = |p: Vec3| placement.of(vec3::add(p, shift));
        let sign = if is_reversed { -1.0 } else { 1.0 };
        let flat = |&(normal, offset): &(Vec3, f64)| {
            let on = at(vec3::scale(normal, offset));
            Flat::through(vec3::scale(placement.of_direction(normal), sign), on)
        };
        let triangles = structure.triangles.iter().map(|t| t.map(at)).collect();
        let flats = structure.planes.iter().map(flat).collect();
        let positions: Vec<Vec3> = self.parts.points.par_iter().map(|p| at(p.map(f64::from))).collect();
        Some(Evidence {
            facets: Facets::of(flats, triangles, structure.plane_of_triangle.clone()),
            tree: PointTree::new(&positions),
            positions,
            plane_of: structure.plane_of_point.clone(),
            curved_creases: structure.curved_creases,
            noise: placement.scale() * self.parts.noise,
        })
    }
}

/// What the points show of a surface: its planes, and themselves.
pub(super) struct Evidence {
    facets: Facets,
    positions: Vec<Vec3>,
    tree: PointTree,
    plane_of: Vec<Option<u32>>,
    curved_creases: bool,
    noise: f64,
}

impl Evidence {
    /// The same for a mesh made on cells of a size.
    pub(super) fn known(&self, cell: f64) -> Known<'_> {
        Known {
            facets: &self.facets,
            positions: &self.positions,
            points: &self.tree,
            plane_of: &self.plane_of,
            curved_creases: self.curved_creases,
            noise: self.noise,
            cell,
        }
    }
}

/// Checks that blocks and values fit together and numbers are finite.
fn check_lattice(field: &LatticeField) -> Result<(), ModelError> {
    let wrong = |what: &'static str| Err(ModelError::Inconsistent(what));
    let blocks = field.blocks.len();
    if field.known.len() != blocks || field.values.len() != blocks * BLOCK_NODES {
        return wrong("its blocks and values differ in number");
    }
    let extent = field.lattice.blocks_at(field.lattice.finest);
    if field.blocks.coordinates.iter().any(|c| (0..3).any(|a| c[a] >= extent[a])) {
        return wrong("a block lies outside of its lattice");
    }
    if !field.values.par_iter().all(|v| v.is_finite()) {
        return wrong("a value is not finite");
    }
    Ok(())
}

impl FittedParts {
    /// Checks that lists fit together and numbers are finite.
    fn check(&self) -> Result<(), ModelError> {
        let wrong = |what: &'static str| Err(ModelError::Inconsistent(what));
        let finite = |values: &[f64]| values.iter().all(|v| v.is_finite());
        let points = self.points.len();
        if !finite(&self.world_from_local) || !finite(self.bounds.as_flattened()) || !finite(&[self.noise]) {
            return wrong("its placement is not finite");
        }
        if self.trim.is_some_and(|trim| !(trim.is_finite() && trim > 0.0)) {
            return wrong("its trim is not positive");
        }
        if !self.points.par_iter().flatten().all(|c| c.is_finite()) {
            return wrong("a point is not finite");
        }
        let attributes = &self.attributes;
        let counts = [
            attributes.colors.as_ref().map(Vec::len),
            attributes.intensities.as_ref().map(Vec::len),
            attributes.classes.as_ref().map(Vec::len),
            self.structure.as_ref().map(|structure| structure.plane_of_point.len()),
        ];
        if counts.into_iter().flatten().any(|count| count != points) {
            return wrong("a list does not have one entry for each point");
        }
        if !self.lines.iter().flatten().all(|ends| finite(ends.as_flattened()))
            || !self.polygons.iter().all(|t| finite(t.as_flattened()))
        {
            return wrong("a constraint is not finite");
        }
        self.structure.as_ref().map_or(Ok(()), |structure| {
            let planes = structure.planes.len();
            let is_there = |plane: u32| (plane as usize) < planes;
            if structure.plane_of_triangle.len() != structure.triangles.len() {
                return wrong("its polygons and their planes differ in number");
            }
            if !structure.plane_of_triangle.iter().all(|&p| is_there(p))
                || !structure.plane_of_point.iter().flatten().all(|&p| is_there(p))
            {
                return wrong("a plane is missing");
            }
            let is_unit = |normal: &Vec3| (vec3::norm(*normal) - 1.0).abs() < 1e-6;
            if !structure.planes.iter().all(|(normal, offset)| is_unit(normal) && offset.is_finite())
                || !structure.triangles.iter().all(|t| finite(t.as_flattened()))
            {
                return wrong("a plane is not finite");
            }
            Ok(())
        })
    }
}
