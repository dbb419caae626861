//! Files that are written beside their place and then moved there.

use anyhow::{Context, Result};
use same_file::Handle;
use std::fs;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file in the making.
pub(super) struct Beside {
    file: BufWriter<NamedTempFile>,
    path: PathBuf,
}

impl Beside {
    /// Starts a file; a link is followed.
    ///
    /// # Errors
    /// Nothing can be written there.
    pub(super) fn new(path: &Path) -> Result<Self> {
        let name = path.display();
        let path = target(path.to_owned()).with_context(|| format!("{name}: cannot be written"))?;
        let directory = path.parent().filter(|parent| !parent.as_os_str().is_empty());
        let file = named(directory.unwrap_or(Path::new(".")))
            .with_context(|| format!("{name}: cannot be written"))?;
        Ok(Self { file: BufWriter::with_capacity(super::BUFFER, file), path })
    }

    /// Writes again what stands at a place of the file.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub(super) fn overwrite(&mut self, place: u64, bytes: &[u8]) -> io::Result<()> {
        self.file.seek(SeekFrom::Start(place))?;
        self.file.write_all(bytes)?;
        self.file.seek(SeekFrom::End(0))?;
        Ok(())
    }

    /// Writes what is left and puts the file in its place.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub(super) fn finish(self) -> Result<()> {
        let name = self.path.display();
        let file = self.file.into_inner().map_err(io::IntoInnerError::into_error)?;
        file.persist(&self.path).with_context(|| format!("{name}: cannot be written"))?;
        Ok(())
    }
}

impl Write for Beside {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// Whether both are one file, also by links and as standard input.
pub(super) fn is_same(output: &Path, input: &Path) -> bool {
    if !fs::metadata(output).is_ok_and(|data| data.is_file()) {
        return false;
    }
    let input = if input == Path::new("-") { Handle::stdin() } else { Handle::from_path(input) };
    matches!((Handle::from_path(output), input), (Ok(output), Ok(input)) if output == input)
}

/// Follows symbolic links, even if the last leads to no file yet.
fn target(mut path: PathBuf) -> io::Result<PathBuf> {
    /// More are a circle.
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

/// A file with the permissions that a new file has, not those of a secret.
fn named(directory: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".spikewire-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(directory)
}
