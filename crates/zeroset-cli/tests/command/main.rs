//! The built command, as a user runs it.

mod bad_input;
mod bad_output;
mod common;
mod constraints;
mod features;
mod features_found;
mod fit2d;
mod interrupt;
mod measure;
mod models;
mod reconstruct;
mod render;
mod simplify;
mod tiles;
mod usage;
mod view;
