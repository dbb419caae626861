//! Files that appear whole or not at all, standard output, and memory.

#[cfg(not(target_family = "wasm"))]
mod beside;
mod kinds;

#[cfg(not(target_family = "wasm"))]
pub use beside::abandon;
pub use kinds::OutputKind;

use crate::Result;
#[cfg(not(target_family = "wasm"))]
use std::io::BufWriter;
use std::io::{self, Write};
use std::path::Path;

/// Standard output, a file that is written beside its place and then moved there, or memory.
pub struct Output {
    /// The name in errors.
    name: String,
    place: Place,
    bytes: u64,
}

enum Place {
    /// Standard output, or a device.
    #[cfg(not(target_family = "wasm"))]
    Direct(BufWriter<Box<dyn Write>>),
    /// A file in the making.
    #[cfg(not(target_family = "wasm"))]
    Beside(beside::Beside),
    /// For [`into_bytes`](Output::into_bytes).
    Memory(Vec<u8>),
}

/// Refuses to write a table into a file whose name ends as that of another kind, whose programs could not read it. The
/// endings of `others` are named beside those of tables. A device has any name.
///
/// # Errors
/// The name does not end as that of a table.
pub fn is_table(path: &Path, others: &str) -> Result<()> {
    let Some(ending) = path.extension() else { return Ok(()) };
    let is_device = path.metadata().is_ok_and(|data| !data.is_file());
    if is_device || ["csv", "txt"].iter().any(|own| ending.eq_ignore_ascii_case(own)) {
        return Ok(());
    }
    let (ending, others) = (ending.display().to_string(), others.to_owned());
    Err(OutputKind::Ending { ending, others }.at(path))
}

#[cfg(not(target_family = "wasm"))]
const BUFFER: usize = 1 << 18;

impl Output {
    /// Writes into memory.
    pub fn memory() -> Self {
        Self { name: "memory".to_owned(), place: Place::Memory(Vec::new()), bytes: 0 }
    }

    /// Opens the output; without a path it is standard output. A link is followed.
    ///
    /// # Errors
    /// Nothing can be written there, or it is the input.
    #[cfg(not(target_family = "wasm"))]
    pub fn open(path: Option<&Path>, input: &Path) -> Result<Self> {
        if let Some(path) = path.filter(|path| beside::is_same(path, input)) {
            return Err(OutputKind::IsInput.at(path));
        }
        Self::to(path)
    }

    /// Opens the output where there is no input.
    ///
    /// # Errors
    /// Nothing can be written there.
    #[cfg(not(target_family = "wasm"))]
    pub fn to(path: Option<&Path>) -> Result<Self> {
        use std::fs::{File, metadata};

        let direct = |output| Place::Direct(BufWriter::with_capacity(BUFFER, output));
        let Some(path) = path.filter(|path| *path != Path::new("-")) else {
            let name = "standard output".to_owned();
            return Ok(Self { name, place: direct(Box::new(io::stdout().lock())), bytes: 0 });
        };
        let name = path.display().to_string();
        // Nothing is moved onto a device.
        let place = if metadata(path).is_ok_and(|data| !data.is_file()) {
            File::create(path).map(|device| direct(Box::new(device)))
        } else {
            beside::Beside::new(path).map(Place::Beside)
        };
        Ok(Self { place: place.map_err(|error| unwritten(&name, &error))?, name, bytes: 0 })
    }

    /// Refuses: a browser has no files to write.
    ///
    /// # Errors
    /// Always.
    #[cfg(target_family = "wasm")]
    pub fn open(path: Option<&Path>, _: &Path) -> Result<Self> {
        Self::to(path)
    }

    /// Refuses: a browser has no files to write.
    ///
    /// # Errors
    /// Always.
    #[cfg(target_family = "wasm")]
    pub fn to(path: Option<&Path>) -> Result<Self> {
        Err(OutputKind::NoFiles.at(path.unwrap_or(Path::new("-"))))
    }

    /// How many bytes were written.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Returns what was written into memory; empty if it went elsewhere.
    pub fn into_bytes(self) -> Vec<u8> {
        match self.place {
            Place::Memory(bytes) => bytes,
            #[cfg(not(target_family = "wasm"))]
            _ => Vec::new(),
        }
    }

    /// Writes again what stands at a place of the file.
    ///
    /// # Errors
    /// Returns an error if the output cannot be written, or went to standard output or a device.
    pub fn overwrite(&mut self, place: u64, bytes: &[u8]) -> Result<()> {
        match &mut self.place {
            #[cfg(not(target_family = "wasm"))]
            Place::Beside(file) => {
                file.overwrite(place, bytes).map_err(|error| unwritten(&self.name, &error))?;
            }
            Place::Memory(all) => {
                let own = usize::try_from(place).ok().and_then(|place| all.get_mut(place..));
                match own.and_then(|own| own.get_mut(..bytes.len())) {
                    Some(own) => own.copy_from_slice(bytes),
                    None => return Err(OutputKind::NothingThere.into()),
                }
            }
            #[cfg(not(target_family = "wasm"))]
            Place::Direct(_) => return Err(OutputKind::StartIsLast.into()),
        }
        Ok(())
    }

    /// Writes what is left and puts the file in its place.
    ///
    /// # Errors
    /// Returns an error if the output cannot be written.
    pub fn finish(self) -> Result<()> {
        let done = match self.place {
            #[cfg(not(target_family = "wasm"))]
            Place::Direct(mut output) => output.flush(),
            #[cfg(not(target_family = "wasm"))]
            Place::Beside(file) => file.finish(),
            Place::Memory(_) => Ok(()),
        };
        Ok(done.map_err(|error| unwritten(&self.name, &error))?)
    }
}

/// The error of a file that cannot be written, of the same kind, with its name.
fn unwritten(name: &str, error: &io::Error) -> io::Error {
    io::Error::new(error.kind(), format!("{name}: cannot be written: {error}"))
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = match &mut self.place {
            #[cfg(not(target_family = "wasm"))]
            Place::Direct(output) => output.write(bytes),
            #[cfg(not(target_family = "wasm"))]
            Place::Beside(file) => file.write(bytes),
            Place::Memory(all) => all.write(bytes),
        };
        let written = written.map_err(|error| unwritten(&self.name, &error))?;
        self.bytes += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        let flushed = match &mut self.place {
            #[cfg(not(target_family = "wasm"))]
            Place::Direct(output) => output.flush(),
            #[cfg(not(target_family = "wasm"))]
            Place::Beside(file) => file.flush(),
            Place::Memory(_) => Ok(()),
        };
        flushed.map_err(|error| unwritten(&self.name, &error))
    }
}
