//! Reads a file from start to end, decompressed if necessary, and parses little-endian integers.

use crate::files::File;
use crate::packed::Packing;
use crate::zstd::Frames;
use crate::{Error, ErrorKind, Result};
use std::io::{self, BufReader, Cursor, Read};
use std::path::Path;

/// Content of a file, decompressed if the whole file is compressed.
pub(crate) struct Bytes {
    input: Box<dyn Read>,
    at: u64,
}

impl Bytes {
    /// Opens a file, and recognises its compression by the first bytes.
    ///
    /// # Errors
    /// Returns an error if the file cannot be opened, or its start cannot be read.
    pub(crate) fn open(path: &Path) -> Result<Self> {
        let input =
            unpacked(open(path)?).map_err(|error| Error::of(path, ErrorKind::Read(error)))?;
        Ok(Self { input, at: 0 })
    }

    /// Writes the rest of the content to `output`; returns the number of bytes.
    ///
    /// # Errors
    /// Returns an error if the bytes cannot be decompressed or written.
    pub(crate) fn copy(mut self, output: &mut File) -> io::Result<u64> {
        io::copy(&mut self.input, output)
    }

    /// Returns the number of bytes of content read so far.
    pub(crate) fn at(&self) -> u64 {
        self.at
    }

    /// Replaces the content of `bytes` by the next `count` bytes of the file's content. Returns false if fewer than
    /// `count` bytes are left. Memory is allocated only for bytes that have been read, so a huge `count` from a damaged
    /// file does no harm.
    ///
    /// # Errors
    /// Returns an error if the bytes cannot be read or decompressed.
    pub(crate) fn take(&mut self, count: u64, bytes: &mut Vec<u8>) -> io::Result<bool> {
        bytes.clear();
        let taken = self.input.by_ref().take(count).read_to_end(bytes)?;
        self.at += taken as u64;
        Ok(taken as u64 == count)
    }

    /// Skips bytes of 0, up to the next other byte.
    ///
    /// # Errors
    /// Returns an error if the bytes cannot be read or decompressed.
    pub(crate) fn pass_zeros(&mut self) -> io::Result<()> {
        let mut next = [0];
        while self.input.read(&mut next)? > 0 {
            if next != [0] {
                let rest = std::mem::replace(&mut self.input, Box::new(io::empty()));
                self.input = Box::new(Cursor::new(next).chain(rest));
                break;
            }
            self.at += 1;
        }
        Ok(())
    }

    /// Skips `count` bytes; returns false if fewer bytes are left in the file.
    ///
    /// # Errors
    /// Returns an error if the bytes cannot be read or decompressed.
    pub(crate) fn pass(&mut self, count: u64) -> io::Result<bool> {
        let passed = io::copy(&mut self.input.by_ref().take(count), &mut io::sink())?;
        self.at += passed;
        Ok(passed == count)
    }
}

/// Opens a file without decompressing it.
///
/// # Errors
/// Returns an error if the file cannot be opened.
pub(crate) fn open(path: &Path) -> Result<File> {
    File::open(path).map_err(|error| Error::of(path, ErrorKind::Open(error)))
}

/// Returns whether the file as a whole is compressed, by a method that [`Packing::of`] recognises.
///
/// # Errors
/// Returns an error if the file cannot be opened or read.
pub(crate) fn is_packed(path: &Path) -> Result<bool> {
    let mut start = Vec::new();
    let read = open(path)?.take(Packing::START as u64).read_to_end(&mut start);
    read.map_err(|error| Error::of(path, ErrorKind::Read(error)))?;
    Ok(Packing::of(&start).is_some())
}

/// Returns a reader of the file's content. Decompresses the content if [`Packing::of`] recognises a compression.
fn unpacked(file: File) -> io::Result<Box<dyn Read>> {
    const BUFFER: usize = 1 << 18;
    let mut head = Vec::new();
    let mut input = BufReader::with_capacity(BUFFER, file);
    input.by_ref().take(Packing::START as u64).read_to_end(&mut head)?;
    let packing = Packing::of(&head);
    let all = Cursor::new(head).chain(input);
    Ok(match packing {
        Some(packing) => packing.reader(all),
        None => Box::new(all),
    })
}

/// Decompresses `packed`, whose decompressed size should be `size` bytes. `how` is the name of the compression. Returns
/// the bytes that could be decompressed. Also returns a description of the fault if the bytes are damaged, if too few
/// or too many are decompressed, or if the compression is unknown.
pub(crate) fn unpack(how: &str, packed: &[u8], size: u64) -> (Vec<u8>, Option<String>) {
    let mut bytes = Vec::new();
    let mut limited =
        |input: &mut dyn Read| input.take(size.saturating_add(1)).read_to_end(&mut bytes);
    let read = match how {
        "" | "none" => limited(&mut &*packed),
        "lz4" => limited(&mut lz4_flex::frame::FrameDecoder::new(packed)),
        "bz2" => limited(&mut bzip2::read::BzDecoder::new(packed)),
        "zstd" => limited(&mut Frames::new(packed)),
        _ => {
            let what =
                format!("compression `{how}` is not known; there are none, lz4, bz2 and zstd");
            return (Vec::new(), Some(what));
        }
    };
    let unpacked = bytes.len() as u64;
    let fault = match read {
        Err(error) => Some(format!("{how} cannot be unpacked: {error}")),
        Ok(_) if unpacked < size => Some(format!("a chunk of {size} bytes unpacks to {unpacked}")),
        Ok(_) if unpacked > size => Some(format!("a chunk of {size} bytes unpacks to more")),
        Ok(_) => None,
    };
    (bytes, fault)
}

/// Removes a little-endian `u16` from the front of `bytes`; returns `None` if fewer bytes are left.
pub(crate) fn u16_from(bytes: &mut &[u8]) -> Option<u16> {
    let (first, rest) = bytes.split_first_chunk()?;
    *bytes = rest;
    Some(u16::from_le_bytes(*first))
}

/// Removes a little-endian `u32` from the front of `bytes`; returns `None` if fewer bytes are left.
pub(crate) fn u32_from(bytes: &mut &[u8]) -> Option<u32> {
    let (first, rest) = bytes.split_first_chunk()?;
    *bytes = rest;
    Some(u32::from_le_bytes(*first))
}

/// Removes a little-endian `u64` from the front of `bytes`; returns `None` if fewer bytes are left.
pub(crate) fn u64_from(bytes: &mut &[u8]) -> Option<u64> {
    let (first, rest) = bytes.split_first_chunk()?;
    *bytes = rest;
    Some(u64::from_le_bytes(*first))
}

/// Removes `count` bytes from the front of `bytes`; returns `None` if fewer bytes are left.
pub(crate) fn take<'a>(bytes: &mut &'a [u8], count: u64) -> Option<&'a [u8]> {
    let (first, rest) = bytes.split_at_checked(usize::try_from(count).ok()?)?;
    *bytes = rest;
    Some(first)
}
