//! The errors of all chip drivers.

use core::convert::Infallible;
use core::fmt;

use super::Phase;
use super::family::AerError;

/// The reason that a call on a chip failed. `B` is the error type of the bus through which the driver accesses the
/// chip. `P` is the error type of the port, which drives the chip's other pins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum ChipError<B, P = Infallible> {
    /// The SPI bus or the register access failed, with this error.
    Bus(B),
    /// The port, which drives the chip's other pins, failed with this error.
    Port(P),
    /// The chip did not answer in this phase of a handshake. The phase shows whether the chip has taken the word.
    Handshake(Phase),
    /// The chip did not finish its time step while the driver waited.
    Unfinished,
    /// Chip and bus may be out of sync: reset the chip first.
    NotReset,
    /// The chip runs, but the call needs a gated chip: memories can be accessed only while the chip's activity is
    /// gated.
    NotGated,
    /// The chip's activity is gated, so the chip takes no events.
    Gated,
    /// The driver let the chip run, but the chip failed the check that it runs: reset the chip first.
    /// [`ReckOn::sample`](super::ReckOn::sample) also returns this error, for a chip between two samples; such a chip
    /// needs no reset.
    NotStarted,
    /// The driver found no neuron that is fit for the check that the chip runs. The check is a time step of one neuron.
    /// The driver first moves the neuron's potential away from 0 by the leak, so that the time step moves the potential
    /// back. A neuron is unfit if it learns, if it has reached its threshold, or if its potential would leave its
    /// range. The chip is still gated, and nothing was changed.
    NoProbe,
    /// The chip keeps sending outputs and does not come to rest. It must be at rest before it is gated; see
    /// [`open_loop`](super::Running::open_loop). [`ReckOn::started`](super::ReckOn::started) returns this error if the
    /// chip is within a sample.
    Busy,
    /// The chip was started with other registers than those of the network that was loaded, or that network is recurrent.
    /// Time steps in which neurons compare once need the registers of a network whose loop is open.
    OtherNetwork,
    /// An output of `ReckOn` has reached the end of its range, so that its value is wrong. The time step is complete, and
    /// chip and driver are in sync.
    Clipped {
        /// Number of the output.
        output: u8,
    },
    /// The weights from one input or neuron have both signs, which this chip cannot store.
    MixedSigns {
        /// Number of the row of synapses that would store the weights. A row belongs to a presynaptic neuron or to an
        /// input.
        pre: u8,
    },
    /// A value is out of its range.
    OutOfRange {
        /// The name of the value that is out of its range.
        what: &'static str,
        /// The value that the caller gave.
        value: i64,
        /// Smallest value allowed.
        min: i64,
        /// Largest value allowed.
        max: i64,
    },
    /// The weight of a virtual event is 0. The chip would take such an event for a spike on a whole row of synapses.
    ZeroWeight,
    /// Memory reads back a different value than was written. On a chip without a reset line, write the value again. On
    /// a chip with a reset line, all memory is in doubt: reset the chip, and write all of its memory again.
    ReadBack {
        /// Address at which the values differ.
        address: u32,
        /// The value written.
        written: u32,
        /// The value read.
        read: u32,
    },
}

impl<B: fmt::Debug, P: fmt::Debug> fmt::Display for ChipError<B, P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bus(error) => write!(f, "the bus failed: {error:?}"),
            Self::Port(error) => write!(f, "the port failed: {error:?}"),
            Self::Handshake(phase) => write!(f, "no answer in a handshake: {phase:?}"),
            Self::Unfinished => write!(f, "the time step did not finish"),
            Self::NotReset => write!(f, "the chip must be reset first"),
            Self::NotGated => write!(f, "the chip's activity must be gated first"),
            Self::Gated => write!(f, "the chip's activity is gated"),
            Self::NotStarted => write!(f, "the chip did not answer after its gate was opened"),
            Self::NoProbe => write!(f, "no neuron can show that the chip starts"),
            Self::Busy => write!(f, "the chip's outputs do not end"),
            Self::OtherNetwork => write!(f, "the chip's registers are not those of the network"),
            Self::Clipped { output } => write!(f, "output {output} reached the end of its range"),
            Self::MixedSigns { pre } => write!(f, "weights from {pre} have both signs"),
            Self::OutOfRange { what, value, min, max } => {
                write!(f, "{what} {value} must lie in {min}..={max}")
            }
            Self::ZeroWeight => write!(f, "a virtual event of weight 0 acts as a full spike"),
            Self::ReadBack { address, written, read } => {
                write!(f, "wrote {written:#x} to {address:#x}, read back {read:#x}")
            }
        }
    }
}

impl<B: fmt::Debug, P: fmt::Debug> core::error::Error for ChipError<B, P> {}

impl<B, P> From<AerError<P>> for ChipError<B, P> {
    fn from(error: AerError<P>) -> Self {
        match error {
            AerError::Port(error) => Self::Port(error),
            AerError::Timeout(phase) => Self::Handshake(phase),
        }
    }
}

/// Returns an error unless `value` lies within `0..=max`.
pub(super) fn at_most<B, P>(
    what: &'static str,
    value: u32,
    max: u32,
) -> Result<(), ChipError<B, P>> {
    in_range(what, value.into(), 0, max.into())
}

/// Returns an error unless `value` lies within `min..=max`.
pub(super) fn in_range<B, P>(
    what: &'static str,
    value: i64,
    min: i64,
    max: i64,
) -> Result<(), ChipError<B, P>> {
    if (min..=max).contains(&value) {
        Ok(())
    } else {
        Err(ChipError::OutOfRange { what, value, min, max })
    }
}
