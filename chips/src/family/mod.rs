//! The driver for the ODIN family (tinyODIN and ODIN): SPI without chip select, reset, gate, and event buses.

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
mod steps;
mod sync;
mod time;
mod wire;

use core::num::NonZeroU32;

use embedded_hal::delay::DelayNs;
use embedded_hal::spi::{ErrorType, SpiDevice};

use super::ChipError;
use aer::{Aer, Carries};
use load::Loaded;
use spikewire::Event;
use sync::Beacon;
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

/// The driver of a chip of the ODIN family, on an SPI device and a port (the chip's pins other than SPI).
///
/// - **SPI:** mode 0, SCK at most a quarter of the chip's clock. The chip has no chip select. Therefore no other device
///   may share its SPI bus, and the chip-select pin of the SPI device stays unconnected.
/// - **States:** [`reset`](Self::reset) gives a [`Gated`] chip: its activity is stopped, and its memories can be
///   accessed. [`Gated::run`] gives a [`Running`] chip, which takes events; [`Running::gate`] gives a [`Gated`] chip
///   again. Each type has only the calls that are safe in its state. [`gated`](Self::gated) and
///   [`running`](Self::running) give access to a chip that was left in that state.
/// - **Synchronisation:** a lost or doubled clock pulse puts chip and bus out of sync. Calls on a gated chip detect
///   such a fault; if the fault is in the last frame of a call, the next call detects it. If a lost and a doubled pulse
///   cancel out within one access to memory, calls detect this, too. If they cancel out within the frame of a register
///   and its check, this goes unnoticed, because registers cannot be read back. After an error of the bus, or a byte
///   that reads back differently, the driver refuses all calls until the next reset. All memory is then in doubt: load
///   it again.
/// - **Waits:** the driver waits for the chip by reading pins. The argument `polls` of [`new`](Self::new) limits the
///   number of reads; after the last read, the driver returns an error.
/// - **Pending words:** if a wait ends before the chip has acknowledged a word, the word stays pending. Every call that
///   sends a word finishes the pending word first. [`Running::poll`] continues with the pending word; a reset drops it.
/// - **Unsent events:** the driver keeps an event that [`Running::feed`] could not send. The next call of `feed` sends
///   this event first, even after a reset.
/// - **Losses** are counted; see [`counters`](Self::counters).
///
/// # What to know about the chips
/// - In closed loop (the spikes of neurons reach other neurons) a leak overtakes the spikes that wait in the chip's
///   queue. In open loop (the spikes go only to the output bus) a leak overtakes no spike.
/// - In open loop with [`OutputSource::Queue`](super::OutputSource::Queue) the output bus carries the inputs, not the
///   neurons that fire.
/// - A neuron in use whose threshold is 0 fires at every event and every leak. Memory that was never written may hold
///   such neurons.
/// - An overflow of the queue is invisible unless [`AerPort::queue_full`] is wired.
#[derive(Debug)]
pub struct OdinChip<I: Input, D, P> {
    wire: Wire<D>,
    aer: Aer<P>,
    state: State,
    /// Registers that the chip was started with; `None` while the chip is gated.
    registers: Option<I::Registers>,
    /// The network in the chip's memory, as far as is known since the last reset.
    loaded: Loaded<I>,
    /// Value of the byte that the sync check writes to; `None` until the driver has read it.
    anchor: Option<u8>,
    beacon: Option<Beacon>,
    held: Option<Event>,
    time: Option<Time>,
    counters: Counters,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Chip and bus are out of sync, or the chip was not reset yet.
    NotReset,
    Gated,
    Running,
}

/// The result of a call on a chip.
type Outcome<T, D, P> = Result<T, ChipError<<D as ErrorType>::Error, <P as AerPort>::Error>>;

/// Duration of the reset pulse, and of the pause after the pulse, in µs.
const RESET_US: u32 = 10;

