//! Solids as trees of operands.

use std::sync::Arc;

use super::Fitted;
use crate::field::{
    Ball, Complement, Cuboid, Difference, Field, FieldError, Frustum, HalfSpace, HeightField, Intersection, MeshSolid,
    Metric, Offset, Placed, Placement, Prism, Shell, SmoothUnion, Tagged, Union,
};
use crate::mesh::Mesh;
use crate::vec3::{self, Vec3};

/// A solid: a primitive, a mesh, a fitted model, or what is made of other solids. Coordinates are those of the world.
#[derive(Debug, Clone)]
pub enum Solid {
    /// All on the side of a plane that its normal points away from.
    HalfSpace {
        /// A position on the plane.
        point: [f64; 3],
        /// The direction out of the solid, of any length.
        normal: [f64; 3],
    },
    /// A box along the axes.
    Cuboid {
        /// Two opposite corners.
        corners: [[f64; 3]; 2],
    },
    /// A ball.
    Ball {
        /// Its centre.
        center: [f64; 3],
        /// Its radius.
        radius: f64,
    },
    /// A cylinder, a cone, or a truncated one.
    Frustum {
        /// The ends of its axis.
        ends: [[f64; 3]; 2],
        /// The radius at each; one may be zero.
        radii: [f64; 2],
    },
    /// A polygon between two heights.
    Prism {
        /// Rings in plan; what lies within an odd number of them is solid.
        rings: Vec<Vec<[f64; 2]>>,
        /// The two heights.
        heights: [f64; 2],
    },
    /// All that lies under a grid of heights.
    HeightField {
        /// The first node.
        origin: [f64; 2],
        /// Distances between nodes along x and y.
        step: [f64; 2],
        /// Number of nodes along x and y.
        count: [usize; 2],
        /// The heights, x fastest.
        heights: Arc<Vec<f64>>,
    },
    /// What a closed mesh surrounds.
    Mesh(Arc<Mesh>),
    /// What was fitted to points.
    Fitted(Arc<Fitted>),
    /// All that lies in one operand or more.
    Union(Vec<Solid>),
    /// What lies in all operands.
    Intersection(Vec<Solid>),
    /// What lies in the first and not in the second.
    Difference(Box<[Solid; 2]>),
    /// What does not lie in it.
    Complement(Box<Solid>),
    /// The union of two, with the concave edges where they meet filled.
    SmoothUnion {
        /// The operands.
        of: Box<[Solid; 2]>,
        /// Radius of the fill.
        radius: f64,
    },
    /// A solid grown by a distance, or shrunk by a negative one.
    Offset {
        /// The operand.
        of: Box<Solid>,
        /// The distance.
        distance: f64,
    },
    /// A wall, half of it on either side of the surface.
    Shell {
        /// The operand.
        of: Box<Solid>,
        /// The thickness.
        thickness: f64,
    },
    /// A solid elsewhere.
    Placed {
        /// The operand.
        of: Box<Solid>,
        /// Where it goes.
        placement: Placement,
    },
}

impl Solid {
    /// The solids that it is made of.
    #[must_use]
    pub fn operands(&self) -> &[Self] {
        match self {
            Self::Union(of) | Self::Intersection(of) => of,
            Self::Difference(of) | Self::SmoothUnion { of, .. } => of.as_slice(),
            Self::Complement(of) | Self::Offset { of, .. } | Self::Shell { of, .. } | Self::Placed { of, .. } => {
                std::slice::from_ref(&**of)
            }
            _ => &[],
        }
    }

    /// F as a function of local positions: the world position less `origin`.
    ///
    /// Fitted models know distances near their surface only: no offset or shell can be made of them. Make a mesh first, and take that.
    ///
    /// # Errors
    /// If a shape has no volume, a number is not finite, or a mesh is not closed.
    pub fn field(&self, origin: [f64; 3]) -> Result<Arc<dyn Field>, FieldError> {
        self.with_leaves(origin, &mut Vec::new())
    }

