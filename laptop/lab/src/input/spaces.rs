//! Reads tables whose columns are aligned by blanks.

use std::io::{self, Read};

/// A reader that replaces each run of blanks and tabs by one blank, and removes blanks and tabs at the start and end of
/// each line.
pub(super) struct OneBlank<R> {
    input: R,
    /// Whether the latest bytes were blanks or tabs after a field. These bytes become one blank if another field
    /// follows in the line; otherwise they are removed.
    is_waiting: bool,
    is_begun: bool,
    held: Vec<u8>,
    at: usize,
}

impl<R: Read> OneBlank<R> {
    pub(super) fn new(input: R) -> Self {
        Self { input, is_waiting: false, is_begun: false, held: Vec::new(), at: 0 }
    }

    fn take(&mut self, byte: u8) {
        match byte {
            b' ' | b'\t' => self.is_waiting = self.is_begun,
            b'\r' | b'\n' => {
                (self.is_waiting, self.is_begun) = (false, false);
                self.held.push(byte);
            }
            _ => {
                if self.is_waiting {
                    self.held.push(b' ');
                }
                (self.is_waiting, self.is_begun) = (false, true);
                self.held.push(byte);
            }
        }
    }
}

impl<R: Read> Read for OneBlank<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let mut own = [0; 1 << 14];
        while self.at == self.held.len() {
            let read = self.input.read(&mut own)?;
            if read == 0 {
                return Ok(0);
            }
            self.held.clear();
            self.at = 0;
            own[..read].iter().for_each(|byte| self.take(*byte));
        }
        let read = (&self.held[self.at..]).read(bytes)?;
        self.at += read;
        Ok(read)
    }
}
