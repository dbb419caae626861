//! The model of tinyODIN and ODIN: their controller, queue and memories.

use alloc::collections::VecDeque;
use alloc::vec;
use alloc::vec::Vec;
use core::fmt::Debug;
use core::marker::PhantomData;

use super::board::{self, Model};
use super::output::Output;
use super::spi::SpiSlave;

/// The properties in which tinyODIN and ODIN differ.
pub trait Kind: Clone + Copy + Debug + Default + 'static {
    /// Number of bytes that a neuron takes in memory.
    const NEURON_BYTES: u16;
    /// Number of spikes and virtual events that the queue holds.
    const QUEUE: usize;
    /// Whether a spike that was applied to all neurons stays in the queue until the output bus is free.
    const POPS_AFTER_OUTPUT: bool;
    /// Whether the gate shuts only when the controller is idle.
    const GATE_WAITS: bool;

    /// Decodes a word on the input bus.
    fn decode(word: u32) -> Input;
    /// Returns the highest neuron to which a spike is applied.
    fn last_neuron(registers: &Registers) -> u8;
    /// Returns whether the output bus carries the spikes that leave the queue, rather than those of neurons that fire.
    fn outputs_are_popped(registers: &Registers) -> bool;
    /// Returns the bits of a neuron after an event, and whether the neuron fires. Ignores the bit that disables the
    /// neuron.
    fn update(neuron: u128, drive: Drive, registers: &Registers) -> (u128, bool);
    /// Returns whether the neuron's disabling bit is set, so that the neuron never fires.
    fn is_disabled(neuron: u128) -> bool;
    /// Returns whether a bistability event, which moves a weight by 1 towards 0 or 7, may change this synapse.
    fn is_plastic(synapse: u8, registers: &Registers) -> bool;
    /// Returns whether the chip sends a spike from its queue to the output bus when it applies the spike to `neuron`.
    /// (The chip applies the spike to one neuron after the other.) Called only if the output bus carries the spikes
    /// from the queue, and [`POPS_AFTER_OUTPUT`](Self::POPS_AFTER_OUTPUT) is false.
    fn is_popped_at(neuron: u8, registers: &Registers) -> bool;
}

/// A word on the input bus, decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// A time step of the given neuron, or of all neurons if `None`.
    Leak(Option<u8>),
    /// A bistability event for the synapses from the given neuron, or from all neurons if `None`.
    Bistability(Option<u8>),
    /// A spike on one synapse: the presynaptic and the postsynaptic neuron.
    Synapse(u8, u8),
    /// An event that goes to the queue. For a virtual event the first value is its
    /// [`virtual_bits`](Drive::virtual_bits); for a spike it is 0. The second value is the neuron.
    Queued(u8, u8),
}

/// The signals that the controller gives to a neuron. They describe the event that acts on the neuron, if there is one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Drive {
    /// Whether an event acts on the neuron. False if the neuron is only read or written over SPI.
    pub is_event: bool,
    /// Whether the event is a time step from the input word [`Leak`](Input::Leak). False for a virtual leak of ODIN,
    /// which is a virtual event.
    pub is_leak: bool,
    /// For a virtual event, bits of its input word; 0 for other events. On tinyODIN the bits are the weight. On ODIN
    /// they are the weight, its sign, and a bit that makes the event a leak.
    pub virtual_bits: u8,
    /// The 4 bits of the synapse through which the event acts.
    pub synapse: u8,
    /// The presynaptic neuron.
    pub pre: u8,
}

/// The configuration registers, by number. A reset does not change them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Registers(pub [u32; 26]);