impl<I: Input, D: SpiDevice, P: AerPort> OdinChip<I, D, P> {
    /// Makes a driver for a chip that must be [reset](Self::reset) first. Every wait reads the pins up to `polls`
    /// times.
    ///
    /// [`Input::MAX_CLOCKS`] polls suffice if each poll takes at least one clock cycle of the chip. If several polls
    /// fit into one clock cycle, call [`with_reads_per_clock`](Self::with_reads_per_clock), which multiplies the number
    /// of polls. With too few polls, the wait for a slow word times out. The word then stays pending, and a later call
    /// must finish it.
    pub const fn new(device: D, port: P, polls: u32) -> Self {
        Self {
            wire: Wire { device },
            aer: Aer::new(port, polls),
            state: State::NotReset,
            registers: None,
            loaded: Loaded::NONE,
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

    /// Sets the length of a time step to `step` µs. [`Running::feed`] and [`Running::advance`] then send a leak event
    /// for every `step` µs that pass. Without this setting they send no leak events.
    ///
    /// Call [`Running::advance`] at least every 70 minutes. A tick is a time stamp in µs with 32 bits, which wraps
    /// after 71.6 minutes. After a longer pause than 70 minutes the driver cannot tell how much time has passed, and
    /// sends too few leak events or none.
    #[must_use]
    pub fn with_time_step(self, step: NonZeroU32) -> Self {
        Self { time: Some(Time::new(step)), ..self }
    }

    /// Sets the number of pin reads that fit into one clock cycle of the chip. The default is 1; set more if the
    /// microcontroller is much faster than the chip. The driver multiplies the pin reads of every wait by this number.
    ///
    /// If the number is too low, the driver stops waiting before the chip is done. Handshakes of words then time out,
    /// and [`Running::gate`] may gate a chip that is still working. The neurons' potentials are then wrong.
    #[must_use]
    pub fn with_reads_per_clock(mut self, reads: NonZeroU32) -> Self {
        self.aer.set_reads_per_clock(reads);
        self
    }

    /// Pulses reset, which brings chip and bus into sync; then gates the chip, opens its loop, and checks that the chip
    /// answers. For the check, at least one bit in the parameters of neuron [`Input::PROBED`] must be 1. If all of them
    /// are 0, as in a neuron that was never written, this call sets the bit that disables the neuron.
    ///
    /// Spikes in the chip's queue are lost, and the pending word (sent, but not acknowledged by the chip) is dropped.
    /// If the pending word is an event of [`Running::feed`], the driver keeps the event, and the next call of `feed`
    /// sends it again.
    ///
    /// # Errors
    /// Returns an error if the port or the bus failed, or if memory reads back a different value than was written.
    pub fn reset(&mut self, delay: &mut impl DelayNs) -> Outcome<Gated<'_, I, D, P>, D, P> {
        self.state = State::NotReset;
        let (under_way, is_output_lost) = self.aer.reset().map_err(ChipError::Port)?;
        self.drop_under_way(under_way, is_output_lost);
        delay.delay_us(RESET_US);
        self.aer.port.set_reset(false).map_err(ChipError::Port)?;
        delay.delay_us(RESET_US);
        self.counters.resets = self.counters.resets.saturating_add(1);
        (self.anchor, self.beacon) = (None, None);
        self.loaded = Loaded::NONE;
        self.shut()?;
        self.find_beacon()?;
        Ok(Gated::new(self))
    }

    /// Returns a chip that an earlier call left gated.
    ///
    /// # Errors
    /// Returns [`NotReset`](ChipError::NotReset) if the chip must be reset first, or [`NotGated`](ChipError::NotGated)
    /// if the chip runs.
    pub fn gated(&mut self) -> Outcome<Gated<'_, I, D, P>, D, P> {
        match self.state {
            State::NotReset => Err(ChipError::NotReset),
            State::Running => Err(ChipError::NotGated),
            State::Gated => Ok(Gated::new(self)),
        }
    }

    /// Returns a chip that an earlier call left running.
    ///
    /// # Errors
    /// Returns [`NotReset`](ChipError::NotReset), or [`Gated`](ChipError::Gated) if the chip is gated.
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

    /// Consumes the driver and returns its SPI device and port.
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
        // Before the first reset the chip's pins are undefined, so an output seen there is none.
        let is_output_lost = is_output_lost && counters.resets > 0;
        counters.lost_outputs = counters.lost_outputs.saturating_add(is_output_lost.into());
    }
}
