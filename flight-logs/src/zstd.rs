//! Decompresses Zstandard files, which may consist of several frames.

use ruzstd::decoding::{BlockDecodingStrategy, FrameDecoder};
use std::io::{self, Cursor, ErrorKind, Read};

/// First bytes of a file compressed by Zstandard.
pub(crate) const ZSTD: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// Decompresses all frames of a Zstandard file, one after the other. Packers that use several cores write several
/// frames.
pub(crate) struct Frames<R> {
    input: R,
    decoder: FrameDecoder,
    is_within: bool,
}

impl<R: Read> Frames<R> {
    /// Creates a reader of the decompressed content of `input`.
    pub(crate) fn new(input: R) -> Self {
        Self { input, decoder: FrameDecoder::new(), is_within: false }
    }

    /// Starts decompressing the next frame that has content; returns false at the end of the file.
    fn begin(&mut self) -> io::Result<bool> {
        let mut start = Vec::new();
        while self.input.by_ref().take(4).read_to_end(&mut start)? > 0 {
            let is_empty = matches!(*start, [0x50..=0x5f, 0x2a, 0x4d, 0x18]);
            if !is_empty {
                let frame = Cursor::new(start).chain(&mut self.input);
                self.decoder.init(frame).map_err(io::Error::other)?;
                return Ok(true);
            }
            let mut length = [0; 4];
            self.input.read_exact(&mut length)?;
            let length = u64::from(u32::from_le_bytes(length));
            if io::copy(&mut self.input.by_ref().take(length), &mut io::sink())? < length {
                return Err(ErrorKind::UnexpectedEof.into());
            }
            start.clear();
        }
        Ok(false)
    }

    /// Checks the content of a frame against the frame's checksum, if the frame has one.
    fn check(&self) -> io::Result<()> {
        let calculated = self.decoder.get_calculated_checksum();
        match self.decoder.get_checksum_from_data() {
            Some(checksum) if calculated.is_some_and(|calculated| calculated != checksum) => {
                Err(io::Error::other("zstd's checksum is another: the file is damaged"))
            }
            _ => Ok(()),
        }
    }
}

impl<R: Read> Read for Frames<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        while !bytes.is_empty() {
            if !self.is_within && !self.begin()? {
                return Ok(0);
            }
            self.is_within = true;
            while self.decoder.can_collect() == 0 && !self.decoder.is_finished() {
                let one = BlockDecodingStrategy::UptoBlocks(1);
                self.decoder.decode_blocks(&mut self.input, one).map_err(io::Error::other)?;
            }
            let read = self.decoder.read(bytes)?;
            if read > 0 {
                return Ok(read);
            }
            self.check()?;
            self.is_within = false;
        }
        Ok(0)
    }
}