impl Registers {
    /// Returns bit 0 of a register, for registers of one bit.
    pub const fn bit(&self, register: usize) -> bool {
        self.0[register] & 1 == 1
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum State {
    #[default]
    Wait,
    WriteNeuron,
    ReadNeuron,
    WriteSynapses,
    ReadSynapses,
    Leak,
    Bistability,
    Synapse,
    Push,
    Spike,
    Virtual,
    Pop,
    WaitSpi,
    WaitRequest,
}

/// The state that changes with the chip's clock and that reset clears.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Clocked {
    request: [bool; 2],
    gate: [bool; 2],
    reading: [bool; 2],
    writing: [bool; 2],
    open_loop: [bool; 2],
    state: State,
    count: u32,
    neuron_count: u8,
    output: Output,
}

/// The accesses to memories and queue that the controller requests in a clock cycle.
#[derive(Clone, Copy, Debug, Default)]
struct Control {
    neuron: Option<(u8, bool)>,
    synapses: Option<(u16, bool)>,
    is_event: bool,
    is_leak: bool,
    virtual_bits: u8,
    push: Option<(u8, u8)>,
    pop: bool,
    next_neuron: bool,
    is_bistability: bool,
}

/// The model of a tinyODIN or an ODIN; the type `K` selects which of the two.
#[derive(Clone, Debug)]
pub struct Chip<K> {
    /// Level of the reset pin RST.
    pub reset: bool,
    /// Word on the input bus.
    pub word: u32,
    /// Level of the input bus's REQ.
    pub request: bool,
    /// Level of the output bus's ACK.
    pub output_acknowledge: bool,
    spi: SpiSlave,
    /// The configuration registers.
    pub registers: Registers,
    resets: [bool; 2],
    clocked: Clocked,
    neuron_read: u128,
    synapses_read: u32,
    queue: VecDeque<(u8, u8)>,
    /// The memory of neurons.
    pub neurons: Vec<u128>,
    /// The memory of synapses, eight in each word.
    pub synapses: Vec<u32>,
    is_still: bool,
    /// Number of clock cycles so far.
    pub clocks: u64,
    /// Words that the chip has acknowledged, in order.
    pub taken: Vec<u32>,
    /// Neurons whose spikes went to the output bus, in order.
    pub fired: Vec<u8>,
    /// Number of spikes that were lost because the queue was full.
    pub overflows: u32,
    kind: PhantomData<K>,
}

impl<K: Kind> Default for Chip<K> {
    /// Makes a chip just after power-up, in the state that is the hardest for a driver: not gated, in closed loop,
    /// with memories that are all 0.
    fn default() -> Self {
        Self {
            reset: false,
            word: 0,
            request: false,
            output_acknowledge: false,
            spi: SpiSlave::default(),
            registers: Registers([0; 26]),
            resets: [false; 2],
            clocked: Clocked::default(),
            neuron_read: 0,
            synapses_read: 0,
            queue: VecDeque::new(),
            neurons: vec![0; 256],
            synapses: vec![0; 8192],
            is_still: false,
            clocks: 0,
            taken: Vec::new(),
            fired: Vec::new(),
            overflows: 0,
            kind: PhantomData,
        }
    }
}

/// The pins of tinyODIN or ODIN, and their faults.
pub type Pins<K> = board::Pins<Chip<K>>;

/// A simulated board with tinyODIN or ODIN.
pub type Board<K> = board::Board<Chip<K>>;

/// The SPI device of tinyODIN or ODIN.
pub type Spi<K> = board::Spi<Chip<K>>;

/// The port of tinyODIN or ODIN.
pub type Port<K> = board::Port<Chip<K>>;

impl<K: Kind> Model for Chip<K> {
    fn run(&mut self, clocks: u32) {
        self.run(clocks);
    }

    fn miso(&self) -> bool {
        self.spi.output()
    }

    fn rise(&mut self, bit: bool) {
        if let Some(written) = self.spi.rise(bit)
            && let Some(register) = self.registers.0.get_mut(usize::from(written.register))
        {
            *register = written.value;
            self.is_still = false;
        }
    }

    fn fall(&mut self) {
        let before = self.spi;
        self.spi.fall(self.neuron_read, self.synapses_read);
        let asks = |spi: &SpiSlave| (spi.is_reading, spi.is_writing);
        self.is_still &= asks(&before) == asks(&self.spi);
    }
}

impl<K: Kind> Chip<K> {
    /// Returns the level of the input bus's ACK.
    pub fn acknowledge(&self) -> bool {
        self.clocked.state == State::WaitRequest
    }

    /// Returns the state of the output bus.
    pub fn output(&self) -> Output {
        self.clocked.output
    }

    /// Returns the level of the pin `SCHED_FULL`, which is high while the queue is full.
    pub fn is_full(&self) -> bool {
        self.queue.len() == K::QUEUE
    }

    /// Returns the number of spikes and virtual events in the queue.
    pub fn waiting(&self) -> usize {
        self.queue.len()
    }

    /// Returns whether the chip is gated. A write to register 0 changes the result only some clock cycles later, when
    /// the new value has passed the synchroniser to the chip's clock.
    pub fn is_gated(&self) -> bool {
        self.clocked.gate[1]
    }

