//! Outputs: files, standard output, and memory. A file appears once it is complete, or not at all.

#[cfg(not(target_family = "wasm"))]
mod beside;
mod kinds;

#[cfg(all(feature = "datasets", not(target_family = "wasm")))]
pub(crate) use beside::UNFINISHED_NAME;
#[cfg(not(target_family = "wasm"))]
pub use beside::abandon;
pub use kinds::OutputKind;

use crate::Result;
#[cfg(not(target_family = "wasm"))]
use std::io::BufWriter;
use std::io::{self, Write};
use std::path::Path;

/// A place to which output is written: standard output, a device, a file or memory. A file gets its final name once it
/// is complete.
pub struct Output {
    /// Name of the output in errors.
    name: String,
    place: Place,
    bytes: u64,
}

enum Place {
    /// Standard output, or a device.
    #[cfg(not(target_family = "wasm"))]
    Direct(BufWriter<Box<dyn Write>>),
    /// A file that is not complete yet.
    #[cfg(not(target_family = "wasm"))]
    Beside(beside::Beside),
    /// Memory, returned by [`into_bytes`](Output::into_bytes).
    Memory(Vec<u8>),
}

/// Checks that a table's name ends in `.csv` or `.txt`, or has no ending, so that other programs recognise the table. A
/// device may have any name. The error lists the allowed endings, followed by the text `others`.
///
/// # Errors
/// Returns an error if the path has a different ending.
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
    /// Opens an output in memory.
    pub fn memory() -> Self {
        Self { name: "memory".to_owned(), place: Place::Memory(Vec::new()), bytes: 0 }
    }

    /// Opens the output at `path`, or standard output if `path` is `None` or `-`. Symbolic links are followed.
    ///
    /// # Errors
    /// Returns an error if no file can be written at `path`, or if `path` and `input` are the same file.
    #[cfg(not(target_family = "wasm"))]
    pub fn open(path: Option<&Path>, input: &Path) -> Result<Self> {
        if let Some(path) = path.filter(|path| beside::is_same(path, input)) {
            return Err(OutputKind::IsInput.at(path));
        }
        Self::to(path)
    }

    /// Opens the output at `path`, or standard output if `path` is `None` or `-`. This function is for commands without
    /// an input file. It cannot check that the output is a different file from the input.
    ///
    /// # Errors
    /// Returns an error if no file can be written at `path`.
    #[cfg(not(target_family = "wasm"))]
    pub fn to(path: Option<&Path>) -> Result<Self> {
        use std::fs::{File, metadata};

        let direct = |output| Place::Direct(BufWriter::with_capacity(BUFFER, output));
        let Some(path) = path.filter(|path| *path != Path::new("-")) else {
            let name = "standard output".to_owned();
            return Ok(Self { name, place: direct(Box::new(io::stdout().lock())), bytes: 0 });
        };
        let name = path.display().to_string();
        // A device is written directly: a file that takes its name would replace it.
        let place = if metadata(path).is_ok_and(|data| !data.is_file()) {
            File::create(path).map(|device| direct(Box::new(device)))
        } else {
            beside::Beside::new(path).map(Place::Beside)
        };
        Ok(Self { place: place.map_err(|error| unwritten(&name, &error))?, name, bytes: 0 })
    }

    /// Always fails: a browser has no files to write.
    ///
    /// # Errors
    /// Always returns an error.
    #[cfg(target_family = "wasm")]
    pub fn open(path: Option<&Path>, _: &Path) -> Result<Self> {
        Self::to(path)
    }

    /// Always fails: a browser has no files to write.
    ///
    /// # Errors
    /// Always returns an error.
    #[cfg(target_family = "wasm")]
    pub fn to(path: Option<&Path>) -> Result<Self> {
        Err(OutputKind::NoFiles.at(path.unwrap_or(Path::new("-"))))
    }

    /// Returns the number of bytes written so far.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Returns the bytes written to memory, or an empty vector for other outputs.
    pub fn into_bytes(self) -> Vec<u8> {
        match self.place {
            Place::Memory(bytes) => bytes,
            #[cfg(not(target_family = "wasm"))]
            _ => Vec::new(),
        }
    }

    /// Overwrites bytes at the offset `place` of the output.
    ///
    /// # Errors
    /// Returns an error if the output cannot be written, or if it is standard output or a device.
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

    /// Writes buffered bytes. A file is then renamed from its temporary name to its final name.
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

/// Adds the file's name to an error that occurred while the file was written. Keeps the error's kind.
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
