//! Writes files under a temporary name in the same directory, and renames them once they are complete.

use same_file::Handle;
use std::fs;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::NamedTempFile;

/// Start of the names of unfinished files.
pub(crate) const UNFINISHED_NAME: &str = ".spikewire-";

/// Paths of unfinished files, which are to be deleted if the program is ended early.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Deletes all unfinished files. This function is for a program that is interrupted: the program must exit right after
/// the call. A thread that starts or finishes a file after the call waits forever. No file thus appears after the
/// deletion.
pub fn abandon() {
    let files = unfinished();
    for file in files.iter() {
        // The file may already have its final name, or its directory may be gone.
        let _ = fs::remove_file(file);
    }
    std::mem::forget(files);
}

/// A file that is being written under a temporary name.
pub(super) struct Beside {
    file: Option<BufWriter<NamedTempFile>>,
    path: PathBuf,
}

impl Beside {
    /// Starts a file that will replace `path` or, if `path` is a link, the link's target.
    ///
    /// # Errors
    /// Returns an error if no file can be created in the directory of `path`.
    pub(super) fn new(path: &Path) -> io::Result<Self> {
        let path = target(path.to_owned())?;
        let directory = path.parent().filter(|parent| !parent.as_os_str().is_empty());
        // While the list is locked, no file exists that is not in the list.
        let mut files = unfinished();
        let file = named(directory.unwrap_or(Path::new(".")))?;
        files.push(file.path().to_owned());
        Ok(Self { file: Some(BufWriter::with_capacity(super::BUFFER, file)), path })
    }

    fn file(&mut self) -> io::Result<&mut BufWriter<NamedTempFile>> {
        self.file.as_mut().ok_or_else(|| io::Error::other("it is finished"))
    }

    /// Overwrites bytes at the offset `place` of the file. Later writes still append to the end of the file.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub(super) fn overwrite(&mut self, place: u64, bytes: &[u8]) -> io::Result<()> {
        let file = self.file()?;
        file.seek(SeekFrom::Start(place))?;
        file.write_all(bytes)?;
        file.seek(SeekFrom::End(0))?;
        Ok(())
    }

    /// Writes buffered bytes, and renames the file from its temporary name to its final one.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub(super) fn finish(mut self) -> io::Result<()> {
        let Some(file) = self.file.take() else { return Ok(()) };
        let temporary = file.get_ref().path().to_owned();
        let file = file.into_inner().map_err(io::IntoInnerError::into_error);
        let mut files = unfinished();
        files.retain(|own| *own != temporary);
        file?.persist(&self.path)?;
        Ok(())
    }
}

impl Drop for Beside {
    /// Deletes the file unless it was finished.
    fn drop(&mut self) {
        let Some(file) = self.file.take() else { return };
        let path = file.get_ref().path().to_owned();
        let mut files = unfinished();
        // The rest of the buffer need not be written.
        let (file, _) = file.into_parts();
        drop(file);
        files.retain(|own| *own != path);
    }
}

impl Write for Beside {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file()?.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file()?.flush()
    }
}

/// Returns whether both paths lead to the same file, directly or through links. If `input` is `-`, compares `output`
/// with the file that is connected to standard input.
pub(super) fn is_same(output: &Path, input: &Path) -> bool {
    if !fs::metadata(output).is_ok_and(|data| data.is_file()) {
        return false;
    }
    let input = if input == Path::new("-") { Handle::stdin() } else { Handle::from_path(input) };
    matches!((Handle::from_path(output), input), (Ok(output), Ok(input)) if output == input)
}

/// Follows symbolic links to the last target, even if no file exists there yet.
fn target(mut path: PathBuf) -> io::Result<PathBuf> {
    /// Maximum number of symbolic links to follow. A longer chain of links is assumed to lead in a circle.
    const MOST: usize = 40;
    for _ in 0..MOST {
        if !fs::symlink_metadata(&path).is_ok_and(|data| data.is_symlink()) {
            return Ok(path);
        }
        let link = fs::read_link(&path)?;
        path = path.parent().unwrap_or(Path::new("")).join(link);
    }
    Err(io::Error::other("links that lead in a circle"))
}

/// Creates a temporary file in a directory, with the permissions of an ordinary new file.
fn named(directory: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(UNFINISHED_NAME);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(directory)
}