    /// Returns whether controller, queue and output bus are idle.
    pub fn is_idle(&self) -> bool {
        self.queue.is_empty() && self.clocked.state == State::Wait && !self.clocked.output.is_busy
    }

    /// Returns the 4 bits of the synapse from `pre` to `post`.
    pub fn synapse(&self, pre: u8, post: u8) -> u8 {
        let word = self.synapses[usize::from(pre) << 5 | usize::from(post) >> 3];
        (word >> (4 * (post & 7)) & 0xF) as u8
    }

    /// Drives the reset pin RST.
    pub fn set_reset(&mut self, is_high: bool) {
        self.is_still &= self.reset == is_high;
        self.reset = is_high;
        if is_high {
            self.spi.reset();
        }
    }

    /// Drives the input bus's REQ.
    pub fn set_request(&mut self, is_high: bool) {
        self.is_still &= self.request == is_high;
        self.request = is_high;
    }

    /// Drives the output bus's ACK.
    pub fn set_output_acknowledge(&mut self, is_high: bool) {
        self.is_still &= self.output_acknowledge == is_high;
        self.output_acknowledge = is_high;
    }

    /// Puts a word on the input bus.
    pub fn set_word(&mut self, word: u32) {
        self.is_still &= self.word == word;
        self.word = word;
    }

    /// Runs the chip for `clocks` clock cycles. Skips the rest of them if no further clock cycle can change anything;
    /// [`clocks`](Self::clocks) counts the skipped cycles, too.
    pub fn run(&mut self, clocks: u32) {
        self.clocks += u64::from(clocks);
        for _ in 0..clocks {
            if self.is_still {
                return;
            }
            self.clock();
        }
    }

    fn clock(&mut self) {
        let before = (self.clocked, self.neuron_read, self.synapses_read, self.resets);
        let spi = self.spi;
        let was_full = self.is_full();
        let head = self.queue.front().copied();
        let control = self.control(head);
        let next_state = self.next_state(&control, head, was_full);
        let is_gated = self.clocked.gate[1];

        let fired = self.neuron_memory(&control, head, is_gated);
        self.synapse_memory(&control, is_gated);

        let c = &mut self.clocked;
        let spike = if K::outputs_are_popped(&self.registers) {
            let is_leaving = c.state == State::Spike && next_state != State::Spike;
            let is_popped = if K::POPS_AFTER_OUTPUT {
                is_leaving
            } else {
                c.state == State::Spike
                    && c.count & 1 == 1
                    && K::is_popped_at(c.neuron_count, &self.registers)
            };
            head.filter(|_| is_popped).map(|(_, pre)| pre)
        } else {
            fired
        };
        let is_busy = c.output.is_busy;
        let was_requested = c.output.request;
        c.output.clock(self.output_acknowledge, spike);
        if c.output.request && !was_requested && !is_gated {
            self.fired.push(c.output.address);
        }

        if control.pop && head.is_some() {
            self.queue.pop_front();
        }
        let internal = fired.filter(|_| !c.open_loop[1]).map(|neuron| (0, neuron));
        if let Some(entry) = control.push.or(internal) {
            if was_full {
                self.overflows += 1;
            } else {
                self.queue.push_back(entry);
            }
        }
        if next_state == State::WaitRequest && c.state != State::WaitRequest {
            self.taken.push(self.word);
        }

        let shift = |bits: &mut [bool; 2], pin| *bits = [pin, bits[0]];
        let gate = c.gate[0] && (!K::GATE_WAITS || next_state == State::Wait || c.gate[1]);
        c.gate = [self.registers.bit(0), gate];
        shift(&mut c.request, self.request);
        shift(&mut c.reading, spi.is_reading);
        shift(&mut c.writing, spi.is_writing);
        shift(&mut c.open_loop, self.registers.bit(1));
        if c.state == State::Wait {
            (c.count, c.neuron_count) = (0, 0);
        } else if !is_busy {
            // In states that only wait, the value of the counter does not matter.
            let counts = !matches!(c.state, State::WaitSpi | State::WaitRequest | State::Pop);
            c.count = c.count.wrapping_add(u32::from(counts));
            c.neuron_count = c.neuron_count.wrapping_add(u8::from(control.next_neuron));
        }
        c.state = next_state;

        self.resets = [self.reset, self.resets[0]];
        if self.resets[1] {
            self.clocked = Clocked::default();
            self.queue.clear();
        }
        if is_gated || self.clocked.gate[1] {
            self.clocked.output = Output::default();
        }
        let after = (self.clocked, self.neuron_read, self.synapses_read, self.resets);
        self.is_still = before == after;
    }

