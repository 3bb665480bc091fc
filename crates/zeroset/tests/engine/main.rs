//! The engine through its public functions.

mod constraints;
mod features;
mod free;
mod models;
mod reconstruct;
mod report_names;
mod sharp;
mod solids;
