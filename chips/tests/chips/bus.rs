//! An SPI bus on which a test lets one chosen transaction fail. (The mocks of `embedded-hal-mock` always succeed.)

use embedded_hal::spi::{ErrorKind, ErrorType, Operation, SpiDevice};

/// An SPI device that passes transactions on to another device, except for one transaction, which fails before any byte
/// is sent.
#[derive(Debug)]
pub(crate) struct Failing<D> {
    /// The device to which transactions are passed.
    pub(crate) device: D,
    /// Number of transactions that succeed before the one that fails.
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
