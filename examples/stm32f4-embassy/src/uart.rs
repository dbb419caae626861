//! Frames out of a UART, by DMA.

use embassy_stm32::{
    mode::Async,
    usart::{Error, UartTx},
};
use spikewire::{
    Source,
    link::{MAX_FRAME, Transmitter},
};

pub struct UartLink {
    port: UartTx<'static, Async>,
    transmitter: Transmitter,
    frame: [u8; MAX_FRAME],
    /// How many bytes of a frame wait to be sent.
    waiting: usize,
}

impl UartLink {
    pub fn new(port: UartTx<'static, Async>, transmitter: Transmitter) -> Self {
        Self { port, transmitter, frame: [0; MAX_FRAME], waiting: 0 }
    }

    /// Sends a frame, and returns how many bytes it had; 0 if there were no items. A frame that was not sent to its
    /// end is sent again.
    pub async fn send(&mut self, items: impl Source) -> Result<usize, Error> {
        if self.waiting == 0 {
            // The buffer has room for any frame.
            let frame = self.transmitter.next_frame(items, &mut self.frame).ok().flatten();
            self.waiting = frame.map_or(0, |frame| frame.len());
        }
        self.port.write(&self.frame[..self.waiting]).await?;
        Ok(core::mem::take(&mut self.waiting))
    }
}
