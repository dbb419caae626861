//! Files that appear whole or not at all.

use anyhow::{Context, Result, bail};
use same_file::Handle;
use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Standard output, or a file that is written beside its place and then moved there.
pub struct Output {
    place: Place,
    bytes: u64,
}

enum Place {
    /// Standard output, or a device.
    Direct(BufWriter<Box<dyn Write>>),
    /// A file in the making.
    Beside(BufWriter<NamedTempFile>, PathBuf),
}

const BUFFER: usize = 1 << 18;

impl Output {
    /// Opens the output; without a path it is standard output. A link is followed.
    ///
    /// # Errors
    /// Nothing can be written there, or it is the input.
    pub fn open(path: Option<&Path>, input: &Path) -> Result<Self> {
        if let Some(path) = path.filter(|path| is_same(path, input)) {
            bail!("{}: the input itself; it would be lost", path.display());
        }
        Self::to(path)
    }

    /// Opens the output where there is no input.
    ///
    /// # Errors
    /// Nothing can be written there.
    pub fn to(path: Option<&Path>) -> Result<Self> {
        let Some(path) = path.filter(|path| *path != Path::new("-")) else {
            return Ok(Self::direct(Box::new(io::stdout().lock())));
        };
        let name = path.display();
        // Nothing is moved onto a device.
        if fs::metadata(path).is_ok_and(|data| !data.is_file()) {
            let device =
                File::create(path).with_context(|| format!("{name}: cannot be written"))?;
            return Ok(Self::direct(Box::new(device)));
        }
        let path =
            &target(path.to_owned()).with_context(|| format!("{name}: cannot be written"))?;
        let directory = path.parent().filter(|parent| !parent.as_os_str().is_empty());
        let file = named(directory.unwrap_or(Path::new(".")))
            .with_context(|| format!("{name}: cannot be written"))?;
        let file = BufWriter::with_capacity(BUFFER, file);
        Ok(Self { place: Place::Beside(file, path.to_owned()), bytes: 0 })
    }

    fn direct(output: Box<dyn Write>) -> Self {
        Self { place: Place::Direct(BufWriter::with_capacity(BUFFER, output)), bytes: 0 }
    }

    /// How many bytes were written.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Writes again what stands at a place of the file.
    ///
    /// # Errors
    /// It cannot be written, or it went to standard output or a device.
    pub fn overwrite(&mut self, place: u64, bytes: &[u8]) -> Result<()> {
        let Place::Beside(output, _) = &mut self.place else {
            bail!("its start is written last, so it goes to a file only");
        };
        output.seek(SeekFrom::Start(place))?;
        output.write_all(bytes)?;
        output.seek(SeekFrom::End(0))?;
        Ok(())
    }

    /// Writes what is left and puts the file in its place.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn finish(self) -> Result<()> {
        match self.place {
            Place::Direct(mut output) => output.flush()?,
            Place::Beside(output, path) => {
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
        let written = match &mut self.place {
            Place::Direct(output) => output.write(bytes),
            Place::Beside(output, _) => output.write(bytes),
        }?;
        self.bytes += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.place {
            Place::Direct(output) => output.flush(),
            Place::Beside(output, _) => output.flush(),
        }
    }
}

/// Whether both are one file, also by links and as standard input.
fn is_same(output: &Path, input: &Path) -> bool {
    if !fs::metadata(output).is_ok_and(|data| data.is_file()) {
        return false;
    }
    let input = if input == Path::new("-") { Handle::stdin() } else { Handle::from_path(input) };
    matches!((Handle::from_path(output), input), (Ok(output), Ok(input)) if output == input)
}

/// Where links lead, even if there is nothing yet.
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
