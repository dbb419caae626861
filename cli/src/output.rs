//! Files that appear whole or not at all.

use anyhow::{Context, Result};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Standard output, or a file that is written beside its place and then moved there.
pub(crate) enum Output {
    /// Standard output, or a device.
    Direct(BufWriter<Box<dyn Write>>),
    /// A file in the making.
    Beside(BufWriter<NamedTempFile>, PathBuf),
}

const BUFFER: usize = 1 << 18;

impl Output {
    /// Opens the output; without a path it is standard output.
    ///
    /// # Errors
    /// Nothing can be written there.
    pub(crate) fn open(path: Option<&Path>) -> Result<Self> {
        let Some(path) = path.filter(|path| *path != Path::new("-")) else {
            return Ok(Self::Direct(BufWriter::with_capacity(
                BUFFER,
                Box::new(io::stdout().lock()),
            )));
        };
        let name = path.display();
        // Nothing is moved onto a device.
        if fs::metadata(path).is_ok_and(|data| !data.is_file()) {
            let device =
                File::create(path).with_context(|| format!("{name}: cannot be written"))?;
            return Ok(Self::Direct(BufWriter::with_capacity(BUFFER, Box::new(device))));
        }
        let directory = path.parent().filter(|parent| !parent.as_os_str().is_empty());
        let file = named(directory.unwrap_or(Path::new(".")))
            .with_context(|| format!("{name}: cannot be written"))?;
        Ok(Self::Beside(BufWriter::with_capacity(BUFFER, file), path.to_owned()))
    }

    /// Writes what is left and puts the file in its place.
    ///
    /// # Errors
    /// It cannot be written.
    pub(crate) fn finish(self) -> Result<()> {
        match self {
            Self::Direct(mut output) => output.flush()?,
            Self::Beside(output, path) => {
                let name = path.display();
                let file = output.into_inner().map_err(io::IntoInnerError::into_error)?;
                file.persist(&path).with_context(|| format!("{name}: cannot be written"))?;
            }
        }
        Ok(())
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Direct(output) => output.write(bytes),
            Self::Beside(output, _) => output.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Direct(output) => output.flush(),
            Self::Beside(output, _) => output.flush(),
        }
    }
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
