//! Prints the types of the module `zeroset._core`, as they are in a built library: `stubs LIBRARY`. `cargo xtask python` calls it.

use std::error::Error;

use pyo3_introspection::{introspect_cdylib, module_stub_files};

fn main() -> Result<(), Box<dyn Error>> {
    let library = std::env::args_os().nth(1).ok_or("give the path of the library")?;
    let module = introspect_cdylib(&library, "_core")?;
    let files = module_stub_files(&module);
    let stub = files.values().next().ok_or("the library has no types")?;
    print!("{stub}");
    Ok(())
}
