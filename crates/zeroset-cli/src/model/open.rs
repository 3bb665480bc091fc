//! Solids as they are named on the command line.

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use zeroset::model::{Provenance, Solid};
use zeroset_io::{IoError, MeshFormat, SolidFiles, is_model, read_model, solid::TREE_SUFFIX};

use crate::error::CliError;

/// Reads what is named, and remembers what was told of it.
pub(super) struct Opener {
    files: SolidFiles<'static>,
    seen: Rc<RefCell<Seen>>,
    /// What was named, without folders.
    inputs: Vec<String>,
}

/// What models tell of themselves.
#[derive(Debug, Default)]
struct Seen {
    crs: Option<String>,
    inputs: Vec<String>,
}

/// A solid, with what is told of it.
pub(crate) struct Opened {
    pub(crate) solid: Solid,
    /// The reference system of the first model that has one.
    pub(super) crs: Option<String>,
    /// What it is made of.
    pub(super) inputs: Vec<String>,
}

impl Opener {
    pub(super) fn new() -> Self {
        let seen = Rc::new(RefCell::new(Seen::default()));
        let own = Rc::clone(&seen);
        let models = move |path: &Path| -> Result<Solid, IoError> {
            let model = read_model(path)?;
            let mut seen = own.borrow_mut();
            seen.crs = seen.crs.take().or(model.crs);
            seen.inputs.extend(model.provenance.inputs);
            Ok(model.solid)
        };
        Self { files: SolidFiles::new(models), seen, inputs: Vec::new() }
    }

    /// Reads a file, if a name has the suffix of one, else an expression.
    pub(super) fn read(&mut self, text: &str) -> Result<Solid, CliError> {
        let path = file(text);
        self.inputs.push(path.as_deref().map_or_else(|| text.to_owned(), own_name));
        Ok(match &path {
            Some(path) => self.files.read(path),
            None => self.files.expression(text),
        }?)
    }

    /// What was told of all that was read.
    pub(super) fn finish(self, solid: Solid) -> Opened {
        let Seen { crs, inputs } = self.seen.take();
        Opened { solid, crs, inputs: self.inputs.into_iter().chain(inputs).collect() }
    }
}

/// Reads one solid.
pub(crate) fn open(text: &str) -> Result<Opened, CliError> {
    let mut opener = Opener::new();
    let solid = opener.read(text)?;
    Ok(opener.finish(solid))
}

/// The file that a text names; `None` for expressions.
fn file(text: &str) -> Option<PathBuf> {
    let path = Path::new(text);
    let is_tree = path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case(TREE_SUFFIX));
    (is_model(path) || is_tree || MeshFormat::from_path(path).is_ok()).then(|| path.to_path_buf())
}

/// The name of a file without folders.
pub(super) fn own_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// The files among texts, which no output may replace.
pub(super) fn files<'a>(texts: impl IntoIterator<Item = &'a str>) -> Vec<PathBuf> {
    texts.into_iter().filter_map(file).filter(|path| path.exists()).collect()
}

/// Where something made of solids is from.
pub(super) fn provenance(inputs: Vec<String>, parameters: Vec<(String, String)>) -> Provenance {
    Provenance { version: env!("CARGO_PKG_VERSION").to_owned(), inputs, parameters }
}
