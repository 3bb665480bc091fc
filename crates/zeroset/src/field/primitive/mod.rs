//! Solids that have a formula, and solids given by triangles. All are true signed distances, but for the height field.

mod ball;
mod cuboid;
mod frustum;
mod half_space;
mod height_field;
mod mesh_solid;
mod planar;
mod prism;

pub use ball::Ball;
pub use cuboid::Cuboid;
pub use frustum::Frustum;
pub use half_space::HalfSpace;
pub use height_field::HeightField;
pub use mesh_solid::MeshSolid;
pub use prism::Prism;
