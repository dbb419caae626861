//! Sources of captured bytes: a serial port, a file, standard input.

use crate::error::room;
use crate::{Error, Result};
use catalogue::kinds;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;
use std::time::Duration;

kinds! {
    /// The reason that a port cannot be read.
    pub enum PortKind by spell of subject {
        NotOpened { baud: u32, error: serialport::Error } => ("cannot be opened at {baud} baud: {error}"),
        NeedsBaud => ("a device; {} says how fast it is", spell("baud")),
        Gone => ("the port is gone"),
    }
}
room!(PortKind, Port);

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
            // A broken pipe itself would pass for a reader who has read enough.
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
