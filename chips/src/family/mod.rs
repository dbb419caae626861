//! The driver that tinyODIN and ODIN share: SPI without chip select, reset, gate, and event buses.

mod aer;
mod bytes;
mod counters;
mod feed;
mod gated;
mod input;
mod load;
mod network;
mod outputs;
mod port;
mod running;
mod step;
mod steps;
mod time;
mod wire;

use core::num::NonZeroU32;

use embedded_hal::delay::DelayNs;
use embedded_hal::spi::{ErrorType, SpiDevice};

use super::ChipError;
use aer::{Aer, Carries};
use spikewire::Event;
use step::Beacon;
use time::Time;
use wire::Wire;

pub(super) use aer::AerError;
pub use aer::Phase;
pub use bytes::{FormatError, NetworkBytes};
pub use counters::Counters;
pub use gated::Gated;
pub use input::Input;
pub use load::Progress;
pub use network::{Describe, Inputs, Network, neurons_from};
pub use outputs::Spikes;
pub use port::AerPort;
pub use running::Running;
pub use steps::{Steps, StepsLayer, StepsState};

/// A chip of the ODIN family, on an SPI device and a port.
///
/// - **SPI:** mode 0, SCK at most a quarter of the chip's clock. The chip has no chip select: it needs
///   a bus of its own and a device whose chip select is not wired.
/// - **States:** [`reset`](Self::reset) gives a [`Gated`] chip, whose memories can be accessed;
///   [`Gated::run`] gives a [`Running`] one, which takes events; [`Running::gate`] gives a gated one again. Each has
///   only the calls that are safe in its state. [`gated`](Self::gated) and [`running`](Self::running) return the chip
///   in its present state later.
/// - **Resynchronisation:** a lost or doubled clock puts chip and bus out of step. Calls on a gated chip detect this; if it
///   happens in the last frame of a call, the next call detects it. They also detect a lost and a doubled clock within one
///   access to memory. (Such a pair within a register's frame and its check goes unseen, as registers cannot be read back.)
///   After an error of the bus, or a byte that reads back differently, all calls are refused until the next reset, and all
///   memory is in doubt: load it again.
/// - **Waits** read the pins a given number of times, then return an error.
/// - **Words** that the chip has not acknowledged by then stay pending. Every call that sends finishes them first,
///   [`Running::poll`] continues with them, and a reset drops them.
/// - **Events** that could not be sent are kept, and sent first at the next call, even after a reset.
/// - **Losses** are all counted; see [`counters`](Self::counters).
///
/// # What to know about the chips
/// - In closed loop a leak overtakes the spikes that wait in the chip's queue; in open loop never.
/// - In open loop with [`OutputSource::Queue`](super::OutputSource::Queue) the outputs are the inputs, not the neurons
///   that fire.
/// - A neuron in use with threshold 0, as in memory that was never written, fires at every event and every leak.
/// - An overflow of the queue is invisible unless [`AerPort::queue_full`] is wired.
#[derive(Debug)]
pub struct OdinChip<I: Input, D, P> {
    wire: Wire<D>,
    aer: Aer<P>,
    state: State,
    /// Registers with which the chip runs.
    registers: Option<I::Registers>,
    /// Byte that the step check writes to, once it is known.
    anchor: Option<u8>,
    beacon: Option<Beacon>,
    held: Option<Event>,
    time: Option<Time>,
    counters: Counters,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Out of step with the bus, or not reset yet.
    NotReset,
    Gated,
    Running,
}

/// The result of a call on a chip.
type Outcome<T, D, P> = Result<T, ChipError<<D as ErrorType>::Error, <P as AerPort>::Error>>;

/// Duration of the reset pulse, and of the pause after it, in µs.
const RESET_US: u32 = 10;

impl<I: Input, D: SpiDevice, P: AerPort> OdinChip<I, D, P> {
    /// Makes a driver for a chip that must be [reset](Self::reset) first. Every wait reads the pins up to `polls`
    /// times.
    ///
    /// [`Input::MAX_CLOCKS`] polls suffice if each takes at least a clock of the chip. If they are faster,
    /// [`with_looks_a_clock`](Self::with_looks_a_clock) multiplies their number. With fewer polls long words time out,
    /// and must be finished later.
    pub const fn new(device: D, port: P, polls: u32) -> Self {
        Self {
            wire: Wire { device },
            aer: Aer::new(port, polls),
            state: State::NotReset,
            registers: None,
            anchor: None,
            beacon: None,
            held: None,
            time: None,
            counters: Counters {
                unmapped_events: 0,
                resets: 0,
                skipped_steps: 0,
                late_events: 0,
                repeated_events: 0,
                dropped_words: 0,
                lost_outputs: 0,
                overflows: 0,
            },
        }
    }

