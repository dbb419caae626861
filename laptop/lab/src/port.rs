//! Sources of captured bytes: a serial port, a file, standard input.

use anyhow::{Context, Result, bail};
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;
use std::time::Duration;

/// A source of bytes that may have none just now.
pub struct Port {
    bytes: Box<dyn Read>,
    name: String,
    is_file: bool,
}

/// The result of reading from a port.
pub enum Bytes {
    /// This many bytes.
    Some(usize),
    /// No bytes yet.
    NotYet,
    /// The end of the bytes.
    End,
}

impl Port {
    /// A serial port if there is a baud rate, else a file, or `-` for standard input.
    ///
    /// # Errors
    /// Returns an error if the port cannot be opened.
    pub fn open(path: &Path, baud: Option<u32>) -> Result<Self> {
        /// How long a read waits: the display goes on meanwhile.
        const PATIENCE: Duration = Duration::from_millis(100);
        let name = path.display().to_string();
        if let Some(baud) = baud {
            let port = serialport::new(&name, baud).timeout(PATIENCE).open();
            let port = port.with_context(|| format!("{name}: cannot be opened at {baud} baud"))?;
            return Ok(Self { bytes: Box::new(port), name, is_file: false });
        }
        if path == Path::new("-") {
            let bytes = Box::new(io::stdin().lock());
            return Ok(Self { bytes, name: "standard input".to_owned(), is_file: false });
        }
        let cannot = || format!("{name}: cannot be opened");
        if is_device(&fs::metadata(path).with_context(cannot)?) {
            bail!("{name}: a device; `baud` says how fast it is");
        }
        let bytes = Box::new(File::open(path).with_context(cannot)?);
        Ok(Self { bytes, name, is_file: true })
    }

    /// The source's name, for errors.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether all bytes are there already.
    pub fn is_file(&self) -> bool {
        self.is_file
    }

    /// Reads what there is.
    ///
    /// # Errors
    /// The port failed, or is gone.
    pub fn read(&mut self, buffer: &mut [u8]) -> Result<Bytes> {
        use io::ErrorKind::{BrokenPipe, Interrupted, TimedOut, WouldBlock};
        match self.bytes.read(buffer) {
            Ok(0) => Ok(Bytes::End),
            Ok(count) => Ok(Bytes::Some(count)),
            Err(error) if matches!(error.kind(), Interrupted | TimedOut | WouldBlock) => {
                Ok(Bytes::NotYet)
            }
            // Told as text: a broken pipe itself would pass for a reader who has read enough.
            Err(error) if error.kind() == BrokenPipe => bail!("{}: the port is gone", self.name),
            Err(error) => bail!("{}: {error}", self.name),
        }
    }
}

#[cfg(unix)]
fn is_device(data: &fs::Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    data.file_type().is_char_device()
}

#[cfg(not(unix))]
fn is_device(_: &fs::Metadata) -> bool {
    false
}