    fn control(&self, head: Option<(u8, u8)>) -> Control {
        let Clocked { state, count, neuron_count, output, .. } = self.clocked;
        let (bits, pre) = head.unwrap_or_default();
        let is_second = count & 1 == 1;
        let spi = self.spi.memory_address;
        let none = Control::default();
        match state {
            State::Wait | State::WaitSpi | State::WaitRequest => none,
            State::WriteNeuron => Control { neuron: Some((spi as u8, count != 0)), ..none },
            State::ReadNeuron => Control { neuron: Some((spi as u8, false)), ..none },
            State::WriteSynapses => Control { synapses: Some((spi & 0x1FFF, count != 0)), ..none },
            State::ReadSynapses => Control { synapses: Some((spi & 0x1FFF, false)), ..none },
            State::Leak => {
                let one = match K::decode(self.word) {
                    Input::Leak(neuron) => neuron,
                    // The word changed during its handshake; the chip decodes the new bits.
                    _ => None,
                };
                Control {
                    neuron: Some((one.unwrap_or(neuron_count), is_second)),
                    is_event: true,
                    is_leak: true,
                    next_neuron: is_second && one.is_none(),
                    ..none
                }
            }
            State::Bistability => {
                let one = match K::decode(self.word) {
                    Input::Bistability(neuron) => neuron,
                    _ => None,
                };
                let pre = u16::from(one.unwrap_or(neuron_count));
                let group = (count >> 1 & 0x1F) as u16;
                Control {
                    synapses: Some((pre << 5 | group, is_second)),
                    is_bistability: true,
                    next_neuron: is_second && one.is_none() && group == 0x1F,
                    ..none
                }
            }
            State::Synapse => {
                let (pre, post) = ((self.word >> 8) as u16 & 0xFF, self.word as u8);
                Control {
                    neuron: Some((post, count != 0)),
                    synapses: Some((pre << 5 | u16::from(post) >> 3, count != 0)),
                    is_event: true,
                    ..none
                }
            }
            State::Push => {
                let push = match K::decode(self.word) {
                    Input::Queued(bits, address) => Some((bits, address)),
                    _ => None,
                };
                Control { push, ..none }
            }
            State::Spike => {
                let group = u16::from(pre) << 5 | u16::from(neuron_count) >> 3;
                Control {
                    neuron: Some((neuron_count, is_second)),
                    synapses: (neuron_count & 7 == 0).then_some((group, false)),
                    is_event: true,
                    next_neuron: is_second,
                    pop: !K::POPS_AFTER_OUTPUT && count & 0x1FF == 0x1FF,
                    ..none
                }
            }
            State::Virtual => Control {
                neuron: Some((pre, count != 0)),
                is_event: true,
                virtual_bits: bits,
                pop: count != 0,
                ..none
            },
            State::Pop => Control { pop: !output.is_busy, ..none },
        }
    }

    fn next_state(&self, control: &Control, head: Option<(u8, u8)>, is_full: bool) -> State {
        let Clocked { state, count, neuron_count, output, .. } = self.clocked;
        let is_last = neuron_count == K::last_neuron(&self.registers);
        match state {
            State::Wait => self.choose(head, is_full),
            State::WriteNeuron | State::WriteSynapses if count != 1 => state,
            State::WriteNeuron | State::ReadNeuron | State::WriteSynapses | State::ReadSynapses => {
                State::WaitSpi
            }
            State::Leak => {
                let is_over = match K::decode(self.word) {
                    Input::Leak(Some(_)) => count == 1,
                    _ => is_last && control.next_neuron,
                };
                if is_over { State::WaitRequest } else { state }
            }
            State::Bistability => {
                let is_over = match K::decode(self.word) {
                    Input::Bistability(Some(_)) => count == 63,
                    _ => neuron_count == 255 && count & 63 == 63,
                };
                if is_over { State::WaitRequest } else { state }
            }
            State::Synapse if count != 1 => state,
            State::Synapse | State::Push => State::WaitRequest,
            State::Spike => {
                let last = u32::from(K::last_neuron(&self.registers));
                match count & 0x1FF == last << 1 | 1 {
                    false => state,
                    true if K::POPS_AFTER_OUTPUT => State::Pop,
                    true => State::Wait,
                }
            }
            State::Virtual if control.pop => State::Wait,
            State::Virtual => state,
            State::Pop if output.is_busy => state,
            State::Pop => State::Wait,
            State::WaitSpi if self.clocked.reading[1] || self.clocked.writing[1] => state,
            State::WaitRequest if self.clocked.request[1] => state,
            State::WaitSpi | State::WaitRequest => State::Wait,
        }
    }

