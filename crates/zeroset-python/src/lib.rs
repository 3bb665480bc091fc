//! What the Python package `zeroset` has of Rust: the module `zeroset._core`.
//!
//! The files in `python/zeroset` dress it: they hold the names, defaults, types and documentation that people see. Here are the arrays, the
//! threads and the errors.
//!
//! | module | does |
//! |---|---|
//! | `arrays` | reads arrays of NumPy where they lie, hands vectors over to NumPy |
//! | `watch` | runs work with the GIL released; progress, Ctrl-C, exceptions of callbacks |
//! | `error` | errors of the library as exceptions |
//! | `options` | parameters by name |
//! | the others | one each for what can be done |

mod arrays;
mod cloud;
mod command;
mod error;
mod features;
mod mesh;
mod newe;
mod normalized;
mod options;
mod reconstruct;
mod sample;
mod solid;
mod tiles;
mod watch;

/// The module.
#[pyo3::pymodule]
mod _core {
    #[pymodule_export]
    use crate::arrays::address;
    #[pymodule_export]
    use crate::cloud::read_points;
    #[pymodule_export]
    use crate::command::{command, version};
    #[pymodule_export]
    use crate::features::{Features, features};
    #[pymodule_export]
    use crate::mesh::{load_mesh, mesh_self_intersections, mesh_topology, save_mesh, simplify_mesh};
    #[pymodule_export]
    use crate::newe::newe;
    #[pymodule_export]
    use crate::normalized::{NormalizedFit, normalized_fit};
    #[pymodule_export]
    use crate::reconstruct::{fit, reconstruct};
    #[pymodule_export]
    use crate::sample::{sample, sample_kinds};
    #[pymodule_export]
    use crate::solid::Solid;
    #[pymodule_export]
    use crate::tiles::TileFolder;
}
