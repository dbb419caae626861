//! What tinyODIN and ODIN have in common: SPI without chip select, reset, gate, and event buses.

use core::num::NonZeroU32;

use embedded_hal::delay::DelayNs;
use embedded_hal::spi::SpiDevice;

use super::aer::Aer;
use super::error::at_most;
use super::{AerPort, ChipError};
use crate::event::{Event, Source, Tick};

/// What goes into a chip of the family: its words on the input bus.
pub trait Input: Copy {
    /// A time step for all neurons: the chip has no clock of its own for time.
    const LEAK_ALL: Self;
    /// How many bytes a neuron has in memory.
    const NEURON_BYTES: u8;
    /// The most clocks of the chip from a word's REQ to its ACK, of all words and with the queue full;
    /// outputs that wait and spikes that the chip sends itself come on top.
    const MAX_CLOCKS: u32;

    /// The word, or what is wrong with it.
    ///
    /// # Errors
    /// A value that there is not, or a virtual event of weight 0.
    fn word<B, P>(self) -> Result<u32, ChipError<B, P>>;
}

/// A chip of the ODIN family, on an SPI device and a port.
///
/// - **SPI:** mode 0, SCK at most a quarter of the chip's clock. The chip has no chip select: it needs
///   a bus of its own and a device whose chip select is not wired.
/// - **Order:** [`reset`](Self::reset), [`gate`](Self::gate), configure and program, verified by
///   reading back, [`run`](Self::run), send. Anything out of order is refused.
/// - **Resynchronisation:** one clock lost puts chip and bus out of step. After an error of the bus, or
///   a byte that does not read back, all is refused until the next reset, which is
///   [counted](Self::resets).
/// - **Waits** look at the pins a given number of times, then give up.
/// - **Words** that the chip has not acknowledged by then stay under way: every call that sends finishes
///   them first, [`poll`](Self::poll) goes on with them, a reset drops them.
/// - **Events** that could not be sent are held and come first the next time, after a reset too.
#[derive(Debug)]
pub struct OdinChip<I, D, P> {
    device: D,
    aer: Aer<P>,
    state: State,
    resets: u32,
    held: Option<Event>,
    time: Option<Time>,
    skipped_steps: u32,
    late_events: u32,
    input: core::marker::PhantomData<I>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Out of step, or not reset yet.
    NotReset,
    /// In step; the gate is as it was.
    Reset,
    Gated,
    Running,
}

/// The time steps that leak events tell the chip.
#[derive(Clone, Copy, Debug)]
struct Time {
    step: NonZeroU32,
    /// When the last one was due.
    last: Option<Tick>,
}

/// The most leak events at once.
const MAX_LEAKS: u32 = 255;
/// `a19:16`: read, write and the memory.
const READ: u32 = 1 << 19;
const WRITE: u32 = 1 << 18;
const NEURON: u32 = 1 << 16;
const SYNAPSE: u32 = 2 << 16;
const GATE_ACTIVITY: u16 = 0;
/// How long reset is high, and then the chip left alone.
const RESET_US: u32 = 10;

impl<I: Input, D: SpiDevice, P: AerPort> OdinChip<I, D, P> {
    /// A chip that must be [reset](Self::reset) first. Every wait looks at the pins `polls` times.
    ///
    /// [`Input::MAX_CLOCKS`] polls suffice if one takes a clock of the chip or longer. Fewer do no harm
    /// but that long words time out and have to be finished later.
    pub const fn new(device: D, port: P, polls: u32) -> Self {
        Self {
            device,
            aer: Aer::new(port, polls),
            state: State::NotReset,
            resets: 0,
            held: None,
            time: None,
            skipped_steps: 0,
            late_events: 0,
            input: core::marker::PhantomData,
        }
    }

    /// Sends a leak event to all neurons for every `step` µs that pass between events.
    ///
    /// Call [`advance`](Self::advance) at least every 35 minutes: a tick 2³¹ µs ahead lies in the past,
    /// and no leaks are sent until time has caught up.
    #[must_use]
    pub fn with_time_step(self, step: NonZeroU32) -> Self {
        Self { time: Some(Time { step, last: None }), ..self }
    }

