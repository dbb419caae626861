//! Writes files beside their place, and moves them there once they are complete.

use same_file::Handle;
use std::fs;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::NamedTempFile;

/// Start of the names of unfinished files.
pub(crate) const UNFINISHED_NAME: &str = ".spikewire-";

/// Paths of unfinished files, which a program that is ended must delete.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Deletes all unfinished files. The program must end at once: from now on no file can be started or finished, so that
/// none appears after this.
pub fn abandon() {
    let files = unfinished();
    for file in files.iter() {
        // It may be in its place by now, or its directory gone.
        let _ = fs::remove_file(file);
    }
    std::mem::forget(files);
}

/// An unfinished file.
pub(super) struct Beside {
    file: Option<BufWriter<NamedTempFile>>,
    path: PathBuf,
}

impl Beside {
    /// Starts a file that will replace `path`; if that is a link, its target.
    ///
    /// # Errors
    /// Returns an error if nothing can be written there.
    pub(super) fn new(path: &Path) -> io::Result<Self> {
        let path = target(path.to_owned())?;
        let directory = path.parent().filter(|parent| !parent.as_os_str().is_empty());
        // Nobody may end the program between the two.
        let mut files = unfinished();
        let file = named(directory.unwrap_or(Path::new(".")))?;
        files.push(file.path().to_owned());
        Ok(Self { file: Some(BufWriter::with_capacity(super::BUFFER, file)), path })
    }

    fn file(&mut self) -> io::Result<&mut BufWriter<NamedTempFile>> {
        self.file.as_mut().ok_or_else(|| io::Error::other("it is finished"))
    }

    /// Overwrites bytes at an offset of the file.
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

    /// Writes buffered bytes, and moves the file to its place.
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
        // What is left in the buffer is not wanted.
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

/// Returns whether both are the same file, also through links or as standard input.
pub(super) fn is_same(output: &Path, input: &Path) -> bool {
    if !fs::metadata(output).is_ok_and(|data| data.is_file()) {
        return false;
    }
    let input = if input == Path::new("-") { Handle::stdin() } else { Handle::from_path(input) };
    matches!((Handle::from_path(output), input), (Ok(output), Ok(input)) if output == input)
}

/// Follows symbolic links, even if the last leads to a file that does not exist yet.
fn target(mut path: PathBuf) -> io::Result<PathBuf> {
    /// Maximum number of links; more of them are taken to be a circle.
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

/// Creates a file with the permissions of an ordinary new file, rather than those of a temporary one.
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
