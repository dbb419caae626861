//! A bus that fails when told to; the mocks of embedded-hal-mock never do.

use embedded_hal::spi::{ErrorKind, ErrorType, Operation, SpiDevice};

/// Passes transactions on, but for one that fails before a byte is sent.
#[derive(Debug)]
pub(crate) struct Failing<D> {
    /// The bus.
    pub(crate) device: D,
    /// How many transactions go well before one fails.
    pub(crate) left: usize,
}

impl<D: ErrorType> ErrorType for Failing<D> {
    type Error = ErrorKind;
}

impl<D: SpiDevice<Error = ErrorKind>> SpiDevice for Failing<D> {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        match self.left.checked_sub(1) {
            None => {
                self.left = usize::MAX;
                Err(ErrorKind::Other)
            }
            Some(left) => {
                self.left = left;
                self.device.transaction(operations)
            }
        }
    }
}
