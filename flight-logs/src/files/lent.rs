//! Files that a web page provides by name, in place of a file system.

use std::cell::RefCell;
use std::collections::HashMap;
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Bytes with random access, such as a browser's `File`.
pub trait Bytes {
    /// Returns the length in bytes.
    fn len(&self) -> u64;

    /// Returns whether the length is 0.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Reads bytes from `offset` on; returns the number of bytes read, which is 0 only at the end.
    ///
    /// # Errors
    /// Returns an error if the bytes cannot be read.
    fn read_at(&self, offset: u64, into: &mut [u8]) -> io::Result<usize>;
}

thread_local! {
    static LENT: RefCell<HashMap<PathBuf, Rc<dyn Bytes>>> = RefCell::default();
}

/// Provides a file under a name. Replaces a file that was provided earlier under the same name.
pub fn lend(name: impl Into<PathBuf>, bytes: impl Bytes + 'static) {
    LENT.with_borrow_mut(|lent| lent.insert(name.into(), Rc::new(bytes)));
}

/// Withdraws all files provided by [`lend`]. Files that are already open stay readable.
pub fn take_back() {
    LENT.take();
}

/// Returns false, because a web page cannot provide directories.
pub fn is_dir(_: &Path) -> bool {
    false
}

/// Returns whether the web page has provided a file under this name.
pub fn is_file(path: &Path) -> bool {
    LENT.with_borrow(|lent| lent.contains_key(path))
}

/// An open file, either provided by the web page or created by [`scratch`].
pub struct File {
    content: Content,
    offset: u64,
}

enum Content {
    Lent(Rc<dyn Bytes>),
    Scratch(Vec<u8>),
}

impl File {
    /// Opens a file that the web page has provided under the name `path`.
    ///
    /// # Errors
    /// Returns an error if no file has been provided under this name.
    pub fn open(path: &Path) -> io::Result<Self> {
        let found = LENT.with_borrow(|lent| lent.get(path).cloned());
        let content = found.ok_or(ErrorKind::NotFound)?;
        Ok(Self { content: Content::Lent(content), offset: 0 })
    }

    fn len(&self) -> u64 {
        match &self.content {
            Content::Lent(bytes) => bytes.len(),
            Content::Scratch(bytes) => bytes.len() as u64,
        }
    }
}

/// Creates an empty file in memory, for decompressed bytes.
///
/// # Errors
/// Never returns an error; the result has the same type as outside of browsers.
pub fn scratch() -> io::Result<File> {
    Ok(File { content: Content::Scratch(Vec::new()), offset: 0 })
}

impl Read for File {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let read = match &self.content {
            Content::Lent(bytes) => bytes.read_at(self.offset, into)?,
            Content::Scratch(bytes) => {
                bytes.get(self.offset as usize..).unwrap_or(&[]).read(into)?
            }
        };
        self.offset += read as u64;
        Ok(read)
    }
}

/// Appends to a file created by [`scratch`]. Files that the web page has provided cannot be written.
impl Write for File {
    fn write(&mut self, from: &[u8]) -> io::Result<usize> {
        let Content::Scratch(bytes) = &mut self.content else {
            return Err(ErrorKind::ReadOnlyFilesystem.into());
        };
        bytes.extend(from);
        self.offset = bytes.len() as u64;
        Ok(from.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for File {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let offset = match to {
            SeekFrom::Start(offset) => Some(offset),
            SeekFrom::End(off) => self.len().checked_add_signed(off),
            SeekFrom::Current(off) => self.offset.checked_add_signed(off),
        };
        self.offset = offset.ok_or(ErrorKind::InvalidInput)?;
        Ok(self.offset)
    }
}
