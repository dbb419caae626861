//! Files that are compressed as a whole: by gzip, Zstandard, bzip2 or xz.

use crate::zstd::{Frames, ZSTD};
use bzip2::read::MultiBzDecoder;
use flate2::read::MultiGzDecoder;
use std::io::{BufReader, Read};

/// Compression of a whole file. Packers that use several cores write a file as several streams; all streams are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Packing {
    /// gzip.
    Gzip,
    /// Zstandard.
    Zstd,
    /// bzip2.
    Bzip2,
    /// xz. Not available in a browser.
    #[cfg(not(target_family = "wasm"))]
    Xz,
}

impl Packing {
    /// Number of bytes from the start of a file that [`Packing::of`] needs.
    pub const START: usize = 6;

    /// Recognises the compression by the first bytes of a file; `None` if the file is not compressed.
    pub fn of(start: &[u8]) -> Option<Self> {
        match *start {
            [0x1f, 0x8b, ..] => Some(Self::Gzip),
            [b'B', b'Z', b'h', b'1'..=b'9', 0x31, 0x41, ..] => Some(Self::Bzip2),
            #[cfg(not(target_family = "wasm"))]
            [0xfd, b'7', b'z', b'X', b'Z', 0, ..] => Some(Self::Xz),
            _ => start.starts_with(&ZSTD).then_some(Self::Zstd),
        }
    }

    /// Returns a reader of the decompressed content. `input` must start with the first byte of the file.
    pub fn reader(self, input: impl Read + 'static) -> Box<dyn Read> {
        const BUFFER: usize = 1 << 18;
        fn buffered(input: impl Read + 'static) -> Box<dyn Read> {
            Box::new(BufReader::with_capacity(BUFFER, input))
        }
        match self {
            Self::Gzip => buffered(MultiGzDecoder::new(input)),
            Self::Zstd => buffered(Frames::new(BufReader::new(input))),
            Self::Bzip2 => buffered(MultiBzDecoder::new(input)),
            #[cfg(not(target_family = "wasm"))]
            Self::Xz => {
                /// Most memory that decompression may use, in KiB. A file written by `xz -9` needs about half as much.
                const MOST: u32 = 1 << 17;
                let input = BufReader::new(input);
                buffered(lzma_rust2::XzReader::new_mem_limit(input, true, MOST))
            }
        }
    }
}