    /// Returns the state that an idle controller enters next.
    fn choose(&self, head: Option<(u8, u8)>, is_full: bool) -> State {
        let Clocked { request, gate, reading, writing, output, .. } = self.clocked;
        let pop = |(bits, _)| if bits == 0 { State::Spike } else { State::Virtual };
        if output.is_busy {
            return State::Wait;
        }
        if gate[1] {
            return match (writing[1], reading[1], self.spi.memory) {
                (true, _, 1) => State::WriteNeuron,
                (_, true, 1) => State::ReadNeuron,
                (true, _, 2) => State::WriteSynapses,
                (_, true, 2) => State::ReadSynapses,
                _ => State::Wait,
            };
        }
        let input = K::decode(self.word);
        let is_bistability = matches!(input, Input::Bistability(_));
        match head {
            Some(head) if is_full => pop(head),
            _ if request[1] && !is_bistability => match input {
                Input::Leak(_) => State::Leak,
                Input::Synapse(..) => State::Synapse,
                Input::Queued(..) | Input::Bistability(_) => State::Push,
            },
            Some(head) => pop(head),
            None if request[1] => State::Bistability,
            None => State::Wait,
        }
    }

    /// Reads or writes the memory of neurons; returns the number of the neuron if the neuron fires.
    fn neuron_memory(
        &mut self,
        control: &Control,
        head: Option<(u8, u8)>,
        is_gated: bool,
    ) -> Option<u8> {
        let (address, is_write) = control.neuron?;
        let old = self.neuron_read;
        let pre = match self.clocked.state {
            State::Synapse => (self.word >> 8) as u8,
            _ => head.unwrap_or_default().1,
        };
        let drive = Drive {
            is_event: control.is_event,
            is_leak: control.is_leak,
            virtual_bits: control.virtual_bits,
            synapse: (self.synapses_read >> (4 * (address & 7)) & 0xF) as u8,
            pre,
        };
        let (next, fires) = K::update(old, drive, &self.registers);
        self.neuron_read = self.neurons[usize::from(address)];
        if !is_write {
            return None;
        }
        self.neurons[usize::from(address)] = if is_gated {
            let byte = self.spi.memory_address >> 8;
            if byte < K::NEURON_BYTES {
                let place = 8 * u32::from(byte);
                let merged = self.spi.merge((old >> place) as u8);
                old & !(0xFF << place) | u128::from(merged) << place
            } else {
                old
            }
        } else {
            next
        };
        (fires && !K::is_disabled(old)).then_some(address)
    }

    fn synapse_memory(&mut self, control: &Control, is_gated: bool) {
        let Some((address, is_write)) = control.synapses else { return };
        let old = self.synapses_read;
        let address = usize::from(address);
        self.synapses_read = self.synapses[address];
        if !is_write {
            return;
        }
        self.synapses[address] = if is_gated {
            let place = 8 * u32::from(self.spi.memory_address >> 13 & 3);
            let merged = self.spi.merge((old >> place) as u8);
            old & !(0xFF << place) | u32::from(merged) << place
        } else if control.is_bistability {
            (0..8).fold(0, |word, at| {
                let synapse = (old >> (4 * at) & 0xF) as u8;
                word | u32::from(self.settle(synapse)) << (4 * at)
            })
        } else {
            old
        };
    }

    /// Returns the synapse after a bistability event: weights of 4 or more rise by one, up to 7; weights of 3 or less
    /// fall by one, down to 0.
    fn settle(&self, synapse: u8) -> u8 {
        match synapse & 7 {
            _ if !K::is_plastic(synapse, &self.registers) => synapse,
            0 | 7 => synapse,
            4.. => synapse + 1,
            _ => synapse - 1,
        }
    }
}
