//! A blocking bus where an asynchronous one is asked for.

use embedded_hal::spi::SpiBus;
use embedded_hal_async::spi::{ErrorType, SpiBus as Async};

/// Wraps a bus that waits for its own transfers: every future is ready at the first poll.
#[derive(Debug)]
pub struct Blocking<B>(pub B);

impl<B: ErrorType> ErrorType for Blocking<B> {
    type Error = B::Error;
}

impl<B: SpiBus> Async for Blocking<B> {
    async fn read(&mut self, bytes: &mut [u8]) -> Result<(), B::Error> {
        self.0.read(bytes)
    }

    async fn write(&mut self, bytes: &[u8]) -> Result<(), B::Error> {
        self.0.write(bytes)
    }

    async fn transfer(&mut self, read: &mut [u8], write: &[u8]) -> Result<(), B::Error> {
        self.0.transfer(read, write)
    }

    async fn transfer_in_place(&mut self, bytes: &mut [u8]) -> Result<(), B::Error> {
        self.0.transfer_in_place(bytes)
    }

    async fn flush(&mut self) -> Result<(), B::Error> {
        self.0.flush()
    }
}
