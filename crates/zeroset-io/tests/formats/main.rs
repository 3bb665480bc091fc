//! Every format through the public functions: written, read back, damaged.

mod abandon;
mod atomic;
mod bad_input;
mod clouds;
mod common;
mod constraints;
mod features;
mod fuzz_seeds;
mod meshes;
mod models;
mod parts;
mod planar;
mod rasters;
mod real_files;
mod sections;
mod solid;
mod solid_trees;
mod tables;
