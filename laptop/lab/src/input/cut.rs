//! Reads a truncated table up to its last complete line.

use std::cell::Cell;
use std::io::{self, Read};
use std::rc::Rc;

/// A reader of the complete lines of an input. The last line is left out if it has no line end. If the input cannot be
/// read or decompressed to its end, the reader stops after the last complete line before the error.
pub(super) struct WholeLines<R> {
    input: R,
    /// The bytes read. The bytes from `at` to `whole` belong to complete lines and are not passed on yet.
    held: Vec<u8>,
    at: usize,
    whole: usize,
    is_read: bool,
    cut: Rc<Cell<Option<String>>>,
}

impl<R: Read> WholeLines<R> {
    /// Makes a reader of the complete lines of `input`. If the reader leaves out bytes at the end, it puts a note about
    /// these bytes into `cut`.
    pub(super) fn new(input: R, cut: Rc<Cell<Option<String>>>) -> Self {
        Self { input, held: Vec::new(), at: 0, whole: 0, is_read: false, cut }
    }

    /// Reads until a line is complete, or to the end of the input.
    fn fill(&mut self) {
        const MORE: usize = 1 << 16;
        self.held.drain(..self.at);
        (self.at, self.whole) = (0, 0);
        while self.whole == 0 && !self.is_read {
            let start = self.held.len();
            self.held.resize(start + MORE, 0);
            let read = match self.input.read(&mut self.held[start..]) {
                Ok(read) => read,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {
                    self.held.truncate(start);
                    continue;
                }
                Err(error) => {
                    self.cut
                        .set(Some(format!("nothing is read behind the last whole line: {error}")));
                    0
                }
            };
            self.held.truncate(start + read);
            self.is_read = read == 0;
            let end = self.held[start..].iter().rposition(|byte| *byte == b'\n');
            self.whole = end.map_or(0, |end| start + end + 1);
        }
        if self.is_read && self.held.len() > self.whole {
            let left = self.held.len() - self.whole;
            let note = format!("the last line has no end; its {left} bytes are left out");
            let before = self.cut.take();
            self.cut.set(Some(before.unwrap_or(note)));
        }
    }
}

impl<R: Read> Read for WholeLines<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        if self.at == self.whole {
            self.fill();
        }
        let read = (&self.held[self.at..self.whole]).read(bytes)?;
        self.at += read;
        Ok(read)
    }
}