    /// The same; fitted models are tagged with their places among the leaves that they are added to.
    pub(super) fn with_leaves(&self, origin: Vec3, leaves: &mut Vec<Leaf>) -> Result<Arc<dyn Field>, FieldError> {
        let local = |p: &Vec3| vec3::sub(*p, origin);
        let mut field = |solid: &Self| solid.with_leaves(origin, leaves);
        Ok(match self {
            Self::HalfSpace { point, normal } => Arc::new(HalfSpace::new(local(point), *normal)?),
            Self::Cuboid { corners: [a, b] } => Arc::new(Cuboid::new(local(a), local(b))?),
            Self::Ball { center, radius } => Arc::new(Ball::new(local(center), *radius)?),
            Self::Frustum { ends, radii } => Arc::new(Frustum::new(ends.each_ref().map(local), *radii)?),
            Self::Prism { rings, heights } => {
                let flat = |ring: &Vec<[f64; 2]>| ring.iter().map(|&[x, y]| [x - origin[0], y - origin[1]]).collect();
                let rings: Vec<Vec<[f64; 2]>> = rings.iter().map(flat).collect();
                Arc::new(Prism::new(&rings, heights.map(|z| z - origin[2]))?)
            }
            Self::HeightField { origin: first, step, count, heights } => {
                let first = [first[0] - origin[0], first[1] - origin[1]];
                let heights = heights.iter().map(|z| z - origin[2]).collect();
                Arc::new(HeightField::new(first, *step, *count, heights)?)
            }
            Self::Mesh(mesh) => {
                let shift = vec3::sub(mesh.world_from_local, origin);
                let vertices = mesh.vertices.iter().map(|&v| vec3::add(v, shift)).collect();
                Arc::new(MeshSolid::new(&Mesh { vertices, triangles: mesh.triangles.clone(), ..Mesh::default() })?)
            }
            Self::Fitted(fitted) => {
                let tag = leaves.len();
                leaves.push(Leaf {
                    fitted: Arc::clone(fitted),
                    shift: vec3::sub(fitted.parts().world_from_local, origin),
                });
                Arc::new(Tagged::new(Arc::new(fitted.field(origin)), tag))
            }
            Self::Union(of) => Arc::new(Union::new(of.iter().map(field).collect::<Result<_, _>>()?)?),
            Self::Intersection(of) => Arc::new(Intersection::new(of.iter().map(field).collect::<Result<_, _>>()?)?),
            Self::Difference(of) => Arc::new(Difference::new(field(&of[0])?, field(&of[1])?)),
            Self::Complement(of) => Arc::new(Complement::new(field(of)?)),
            Self::SmoothUnion { of, radius } => Arc::new(SmoothUnion::new(field(&of[0])?, field(&of[1])?, *radius)?),
            Self::Offset { of, distance } => Arc::new(Offset::new(exact(field(of)?)?, *distance)?),
            Self::Shell { of, thickness } => Arc::new(Shell::new(exact(field(of)?)?, *thickness)?),
            Self::Placed { of, placement } => {
                // The operand is held about the position that goes to the origin, so that its coordinates stay small.
                let own = placement.back(origin);
                Arc::new(Placed::new(of.with_leaves(own, leaves)?, placement.without_shift()))
            }
        })
    }
}

/// A fitted model among the operands of a solid.
pub(super) struct Leaf {
    pub(super) fitted: Arc<Fitted>,
    /// From its local positions to those of the field.
    pub(super) shift: Vec3,
}

/// A field whose values are lengths.
fn exact(field: Arc<dyn Field>) -> Result<Arc<dyn Field>, FieldError> {
    if field.metric() <= Metric::Bound {
        return Ok(field);
    }
    Err(FieldError::Empty(
        "an offset or shell of a fitted model is not possible, as it knows distances near its surface only: \
         make a mesh of it first, and take that",
    ))
}
