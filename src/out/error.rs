//! Errors of the sinks.

use core::fmt;

/// Why a sink did not send all its bytes. It keeps what was not sent, and sends that first the next time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum SinkError<E> {
    /// The bus failed.
    Bus(E),
    /// The ready pin could not be read.
    Pin,
    /// The receiver is not ready.
    Busy,
    /// The port is closed: it takes no more bytes.
    Closed,
}

impl<E: fmt::Debug> fmt::Display for SinkError<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bus(error) => write!(f, "the bus failed: {error:?}"),
            Self::Pin => write!(f, "the ready pin could not be read"),
            Self::Busy => write!(f, "the receiver is not ready"),
            Self::Closed => write!(f, "the receiver takes no more bytes"),
        }
    }
}

impl<E: fmt::Debug> core::error::Error for SinkError<E> {}