    /// Pulses reset, which brings chip and bus into step. Configuration registers have no reset value:
    /// configure them anew. What the chip has taken and not worked off is gone, and a word under way is
    /// dropped; if that was an event of [`feed`](Self::feed), it is held again.
    ///
    /// # Errors
    /// The port failed.
    pub fn reset(&mut self, delay: &mut impl DelayNs) -> Result<(), ChipError<D::Error, P::Error>> {
        self.state = State::NotReset;
        let (event, released) = self.aer.release();
        self.held = event.or(self.held);
        released.map_err(ChipError::Port)?;
        self.aer.port.set_reset(true).map_err(ChipError::Port)?;
        delay.delay_us(RESET_US);
        self.aer.port.set_reset(false).map_err(ChipError::Port)?;
        delay.delay_us(RESET_US);
        self.resets = self.resets.saturating_add(1);
        self.state = State::Reset;
        Ok(())
    }

    /// Gates the chip's activity: memory can be accessed, events are not taken.
    ///
    /// # Errors
    /// The bus failed, or the chip was not reset.
    pub fn gate(&mut self) -> Result<(), ChipError<D::Error, P::Error>> {
        self.write_register(GATE_ACTIVITY, 1)?;
        self.state = State::Gated;
        Ok(())
    }

    /// Lets the chip run: events are taken, memory cannot be accessed.
    ///
    /// # Errors
    /// The bus failed, or the chip was not reset.
    pub fn run(&mut self) -> Result<(), ChipError<D::Error, P::Error>> {
        self.write_register(GATE_ACTIVITY, 0)?;
        self.state = State::Running;
        Ok(())
    }

    /// Writes a configuration register, which cannot be read back; register 0 is the gate.
    ///
    /// # Errors
    /// The bus failed, the activity is not gated, the value has more than 20 bits, or the register is
    /// the gate.
    pub fn configure(
        &mut self,
        register: u16,
        value: u32,
    ) -> Result<(), ChipError<D::Error, P::Error>> {
        if register == GATE_ACTIVITY {
            let (what, max) = ("register", u16::MAX.into());
            return Err(ChipError::OutOfRange { what, value: 0, min: 1, max });
        }
        at_most("value", value, (1 << 20) - 1)?;
        self.expect_gated()?;
        self.write_register(register, value)
    }

    /// Writes a byte of a neuron's parameters and state.
    ///
    /// # Errors
    /// The bus failed, the activity is not gated, or there is no such byte.
    pub fn write_neuron(
        &mut self,
        neuron: u8,
        byte: u8,
        value: u8,
    ) -> Result<(), ChipError<D::Error, P::Error>> {
        self.write_memory(neuron_address(neuron, byte, I::NEURON_BYTES)?, 0, value)
    }

    /// Reads a byte of a neuron's parameters and state.
    ///
    /// # Errors
    /// As [`write_neuron`](Self::write_neuron).
    pub fn read_neuron(
        &mut self,
        neuron: u8,
        byte: u8,
    ) -> Result<u8, ChipError<D::Error, P::Error>> {
        self.read_memory(neuron_address(neuron, byte, I::NEURON_BYTES)?)
    }

    /// Writes a byte of a neuron and reads it back.
    ///
    /// # Errors
    /// As [`write_neuron`](Self::write_neuron), and when it does not read back: then reset the chip.
    pub fn program_neuron(
        &mut self,
        neuron: u8,
        byte: u8,
        value: u8,
    ) -> Result<(), ChipError<D::Error, P::Error>> {
        self.write_neuron(neuron, byte, value)?;
        let read = self.read_neuron(neuron, byte)?;
        self.verify(neuron_address(neuron, byte, I::NEURON_BYTES)?, value, read)
    }

    /// Writes the 4 bits of the synapse from `pre` to `post`, 0 to 15: a signed weight in tinyODIN; in
    /// ODIN the mapping bit and 3 bits of weight.
    ///
    /// # Errors
    /// The bus failed, the activity is not gated, or the weight has more than 4 bits.
    pub fn write_synapse(
        &mut self,
        pre: u8,
        post: u8,
        weight: u8,
    ) -> Result<(), ChipError<D::Error, P::Error>> {
        at_most("weight", weight.into(), 15)?;
        let (keep, value) = if post & 1 == 0 { (0xF0, weight) } else { (0x0F, weight << 4) };
        self.write_memory(synapse_address(pre, post), keep, value)
    }

