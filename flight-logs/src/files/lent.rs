//! Files that a web page lends to the library, by name.

use std::cell::RefCell;
use std::collections::HashMap;
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Bytes that can be read from any place on, such as a browser's `File`.
pub trait Bytes {
    /// Returns the number of bytes.
    fn len(&self) -> u64;

    /// Returns whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Reads from a place on and returns how many bytes were read, which is 0 at the end only.
    ///
    /// # Errors
    /// Returns an error if the bytes cannot be read.
    fn read_at(&self, place: u64, into: &mut [u8]) -> io::Result<usize>;
}

thread_local! {
    static LENT: RefCell<HashMap<PathBuf, Rc<dyn Bytes>>> = RefCell::default();
}

/// Lends a file under a name, in the place of another one of that name.
pub fn lend(name: impl Into<PathBuf>, bytes: impl Bytes + 'static) {
    LENT.with_borrow_mut(|lent| lent.insert(name.into(), Rc::new(bytes)));
}

/// Takes all files back; those that are open stay readable.
pub fn take_back() {
    LENT.take();
}

/// Returns whether there is a directory of this name; pages lend none.
pub fn is_dir(_: &Path) -> bool {
    false
}

/// Returns whether a file of this name was lent.
pub fn is_file(path: &Path) -> bool {
    LENT.with_borrow(|lent| lent.contains_key(path))
}

/// An open file.
pub struct File {
    content: Content,
    place: u64,
}

enum Content {
    Lent(Rc<dyn Bytes>),
    Scratch(Vec<u8>),
}

impl File {
    /// Opens a file that was lent.
    ///
    /// # Errors
    /// Returns an error if no file of this name was lent.
    pub fn open(path: &Path) -> io::Result<Self> {
        let found = LENT.with_borrow(|lent| lent.get(path).cloned());
        let content = found.ok_or(ErrorKind::NotFound)?;
        Ok(Self { content: Content::Lent(content), place: 0 })
    }

    fn len(&self) -> u64 {
        match &self.content {
            Content::Lent(bytes) => bytes.len(),
            Content::Scratch(bytes) => bytes.len() as u64,
        }
    }
}

/// Opens a file in memory to unpack into.
///
/// # Errors
/// None: there is memory, or the program ends.
pub fn scratch() -> io::Result<File> {
    Ok(File { content: Content::Scratch(Vec::new()), place: 0 })
}

impl Read for File {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let read = match &self.content {
            Content::Lent(bytes) => bytes.read_at(self.place, into)?,
            Content::Scratch(bytes) => {
                bytes.get(self.place as usize..).unwrap_or(&[]).read(into)?
            }
        };
        self.place += read as u64;
        Ok(read)
    }
}

/// Appends to a scratch file; a lent one cannot be written.
impl Write for File {
    fn write(&mut self, from: &[u8]) -> io::Result<usize> {
        let Content::Scratch(bytes) = &mut self.content else {
            return Err(ErrorKind::ReadOnlyFilesystem.into());
        };
        bytes.extend(from);
        self.place = bytes.len() as u64;
        Ok(from.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for File {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let place = match to {
            SeekFrom::Start(place) => Some(place),
            SeekFrom::End(off) => self.len().checked_add_signed(off),
            SeekFrom::Current(off) => self.place.checked_add_signed(off),
        };
        self.place = place.ok_or(ErrorKind::InvalidInput)?;
        Ok(self.place)
    }
}
