//! Reads captured bytes from a serial port, a file or standard input.

use crate::error::room;
use crate::{Error, Result};
use catalogue::kinds;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;
use std::time::Duration;

kinds! {
    /// The reason for which a port cannot be read.
    pub enum PortKind by spell of subject {
        NotOpened { baud: u32, error: serialport::Error } => ("cannot be opened at {baud} baud: {error}"),
        NeedsBaud => ("a device; {} says how fast it is", spell("baud")),
        Gone => ("the port is gone"),
    }
}
room!(PortKind, Port);

/// A source of bytes that arrive over time.
pub struct Port {
    bytes: Box<dyn Read>,
    name: String,
    is_file: bool,
}

/// The outcome of [`Port::read`].
pub enum Bytes {
    /// The given number of bytes were read.
    Some(usize),
    /// No bytes have arrived yet.
    NotYet,
    /// The source has ended.
    End,
}

impl Port {
    /// Opens a serial port at `baud` baud, or a file if `baud` is `None`. The path `-` stands for standard input.
    ///
    /// # Errors
    /// Returns an error if the source cannot be opened.
    pub fn open(path: &Path, baud: Option<u32>) -> Result<Self> {
        /// Longest time that a read waits, short enough to keep a display up to date.
        const PATIENCE: Duration = Duration::from_millis(100);
        let name = path.display().to_string();
        if let Some(baud) = baud {
            let port = serialport::new(&name, baud).timeout(PATIENCE).open();
            let port = port.map_err(|error| PortKind::NotOpened { baud, error }.at(&name))?;
            return Ok(Self { bytes: Box::new(port), name, is_file: false });
        }
        if path == Path::new("-") {
            let bytes = Box::new(io::stdin().lock());
            return Ok(Self { bytes, name: "standard input".to_owned(), is_file: false });
        }
        let cannot = |error| Error::open(&name, error);
        if is_device(&fs::metadata(path).map_err(cannot)?) {
            return Err(PortKind::NeedsBaud.at(name));
        }
        let bytes = Box::new(File::open(path).map_err(cannot)?);
        Ok(Self { bytes, name, is_file: true })
    }

    /// Returns the source's name, for errors.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns whether the source is a file, whose bytes are all available from the start.
    pub fn is_file(&self) -> bool {
        self.is_file
    }

    /// Reads into `buffer` the bytes that have arrived. On a serial port, waits for bytes for at most 100 ms.
    ///
    /// # Errors
    /// Returns an error if the port failed or was disconnected.
    pub fn read(&mut self, buffer: &mut [u8]) -> Result<Bytes> {
        use io::ErrorKind::{BrokenPipe, Interrupted, TimedOut, WouldBlock};
        match self.bytes.read(buffer) {
            Ok(0) => Ok(Bytes::End),
            Ok(count) => Ok(Bytes::Some(count)),
            Err(error) if matches!(error.kind(), Interrupted | TimedOut | WouldBlock) => {
                Ok(Bytes::NotYet)
            }
            // The error of a broken pipe would be taken for an output that nobody reads any more.
            Err(error) if error.kind() == BrokenPipe => Err(PortKind::Gone.at(&self.name)),
            Err(error) => Err(Error::from(error).at(&self.name)),
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