    /// Reads the 4 bits of the synapse from `pre` to `post`.
    ///
    /// # Errors
    /// The bus failed, or the activity is not gated.
    pub fn read_synapse(&mut self, pre: u8, post: u8) -> Result<u8, ChipError<D::Error, P::Error>> {
        let byte = self.read_memory(synapse_address(pre, post))?;
        Ok(if post & 1 == 0 { byte & 0xF } else { byte >> 4 })
    }

    /// Writes a synapse and reads it back.
    ///
    /// # Errors
    /// As [`write_synapse`](Self::write_synapse), and when it does not read back: then reset the chip.
    pub fn program_synapse(
        &mut self,
        pre: u8,
        post: u8,
        weight: u8,
    ) -> Result<(), ChipError<D::Error, P::Error>> {
        self.write_synapse(pre, post, weight)?;
        let read = self.read_synapse(pre, post)?;
        self.verify(synapse_address(pre, post), weight, read)
    }

    /// Sends one input, and hands the neurons that fire meanwhile to `on_output`.
    ///
    /// # Errors
    /// The input is not valid, the chip is gated or does not answer, or the port failed. After
    /// [`Phase::Idle`](super::Phase::Idle) the input was not sent; after any other
    /// [`Handshake`](ChipError::Handshake) it is under way, and not to be sent again.
    pub fn send(
        &mut self,
        input: I,
        mut on_output: impl FnMut(u8),
    ) -> Result<(), ChipError<D::Error, P::Error>> {
        self.put(input, &mut on_output)
    }

    /// Sends the events of a source, each as the input that `to_input` makes of it, and the time steps
    /// between them. Returns how many events were sent. From a queue take `consumer.waiting()`, which
    /// ends even if events come faster than the chip takes them.
    ///
    /// Events must come in the order of time. One from a time step that is over is sent in the present
    /// one, and counted as [late](Self::late_events).
    ///
    /// # Errors
    /// As [`send`](Self::send), but whatever the error, call it again with the events that remain: none
    /// is lost or sent twice. Only one whose input is not valid is dropped.
    pub fn feed(
        &mut self,
        mut events: impl Source,
        mut to_input: impl FnMut(Event) -> I,
        mut on_output: impl FnMut(u8),
    ) -> Result<u32, ChipError<D::Error, P::Error>> {
        self.expect_running()?;
        self.aer.finish(&mut on_output)?;
        let mut sent = 0;
        while let Some(event) = self.held.take().or_else(|| self.next_of(&mut events)) {
            let word = to_input(event).word()?;
            self.held = Some(event);
            self.advance_with(event.tick, &mut on_output)?;
            let result = self.put_word(word, &mut on_output);
            if self.aer.is_begun {
                self.aer.event = self.held.take();
            }
            result?;
            sent += 1;
        }
        Ok(sent)
    }

    /// Sends the leak events of the time steps that have passed at this tick; the first call only
    /// notes the time. At most 255 are sent, others skipped and counted.
    ///
    /// # Errors
    /// As [`send`](Self::send). Time steps that were not sent are due the next time.
    pub fn advance(
        &mut self,
        now: Tick,
        mut on_output: impl FnMut(u8),
    ) -> Result<(), ChipError<D::Error, P::Error>> {
        self.advance_with(now, &mut on_output)
    }

    /// Takes the neurons that have fired, and goes on with a word under way. Looks at the pins a bounded
    /// number of times: call it often, as the chip stands still while an output waits.
    ///
    /// # Errors
    /// The port failed.
    pub fn poll(
        &mut self,
        mut on_output: impl FnMut(u8),
    ) -> Result<(), ChipError<D::Error, P::Error>> {
        self.aer.poll(&mut on_output).map_err(ChipError::Port)
    }

    /// How often the chip was reset: the first time, and to bring it into step again.
    pub const fn resets(&self) -> u32 {
        self.resets
    }

    /// How many time steps were skipped, after a silence of more than 255.
    pub const fn skipped_steps(&self) -> u32 {
        self.skipped_steps
    }

    /// How many events were [fed](Self::feed) after their time step was over.
    pub const fn late_events(&self) -> u32 {
        self.late_events
    }

    /// The device and the port, for other uses.
    pub fn release(self) -> (D, P) {
        (self.device, self.aer.port)
    }

    fn next_of(&mut self, events: &mut impl Source) -> Option<Event> {
        let event = events.take_event()?;
        if let Some(Time { last: Some(last), .. }) = self.time {
            let is_late = event.tick.is_before(last);
            self.late_events = self.late_events.saturating_add(is_late.into());
        }
        Some(event)
    }

