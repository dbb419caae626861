//! A port whose DMA does not reach every memory.

use embedded_io_async::{ErrorType, Write};

/// Copies what is sent to memory that the port's DMA reaches, and sends it from there.
///
/// Frames lie where the compiler puts them. On a part such as the STM32H743, whose DMA does not reach the memory of the
/// statics, a port that is given their bytes fails at the first one.
#[derive(Debug)]
pub struct Bounced<'b, P> {
    port: P,
    bytes: &'b mut [u8],
}

impl<'b, P> Bounced<'b, P> {
    /// A port that sends out of `bytes`; a frame that is longer goes in pieces.
    pub const fn new(port: P, bytes: &'b mut [u8]) -> Self {
        Self { port, bytes }
    }
}

impl<P: ErrorType> ErrorType for Bounced<'_, P> {
    type Error = P::Error;
}

impl<P: Write> Write for Bounced<'_, P> {
    async fn write(&mut self, from: &[u8]) -> Result<usize, P::Error> {
        let length = from.len().min(self.bytes.len());
        let (Some(copy), Some(from)) = (self.bytes.get_mut(..length), from.get(..length)) else {
            return Ok(0);
        };
        copy.copy_from_slice(from);
        self.port.write(copy).await
    }

    async fn flush(&mut self) -> Result<(), P::Error> {
        self.port.flush().await
    }
}
