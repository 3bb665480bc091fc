//! What reading clouds and meshes from PLY have in common: the header and the walk through the body.

pub(crate) mod body;
pub(crate) mod header;