    /// Sets the length of a time step in µs: while the ticks of fed events pass, a leak event is sent every `step` µs.
    /// By default none is sent.
    ///
    /// Call [`Running::advance`] at least every 35 minutes. A tick 2³¹ µs ahead counts as past, and no leak is sent
    /// until time has caught up.
    #[must_use]
    pub fn with_time_step(self, step: NonZeroU32) -> Self {
        Self { time: Some(Time::new(step)), ..self }
    }

    /// Sets how many reads of the pins fit into one clock of the chip; 1 by default, more if the microcontroller is
    /// much faster. Every wait reads the pins this many times as often. If the number is too low, words time out, and
    /// [`Running::gate`] may gate a chip that is still working, which loses its potentials.
    #[must_use]
    pub fn with_looks_a_clock(mut self, looks: NonZeroU32) -> Self {
        self.aer.set_looks_a_clock(looks);
        self
    }

    /// Pulses reset, which brings chip and bus into step; then gates the chip, opens its loop, and checks that it
    /// answers. For this check neuron [`Input::PROBED`] is disabled if it was never written.
    ///
    /// Spikes in the chip's queue are lost, and the pending word is dropped. If that word was an event of
    /// [`Running::feed`] that the chip has not acknowledged, it is kept and sent again.
    ///
    /// # Errors
    /// Returns an error if the port or the bus failed, or if the chip reads back something else than was written.
    pub fn reset(&mut self, delay: &mut impl DelayNs) -> Outcome<Gated<'_, I, D, P>, D, P> {
        self.state = State::NotReset;
        let (under_way, is_output_lost) = self.aer.reset().map_err(ChipError::Port)?;
        self.drop_under_way(under_way, is_output_lost);
        delay.delay_us(RESET_US);
        self.aer.port.set_reset(false).map_err(ChipError::Port)?;
        delay.delay_us(RESET_US);
        self.counters.resets = self.counters.resets.saturating_add(1);
        (self.anchor, self.beacon) = (None, None);
        self.shut()?;
        self.find_beacon()?;
        Ok(Gated::new(self))
    }

    /// Returns the chip, if it is gated.
    ///
    /// # Errors
    /// Returns [`NotReset`](ChipError::NotReset) or [`NotGated`](ChipError::NotGated).
    pub fn gated(&mut self) -> Outcome<Gated<'_, I, D, P>, D, P> {
        match self.state {
            State::NotReset => Err(ChipError::NotReset),
            State::Running => Err(ChipError::NotGated),
            State::Gated => Ok(Gated::new(self)),
        }
    }

    /// Returns the chip, if it runs.
    ///
    /// # Errors
    /// Returns [`NotReset`](ChipError::NotReset) or [`Gated`](ChipError::Gated).
    pub fn running(&mut self) -> Outcome<Running<'_, I, D, P>, D, P> {
        match self.state {
            State::NotReset => Err(ChipError::NotReset),
            State::Gated => Err(ChipError::Gated),
            State::Running => Ok(Running::new(self)),
        }
    }

    /// Returns the counts of losses, skipped time steps and repeated events.
    pub const fn counters(&self) -> Counters {
        Counters { overflows: self.aer.overflows, ..self.counters }
    }

    /// Returns the SPI device and the port.
    pub fn release(self) -> (D, P) {
        (self.wire.device, self.aer.port)
    }

    fn drop_under_way(&mut self, under_way: Option<Carries>, is_output_lost: bool) {
        let counters = &mut self.counters;
        let count = match under_way {
            None | Some(Carries::Probe) => None,
            Some(Carries::Word) => Some(&mut counters.dropped_words),
            Some(Carries::Step) => Some(&mut counters.skipped_steps),
            Some(Carries::Event(event)) => {
                self.held = Some(event);
                Some(&mut counters.repeated_events)
            }
        };
        if let Some(count) = count {
            *count = count.saturating_add(1);
        }
        // Before its first reset the pins of a chip are undefined.
        let is_output_lost = is_output_lost && counters.resets > 0;
        counters.lost_outputs = counters.lost_outputs.saturating_add(is_output_lost.into());
    }
}
