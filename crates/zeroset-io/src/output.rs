//! Bytes out: all or nothing.

use std::fs::{Metadata, Permissions};
use std::io::{BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use crate::IoError;

/// What writers of formats need: some go back to fill in a header.
pub(crate) trait Sink: Write + Seek + Send + Sync {}
impl<T: Write + Seek + Send + Sync> Sink for T {}

/// Size of the buffer before a file.
const BUFFER: usize = 1 << 18;

/// Temporary files of writes that are under way.
static UNDER_WAY: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Removes the temporary files of all writes that are under way in this process.
///
/// For a command that is about to exit because the user interrupted it: no destructor runs then. Writes that go on
/// nevertheless fail at their end and leave the old file as it was.
pub fn abandon_writes() {
    for path in UNDER_WAY.lock().unwrap_or_else(PoisonError::into_inner).drain(..) {
        // It may have got its final name just now, which is as good.
        let _ = std::fs::remove_file(path);
    }
}

/// Keeps a temporary file on the list for as long as the value lives.
struct UnderWay(PathBuf);

impl UnderWay {
    fn enter(path: &Path) -> Self {
        UNDER_WAY.lock().unwrap_or_else(PoisonError::into_inner).push(path.to_path_buf());
        Self(path.to_path_buf())
    }
}

impl Drop for UnderWay {
    fn drop(&mut self) {
        UNDER_WAY.lock().unwrap_or_else(PoisonError::into_inner).retain(|path| *path != self.0);
    }
}

/// Writes a file so that it is there completely or not at all.
///
/// `fill` writes to a temporary file in the same folder, which takes the name `path` at the end. If `fill` fails, or
/// the disk, the old file stays as it was and nothing else is left behind. The new file has the permissions of the one
/// that it replaces, or those that the process gives to any new file. A symbolic link is followed: the file that it
/// points to is replaced, the link stays. Devices and pipes are written to directly. Returns the bytes written.
///
/// # Errors
/// The folder is missing, access is denied, the disk is full, or whatever `fill` returns.
pub fn write_atomically<E>(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<std::fs::File>) -> Result<(), E>,
) -> Result<u64, E>
where
    E: From<IoError>,
{
    let failed = |source| E::from(IoError::from_system(path, source));
    let Place { target, old, folder } = Place::of(path)?;
    if old.as_ref().is_some_and(|old| !old.is_file()) {
        let file = std::fs::OpenOptions::new().write(true).open(&target).map_err(failed)?;
        let mut writer = BufWriter::with_capacity(BUFFER, file);
        fill(&mut writer)?;
        writer.flush().map_err(failed)?;
        return Ok(0);
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".zeroset-").suffix(".tmp");
    // The crate's own choice is a file that only its owner can read; asking for 0666 leaves the decision to the umask.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let file = builder.tempfile_in(&folder).map_err(failed)?;
    if let Some(old) = &old {
        let wanted: Permissions = old.permissions();
        file.as_file().set_permissions(wanted).map_err(failed)?;
    }
    let (file, temporary) = file.into_parts();
    let _under_way = UnderWay::enter(&temporary);
    let mut writer = BufWriter::with_capacity(BUFFER, file);
    fill(&mut writer)?;
    let file = writer.into_inner().map_err(|e| failed(e.into_error()))?;
    // Some file systems report a full disk only when the data goes out.
    file.sync_data().map_err(failed)?;
    let bytes = file.metadata().map_err(failed)?.len();
    drop(file);
    temporary.persist(&target).map_err(|e| failed(e.error))?;
    Ok(bytes)
}

/// Where a file is to be written.
struct Place {
    /// The file, with links followed.
    target: PathBuf,
    /// What is there now.
    old: Option<Metadata>,
    /// The folder that holds it.
    folder: PathBuf,
}

impl Place {
    /// Finds out what can be known before anything is written.
    fn of(path: &Path) -> Result<Self, IoError> {
        if path.is_dir() {
            return Err(IoError::IsDirectory { path: path.to_path_buf() });
        }
        let target = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
        let old = std::fs::metadata(&target).ok();
        // Renaming needs no right to write to the file itself, but a file that its owner protected is not to be
        // replaced.
        if old.as_ref().is_some_and(|old| old.is_file() && old.permissions().readonly()) {
            return Err(IoError::PermissionDenied { path: path.to_path_buf() });
        }
        let folder = folder_of(&target);
        if !folder.is_dir() {
            return Err(IoError::FolderMissing { path: path.to_path_buf(), folder });
        }
        Ok(Self { target, old, folder })
    }
}

/// Whether [`write_atomically`] can be expected to succeed, for a command that works for long before it writes.
///
/// The old file stays as it is and no new one appears: a nameless file is made in the folder and given up at once.
///
/// # Errors
/// The folder is missing or may not be written to, the path is a folder, or the file is protected.
pub fn check_writable(path: &Path) -> Result<(), IoError> {
    let failed = |source| IoError::from_system(path, source);
    let Place { target, old, folder } = Place::of(path)?;
    if old.is_some_and(|old| !old.is_file()) {
        std::fs::OpenOptions::new().write(true).open(target).map_err(failed)?;
    } else {
        tempfile::tempfile_in(folder).map_err(failed)?;
    }
    Ok(())
}

/// Like [`write_atomically`] with errors of the system put into their place, for the formats of this crate.
pub(crate) fn write_file(path: &Path, fill: impl FnOnce(&mut dyn Sink) -> std::io::Result<()>) -> Result<u64, IoError> {
    write_atomically(path, |writer| fill(writer).map_err(|source| IoError::from_system(path, source)))
}

fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if parent != Path::new("") => parent.to_path_buf(),
        _ => PathBuf::from("."),
    }
}
