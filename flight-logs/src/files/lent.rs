//! Files that a web page provides to the library under a name.

use std::cell::RefCell;
use std::collections::HashMap;
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Bytes with random access, such as a browser's `File`.
pub trait Bytes {
    /// Returns the number of bytes.
    fn len(&self) -> u64;

    /// Returns whether there are no bytes.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Reads from offset `place` on; returns the number of bytes read, which is 0 only at the end.
    ///
    /// # Errors
    /// Returns an error if the bytes cannot be read.
    fn read_at(&self, place: u64, into: &mut [u8]) -> io::Result<usize>;
}

thread_local! {
    static LENT: RefCell<HashMap<PathBuf, Rc<dyn Bytes>>> = RefCell::default();
}

/// Provides a file under a name; it replaces another file of that name.
pub fn lend(name: impl Into<PathBuf>, bytes: impl Bytes + 'static) {
    LENT.with_borrow_mut(|lent| lent.insert(name.into(), Rc::new(bytes)));
}

/// Withdraws all files; those that are open stay readable.
pub fn take_back() {
    LENT.take();
}

/// Returns whether there is a directory of this name. It is always false: a page provides files only.
pub fn is_dir(_: &Path) -> bool {
    false
}

/// Returns whether a file was provided under this name.
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
    /// Opens a file that was provided.
    ///
    /// # Errors
    /// Returns an error if there is no file of this name.
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

/// Creates a file in memory, for decompressed bytes.
///
/// # Errors
/// Never returns an error; if memory runs out the program ends.
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

/// Appends to a file in memory; a provided file cannot be written.
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
