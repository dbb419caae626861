//! Ports that implement `embedded-io` 0.6.

use embedded_io::{Error, ErrorKind, ErrorType, Write, WriteReady};

/// An adapter from a port of `embedded-io` 0.6 to version 0.7, which [`SerialSink`](super::SerialSink) takes.
///
/// Some HALs, such as stm32f4xx-hal 0.23, implement the older version.
///
/// ```
/// use embedded_io_06::{ErrorKind, ErrorType, Write};
/// use spikewire::{Event, FromEvents, Polarity, Tick, out::{Io06, SerialSink}};
/// use spikewire::link::{Coding, Session, Transmitter};
///
/// /// As a HAL has it.
/// struct Uart(u32);
///
/// impl ErrorType for Uart {
///     type Error = ErrorKind;
/// }
///
/// impl Write for Uart {
///     fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
///         self.0 += bytes.len() as u32;
///         Ok(bytes.len())
///     }
///
///     fn flush(&mut self) -> Result<(), ErrorKind> {
///         Ok(())
///     }
/// }
///
/// let link = Transmitter::new(Coding::for_channels(6, 1_000), Session::counted(1));
/// let mut sink = SerialSink::<_, _, 512>::new(Io06(Uart(0)), link);
/// let event = Event { tick: Tick::from_micros(0), address: 5, polarity: Polarity::Up };
/// let sent = sink.send(FromEvents([event].into_iter())).expect("a port that takes all");
/// let Io06(uart) = sink.release();
/// assert_eq!(uart.0 as usize, sent);
/// ```
#[derive(Debug)]
pub struct Io06<W>(pub W);

/// An error of a port of `embedded-io` 0.6.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Io06Error<E>(pub E);

impl<E: core::fmt::Debug> core::fmt::Display for Io06Error<E> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{:?}", self.0)
    }
}

impl<E: core::fmt::Debug> core::error::Error for Io06Error<E> {}

impl<E: embedded_io_06::Error> Error for Io06Error<E> {
    fn kind(&self) -> ErrorKind {
        use embedded_io_06::ErrorKind as Old;
        match self.0.kind() {
            Old::TimedOut => ErrorKind::TimedOut,
            Old::Interrupted => ErrorKind::Interrupted,
            Old::BrokenPipe => ErrorKind::BrokenPipe,
            Old::WriteZero => ErrorKind::WriteZero,
            Old::NotConnected => ErrorKind::NotConnected,
            Old::InvalidInput => ErrorKind::InvalidInput,
            _ => ErrorKind::Other,
        }
    }
}

impl<W: embedded_io_06::ErrorType> ErrorType for Io06<W> {
    type Error = Io06Error<W::Error>;
}

impl<W: embedded_io_06::Write> Write for Io06<W> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Self::Error> {
        self.0.write(bytes).map_err(Io06Error)
    }

    fn flush(&mut self) -> Result<(), Self::Error> {
        self.0.flush().map_err(Io06Error)
    }
}

impl<W: embedded_io_06::WriteReady> WriteReady for Io06<W> {
    fn write_ready(&mut self) -> Result<bool, Self::Error> {
        self.0.write_ready().map_err(Io06Error)
    }
}
