//! F as a function of space.

mod lattice_field;

pub use lattice_field::LatticeField;