    fn put(
        &mut self,
        input: I,
        on_output: &mut impl FnMut(u8),
    ) -> Result<(), ChipError<D::Error, P::Error>> {
        let word = input.word()?;
        self.put_word(word, on_output)
    }

    fn put_word(
        &mut self,
        word: u32,
        on_output: &mut impl FnMut(u8),
    ) -> Result<(), ChipError<D::Error, P::Error>> {
        self.expect_running()?;
        Ok(self.aer.send(word, on_output)?)
    }

    fn advance_with(
        &mut self,
        now: Tick,
        on_output: &mut impl FnMut(u8),
    ) -> Result<(), ChipError<D::Error, P::Error>> {
        let Some(Time { step, last }) = self.time else { return Ok(()) };
        let mut last = last.unwrap_or(now);
        let due = now.since(last).max(0) as u32 / step;
        let skipped = due.saturating_sub(MAX_LEAKS);
        last += skipped.wrapping_mul(step.get());
        self.skipped_steps = self.skipped_steps.saturating_add(skipped);
        self.time = Some(Time { step, last: Some(last) });
        for _ in skipped..due {
            let result = self.put(I::LEAK_ALL, on_output);
            if self.aer.is_begun {
                last += step.get();
                self.time = Some(Time { step, last: Some(last) });
            }
            result?;
        }
        Ok(())
    }

    fn expect_running(&self) -> Result<(), ChipError<D::Error, P::Error>> {
        match self.state {
            State::NotReset => Err(ChipError::NotReset),
            State::Reset | State::Gated => Err(ChipError::Gated),
            State::Running => Ok(()),
        }
    }

    fn expect_gated(&self) -> Result<(), ChipError<D::Error, P::Error>> {
        match self.state {
            State::NotReset => Err(ChipError::NotReset),
            State::Reset | State::Running => Err(ChipError::NotGated),
            State::Gated => Ok(()),
        }
    }

    fn verify(
        &mut self,
        address: u32,
        written: u8,
        read: u8,
    ) -> Result<(), ChipError<D::Error, P::Error>> {
        if written == read {
            return Ok(());
        }
        self.state = State::NotReset;
        Err(ChipError::ReadBack { address, written: written.into(), read: read.into() })
    }

    fn write_register(
        &mut self,
        register: u16,
        value: u32,
    ) -> Result<(), ChipError<D::Error, P::Error>> {
        self.transfer(u32::from(register), value).map(|_| ())
    }

    /// Bits of `keep` that are 1 stay as they are.
    fn write_memory(
        &mut self,
        address: u32,
        keep: u8,
        value: u8,
    ) -> Result<(), ChipError<D::Error, P::Error>> {
        self.expect_gated()?;
        self.transfer(WRITE | address, u32::from(keep) << 8 | u32::from(value)).map(|_| ())
    }

    fn read_memory(&mut self, address: u32) -> Result<u8, ChipError<D::Error, P::Error>> {
        self.expect_gated()?;
        self.transfer(READ | address, 0)
    }

    /// 20 bits of address, 20 of data; the last byte that comes back is what was read.
    fn transfer(&mut self, address: u32, data: u32) -> Result<u8, ChipError<D::Error, P::Error>> {
        if self.state == State::NotReset {
            return Err(ChipError::NotReset);
        }
        let [_, _, _, bytes @ ..] = (u64::from(address) << 20 | u64::from(data)).to_be_bytes();
        let mut frame: [u8; 5] = bytes;
        if address & READ == 0 {
            self.device.write(&frame)
        } else {
            self.device.transfer_in_place(&mut frame)
        }
        .map_err(|error| {
            self.state = State::NotReset; // a clock may be lost
            ChipError::Bus(error)
        })?;
        let [.., last] = frame;
        Ok(last)
    }
}

fn neuron_address<B, P>(neuron: u8, byte: u8, bytes: u8) -> Result<u32, ChipError<B, P>> {
    at_most("byte", byte.into(), u32::from(bytes) - 1)?;
    Ok(NEURON | u32::from(byte) << 8 | u32::from(neuron))
}

/// The byte with the synapse: `{byte, pre, post / 8}`, two synapses a byte, four bytes a word.
fn synapse_address(pre: u8, post: u8) -> u32 {
    let (pre, post) = (u32::from(pre), u32::from(post));
    SYNAPSE | (post >> 1 & 3) << 13 | pre << 5 | post >> 3
}
