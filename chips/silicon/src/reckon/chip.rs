//! The model of `ReckOn`: its controllers, its memories, and the arithmetic of neurons and traces.

use alloc::vec;
use alloc::vec::Vec;

use super::learn;
use super::lfsr::Lfsr;
use super::memory::Memory;
use super::spi::{self, SpiSlave};

/// A set of up to 256 neurons or inputs, one bit for each.
pub(super) type Set = [u64; 4];

pub(super) fn has(set: &Set, at: u8) -> bool {
    set[usize::from(at >> 6)] >> (at & 63) & 1 == 1
}

fn put(set: &mut Set, at: u8, value: bool) {
    let bit = 1 << (at & 63);
    let word = &mut set[usize::from(at >> 6)];
    *word = if value { *word | bit } else { *word & !bit };
}

/// The state of the main controller.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum State {
    /// Waits for a sample to begin.
    #[default]
    Idle,
    /// Waits for the next tick. Meanwhile the controller for events applies the spikes of inputs and neurons to all
    /// neurons.
    Prop,
    /// Lets neurons leak and fire, after a tick.
    Step,
    /// Ends the time step.
    StepDone,
    /// Waits for a target from which to learn.
    GetTarget,
    /// Waits while SPI accesses the memories.
    Config,
    /// Changes weights (learns).
    Learn,
    /// Sends the outputs' potentials or a label.
    Send,
}

/// The state of the controller that applies events to neurons.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum EventState {
    /// Waits for an event.
    #[default]
    Wait,
    /// Searches for the next input or neuron that has an event.
    Count,
    /// Applies an event to all neurons. A pair of neurons takes two clock cycles.
    Event,
    /// Updates the trace of an input (a measure of its recent spikes, for learning). Only an input whose number is
    /// higher than that of any neuron needs this state.
    Trace,
}

/// The state of a pair of neurons, as one word of memory stores it. The state of a neuron that was not updated since
/// the sample began counts as 0, whatever the memory holds.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pair {
    pub(super) potential: [i16; 2],
    pub(super) input_trace: [u16; 2],
    pub(super) recurrent_trace: [u16; 2],
    pub(super) output_trace: [u16; 2],
}

/// All state that a clock cycle changes, except for the memories.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Clocked {
    resets: [bool; 2],
    pub(super) target_valid: [bool; 2],
    request: [bool; 2],
    sample: [bool; 2],
    infer: [bool; 2],
    output_acknowledge: [bool; 2],
    tick: [bool; 3],
    writing: [u16; 3],
    reading: [u8; 2],
    acknowledge: bool,
    pub(super) inputs: Set,
    pub(super) next_inputs: Set,
    pub(super) targets: [i16; 16],
    pub(super) label: u8,
    pub(super) has_label: bool,
    pub(super) target_count: u8,
    pub(super) output_request: bool,
    pub(super) output: u8,
    pub(super) send_count: u8,
    pub(super) state: State,
    pub(super) tick_count: u32,
    pub(super) step_count: u8,
    pub(super) timing_error: bool,
    pub(super) post_high: u8,
    pub(super) post_low: u8,
    pub(super) pre: u16,
    pub(super) is_buffering: bool,
    pub(super) signals: [i16; 16],
    pub(super) slopes: [i8; 16],
    pub(super) regularised: [u16; 16],
    pub(super) event_state: EventState,
    output_weights_come: bool,
    is_trace_cycle: bool,
    pub(super) pair_count: u8,
    pub(super) event_count: u8,
    pub(super) fired: Set,
    pub(super) dirty: Set,
    pub(super) outputs: [i16; 16],
    pub(super) winners: [u16; 16],
    pub(super) read: u32,
    pub(super) neuron_word: u128,
    pub(super) input_weights: u128,
    pub(super) recurrent_weights: u128,
    pub(super) output_weights: u128,
    pub(super) input_random: Lfsr,
    pub(super) recurrent_random: Lfsr,
    pub(super) output_random: Lfsr,
    noise: Lfsr,
    rounding: [Lfsr; 2],
    output_rounding: Lfsr,
    input_trace_rounding: [Lfsr; 2],
    recurrent_trace_rounding: [Lfsr; 2],
    output_trace_rounding: [Lfsr; 2],
}

impl Default for Clocked {
    fn default() -> Self {
        let (hidden, output) = (Lfsr::new(15, 1, 15), Lfsr::new(15, 1, 7));
        Self {
            resets: [false; 2],
            target_valid: [false; 2],
            request: [false; 2],
            sample: [false; 2],
            infer: [false; 2],
            output_acknowledge: [false; 2],
            tick: [false; 3],
            writing: [0; 3],
            reading: [0; 2],
            acknowledge: false,
            inputs: [0; 4],
            next_inputs: [0; 4],
            targets: [0; 16],
            label: 0,
            has_label: false,
            target_count: 0,
            output_request: false,
            output: 0,
            send_count: 0,
            state: State::Idle,
            tick_count: 0,
            step_count: 0,
            timing_error: false,
            post_high: 0,
            post_low: 0,
            pre: 0,
            is_buffering: false,
            signals: [0; 16],
            slopes: [0; 16],
            regularised: [0; 16],
            event_state: EventState::Wait,
            output_weights_come: false,
            is_trace_cycle: false,
            pair_count: 0,
            event_count: 0,
            fired: [0; 4],
            dirty: [0; 4],
            outputs: [0; 16],
            winners: [0; 16],
            read: 0,
            neuron_word: 0,
            input_weights: 0,
            recurrent_weights: 0,
            output_weights: 0,
            input_random: Lfsr::new(25, 3, 512),
            recurrent_random: Lfsr::new(25, 3, 512),
            output_random: Lfsr::new(22, 1, 448),
            noise: Lfsr::new(17, 3, 32),
            rounding: [hidden; 2],
            output_rounding: output,
            input_trace_rounding: [hidden; 2],
            recurrent_trace_rounding: [hidden; 2],
            output_trace_rounding: [output; 2],
        }
    }
}

/// The levels of the pins that a host drives, except for those of SPI.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inputs {
    /// Level of `RST`, the reset.
    pub reset: bool,
    /// `AERIN_ADDR`: the number of an input, or a byte of a target.
    pub address: u8,
    /// Level of `AERIN_REQ`, the REQ of the input bus.
    pub request: bool,
    /// `AERIN_TAR_EN`: whether the address is a byte of a target.
    pub is_target: bool,
    /// Level of `SAMPLE`, which is high during a sample.
    pub sample: bool,
    /// Level of `TIME_TICK`, which begins a time step.
    pub tick: bool,
    /// Level of `TARGET_VALID`: whether the chip learns in this step.
    pub target_valid: bool,
    /// Level of `INFER_ACC`: whether this step counts for the label.
    pub infer: bool,
    /// Level of `OUT_ACK`, the ACK of the output bus.
    pub output_acknowledge: bool,
}

/// The levels of the pins that the chip drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outputs {
    /// Level of `MISO`, the SPI output.
    pub miso: bool,
    /// Level of `AERIN_ACK`, the ACK of the input bus.
    pub acknowledge: bool,
    /// Level of `OUT_REQ`, the REQ of the output bus.
    pub request: bool,
    /// `OUT_DATA`: a byte of an answer.
    pub data: u8,
    /// Level of `SPI_RDY`, which is high while SPI may access the memories.
    pub spi_ready: bool,
    /// Level of `TIMING_ERROR_RDY`. If register 23 is 0, the level is high while the chip is ready for a tick. If
    /// register 23 is 1, the level is high from a tick that came too early until the next reset.
    pub error_or_ready: bool,
}

/// The model of the chip `ReckOn`.
#[derive(Clone, Debug)]
pub struct ReckOn {
    pub(super) inputs: Inputs,
    pub(super) spi: SpiSlave,
    pub(super) now: Clocked,
    /// The memory of neurons; each word holds two neurons.
    pub neurons: Vec<u128>,
    /// Weights from inputs to neurons: sixteen weights in each word, sixteen words for each input.
    pub input_weights: Memory,
    /// Weights from neurons to neurons: sixteen weights in each word, sixteen words for each neuron.
    pub recurrent_weights: Memory,
    /// Weights from neurons to outputs: one word for each neuron, one byte for each output.
    pub output_weights: Memory,
    is_still: bool,
    /// Number of clock cycles so far.
    pub clocks: u64,
    /// Neurons that have fired, in order. A test may clear the list.
    pub fired: Vec<u8>,
    /// Addresses that the input bus has accepted, in order. A test may clear the list.
    pub taken: Vec<u8>,
}

impl Default for ReckOn {
    /// Makes a chip in the state after power-up, with memories that are all 0.
    fn default() -> Self {
        Self {
            inputs: Inputs::default(),
            spi: SpiSlave::default(),
            now: Clocked::default(),
            neurons: vec![0; 128],
            input_weights: Memory::new(4096),
            recurrent_weights: Memory::new(4096),
            output_weights: Memory::new(512),
            is_still: false,
            clocks: 0,
            fired: Vec::new(),
            taken: Vec::new(),
        }
    }
}

/// An access to a memory in this clock cycle.
struct Access {
    address: usize,
    /// Data and mask of a write, which changes the bits where the mask is 1; `None` for a read.
    write: Option<(u128, u128)>,
}

/// Returns the memory word `old` after a write: the bits of `data` where `mask` is 1, those of `old` elsewhere.
const fn changed(old: u128, (data, mask): (u128, u128)) -> u128 {
    data & mask | old & !mask
}

fn access(memory: &mut Memory, word: &mut u128, access: Option<&Access>) {
    let Some(&Access { address, write }) = access else { return };
    *word = memory[address];
    if let Some(write) = write {
        memory.set(address, changed(*word, write));
    }
}

/// Returns the data and the mask of a write of 32 bits into a 128-bit word. The two lowest bits of `address` select the
/// quarter of the word.
fn part(address: u16, data: u32) -> (u128, u128) {
    let shift = u32::from(address & 3) * 32;
    (u128::from(data) << shift, 0xFFFF_FFFF << shift)
}

/// Adds three 16-bit numbers as the chip does. If `one` and `other` have the same sign and the sum has the opposite
/// sign, the chip takes this for an overflow, and the sum saturates. This happens even without an overflow, when
/// `noise` alone changes the sign.
fn add(one: i16, other: i16, noise: i16) -> i16 {
    let sum = one.wrapping_add(other).wrapping_add(noise);
    match (one < 0, other < 0, sum < 0) {
        (false, false, true) => i16::MAX,
        (true, true, false) => i16::MIN,
        _ => sum,
    }
}

/// Returns weight `at` of a word of 8-bit weights as a 16-bit number, shifted left by `shift`.
fn shifted(weights: u128, at: u32, shift: u32) -> i16 {
    i16::from((weights >> (8 * at)) as i8) << shift
}

impl ReckOn {
    pub(super) const fn register(&self, register: usize) -> u32 {
        self.spi.register(register)
    }

    pub(super) const fn flag(&self, register: usize) -> bool {
        self.register(register) & 1 == 1
    }

    fn last_input(&self) -> u8 {
        self.register(94) as u8
    }

    fn last_neuron(&self) -> u8 {
        self.register(95) as u8
    }

    fn last_output(&self) -> u8 {
        self.register(96) as u8
    }

    /// Returns the levels of the pins that the chip drives.
    pub fn outputs(&self) -> Outputs {
        let now = &self.now;
        Outputs {
            miso: self.spi.output(now.read) || self.flag(3) && now.state == State::GetTarget,
            acknowledge: now.acknowledge,
            request: now.output_request,
            data: now.output,
            spi_ready: now.state == State::Config,
            error_or_ready: if self.flag(23) { now.timing_error } else { self.is_ready() },
        }
    }

    /// Returns the levels of the pins that a host drives.
    pub const fn inputs(&self) -> Inputs {
        self.inputs
    }

    /// Sets the levels of the pins that a host drives, except for those of SPI.
    pub fn set_inputs(&mut self, inputs: Inputs) {
        self.is_still &= self.inputs == inputs;
        if inputs.reset && !self.inputs.reset {
            self.spi.reset();
        }
        self.inputs = inputs;
    }

    /// Raises SCK, the SPI clock, with the chip's SPI input MOSI at `bit`.
    pub fn rise(&mut self, bit: bool) {
        self.is_still = false;
        self.spi.rise(bit, self.inputs.reset);
    }

    /// Lowers SCK, the SPI clock.
    pub fn fall(&mut self) {
        self.is_still = false;
        if !self.inputs.reset {
            self.spi.fall(self.now.read);
        }
    }

    /// Runs the chip for `clocks` clock cycles. Skips the rest of them if no further clock cycle can change anything;
    /// [`clocks`](Self::clocks) counts the skipped cycles, too.
    pub fn run(&mut self, clocks: u32) {
        self.clocks += u64::from(clocks);
        for _ in 0..clocks {
            if self.is_still {
                return;
            }
            let before = self.now;
            self.clock();
            self.is_still = before == self.now;
        }
    }

    /// Returns the value of a configuration register.
    pub fn register_value(&self, register: usize) -> u32 {
        self.register(register)
    }

    /// Returns whether the chip is ready for a tick.
    pub fn is_ready(&self) -> bool {
        let now = &self.now;
        now.state == State::Idle || now.state == State::Prop && now.event_state == EventState::Wait
    }

    /// Returns the state of the main controller.
    pub const fn state(&self) -> State {
        self.now.state
    }

    /// Returns the outputs' potentials.
    pub const fn output_potentials(&self) -> &[i16; 16] {
        &self.now.outputs
    }

    /// Returns whether a tick came too early since the last reset: before the previous step was done.
    pub const fn timing_error(&self) -> bool {
        self.now.timing_error
    }

    fn leaks(&self, word: u128, pair: u8) -> (u32, i16) {
        let high =
            if self.register(65 + usize::from(pair >> 5)) >> (pair & 31) & 1 == 1 { 8 } else { 7 };
        (high << 12 | (word >> 116) as u32, (word >> 100) as i16)
    }

    fn is_learning(&self) -> bool {
        self.register(9) != 0 && (self.now.target_valid[1] || self.register(19) >> 1 == 3)
    }

    fn next_state(&self, tick: bool, target_done: bool, send_done: bool) -> State {
        let now = &self.now;
        let target_or_learn = || {
            if self.flag(26) && now.has_label { State::Learn } else { State::GetTarget }
        };
        let after = || {
            if self.is_learning() {
                target_or_learn()
            } else if self.flag(30) {
                State::Send
            } else {
                State::Prop
            }
        };
        let sample = now.sample[1];
        match now.state {
            State::Idle if sample && tick => State::Prop,
            State::Prop if tick => State::Step,
            State::Step if now.step_count == self.last_stepped() => State::StepDone,
            State::StepDone if !sample => State::Send,
            State::StepDone if self.flag(0) => State::Config,
            State::StepDone => after(),
            State::GetTarget if target_done => State::Learn,
            State::Config if !self.flag(0) => after(),
            State::Learn if self.learns_last() && self.flag(30) => State::Send,
            State::Learn if self.learns_last() && sample => State::Prop,
            State::Send if send_done && self.flag(30) && sample => State::Prop,
            State::Send if send_done => State::Idle,
            state => state,
        }
    }

    /// Returns the largest of three numbers: those of the last neuron, the last input and the last output. In each time
    /// step, the counter `step_count` runs from 0 to the returned number.
    fn last_stepped(&self) -> u8 {
        self.last_neuron().max(self.last_input()).max(self.last_output())
    }

    pub(super) fn last_source(&self) -> u8 {
        self.last_neuron().max(self.last_input())
    }

    fn next_event(&self, next: State, is_event: bool, is_beyond: bool) -> EventState {
        let now = &self.now;
        let is_last = now.event_count == self.last_source();
        let after = || if is_last { EventState::Wait } else { EventState::Count };
        match now.event_state {
            EventState::Wait if now.state != State::Prop && next == State::Prop => {
                EventState::Count
            }
            EventState::Count if is_event => EventState::Event,
            EventState::Count => after(),
            EventState::Event if now.pair_count == self.last_neuron() | 1 => {
                if is_beyond {
                    EventState::Trace
                } else {
                    after()
                }
            }
            EventState::Trace if now.is_trace_cycle => after(),
            state => state,
        }
    }

    #[allow(clippy::too_many_lines, reason = "a clock is one thing")]
    fn clock(&mut self) {
        let now = self.now;
        let mut new = now;
        let pins = self.inputs;
        let is_reset = now.resets[1];
        new.resets = [pins.reset, now.resets[0]];

        let tick = if self.flag(10) {
            now.tick_count == self.register(64)
        } else {
            now.tick[1] && !now.tick[2]
        };
        let prog = now.writing[1] & !now.writing[2];
        let reading = now.reading[1];
        let (eprop, force) = (self.register(9), self.flag(33));

        // The handshakes of targets and of answers.
        let target_comes = !now.acknowledge && pins.is_target && now.request[1];
        let event_comes = !now.acknowledge && !pins.is_target && now.request[1];
        let is_last_target =
            now.target_count >> 1 == self.last_output() && now.target_count & 1 == 1;
        let target_done = target_comes && (!self.flag(25) || is_last_target);
        let send_last = if self.flag(31) { 0 } else { self.last_output() << 1 | 1 };
        let send_done =
            now.output_acknowledge[1] && now.output_request && now.send_count == send_last;

        // The controllers' next states.
        let input_event = has(&now.inputs, now.event_count);
        let spike = has(&now.fired, now.event_count);
        let is_beyond =
            input_event && now.event_count > self.last_neuron() && (eprop & 1 == 1 || force);
        let next = self.next_state(tick, target_done, send_done);
        let next_event = self.next_event(next, input_event || spike, is_beyond);
        let to_idle = now.state != State::Idle && next == State::Idle;

        // The pair of neurons that this clock cycle accesses.
        let pair_at = match now.event_state {
            EventState::Event => now.pair_count >> 1,
            EventState::Trace => now.event_count >> 1,
            _ => now.step_count >> 1,
        };
        let dirty = [0, 1].map(|n| has(&now.dirty, pair_at << 1 | n));
        let pair = pair_of(now.neuron_word, dirty);
        let (alpha, threshold) = self.leaks(now.neuron_word, pair_at);
        let is_step = now.state == State::Step;
        let is_odd_step = now.step_count & 1 == 1;
        let selects = matches!(now.event_state, EventState::Event | EventState::Trace) || is_step;
        let writes = now.pair_count & 1 == 1 || now.is_trace_cycle || is_odd_step;

        // The neurons' potentials and traces.
        let is_own = pair_at == now.event_count >> 1;
        let is_in_event = now.event_state == EventState::Event;
        let traces = [
            (is_in_event || now.event_state == EventState::Trace)
                && input_event
                && is_own
                && (eprop & 1 == 1 || force),
            is_in_event && spike && is_own && (eprop >> 1 & 1 == 1 || force),
            is_in_event && spike && is_own && (eprop >> 2 & 1 == 1 || force),
        ];
        let is_rounding = self.flag(21);
        let kappa = self.register(69);
        let noise = if self.flag(32) { now.noise.word() } else { 0 };
        let mut fires = [false; 2];
        let (mut data, mut mask) = (0_u128, 0_u128);
        for n in 0..2 {
            let lane = u32::from(now.pair_count >> 1 & 7) * 2 + n as u32;
            let weight = |is: bool, weights, register| {
                let is = is && now.pair_count & 1 == 1;
                if is { shifted(weights, lane, self.register(register)) } else { 0 }
            };
            let input = weight(input_event, now.input_weights, 12);
            let recurrent = weight(spike, now.recurrent_weights, 13);
            let drive = add(recurrent, input, 0);
            let noise = (noise >> (16 * n)) as i16 >> self.register(104);
            let noise = if self.flag(32) { noise } else { 0 };
            let driven = add(pair.potential[n], drive, noise);

            let mut stepped = 0;
            if is_step && is_odd_step {
                let product = i32::from(pair.potential[n]).wrapping_mul(alpha as i32);
                let up = is_rounding
                    && alpha != 0x8000
                    && product as u32 & 0x7FFF >= now.rounding[n].word()
                    && product as u32 >> 15 & 0xFFFF != 0;
                let leaked = ((product >> 15) as i16).wrapping_add(i16::from(up));
                fires[n] = pair.potential[n] >= threshold;
                stepped = match (fires[n], self.flag(8)) {
                    (false, _) => leaked,
                    (true, false) => leaked.wrapping_sub(threshold),
                    (true, true) => 0,
                };
            }
            let is_here = now.event_count & 1 == n as u8;
            let trace = |at: usize,
                         old: u16,
                         grows: u32,
                         bits: u32,
                         factor: u32,
                         digits: u32,
                         random: u32| {
                let most = (1_u32 << bits) - 1;
                let old = u32::from(old);
                if traces[at] && is_here {
                    let more = (old + grows) & most;
                    return if more < old { most } else { more };
                }
                if !is_step {
                    return old;
                }
                let product = old * factor;
                let whole = product >> digits & most;
                let part = product & ((1 << digits) - 1);
                // Rounds up at random: more often, the larger the bits that are dropped. A whole part of 0 is not
                // rounded up.
                let up = is_rounding && factor != 1 << digits && part >= random && whole != 0;
                (whole + u32::from(up)) & most
            };
            let random = |lfsr: &Lfsr| if is_rounding && is_step { lfsr.word() } else { 0 };
            let input_trace = trace(
                0,
                pair.input_trace[n],
                8 << self.register(15) & 0xFFF,
                12,
                alpha,
                15,
                random(&now.input_trace_rounding[n]),
            );
            let recurrent_trace = trace(
                1,
                pair.recurrent_trace[n],
                8 << self.register(16) & 0xFFF,
                12,
                alpha,
                15,
                random(&now.recurrent_trace_rounding[n]),
            );
            let output_trace = trace(
                2,
                pair.output_trace[n],
                2 << self.register(17) & 0x3FF,
                10,
                kappa,
                7,
                random(&now.output_trace_rounding[n]),
            );
            let potential = if is_in_event { driven } else { stepped };
            let own = u128::from(potential as u16)
                | u128::from(input_trace) << 16
                | u128::from(recurrent_trace) << 28
                | u128::from(output_trace) << 40;
            let changes = |at: usize| writes && (traces[at] && is_here || !dirty[n] || is_odd_step);
            let own_mask = (u128::from(writes && !now.is_trace_cycle) * 0xFFFF)
                | (u128::from(changes(0)) * (0xFFF << 16))
                | (u128::from(changes(1)) * (0xFFF << 28))
                | (u128::from(changes(2)) * (0x3FF << 40));
            data |= own << (50 * n);
            mask |= own_mask << (50 * n);
        }

        // Learning: the changes of weights.
        let learning = learn::Learning::new(self, &pair);
        learning.clock(self, &mut new, next);

        // The accesses to the memories.
        let (address, word) = (self.spi.address, self.spi.data);
        let is_learn = now.state == State::Learn;
        let neuron_access = if prog & spi::PROG_NEURON != 0 {
            Some(Access {
                address: usize::from(address >> 2 & 0x7F),
                write: Some(part(address, word)),
            })
        } else if reading & 1 != 0 {
            Some(Access { address: usize::from(address >> 2 & 0x7F), write: None })
        } else {
            let (is, at) = if is_learn { learning.neuron() } else { (selects, pair_at) };
            is.then(|| Access { address: at.into(), write: writes.then_some((data, mask)) })
        };
        let neuron_write = neuron_access
            .as_ref()
            .filter(|access| access.write.is_some())
            .map(|access| access.address);
        let weights = |bits: (u16, u8),
                       most: u16,
                       learnt: Option<(usize, Option<(u128, u128)>)>,
                       driven: Option<usize>| {
            let at = usize::from(address >> 2 & most);
            if prog & bits.0 != 0 {
                Some(Access { address: at, write: Some(part(address, word)) })
            } else if reading & bits.1 != 0 {
                Some(Access { address: at, write: None })
            } else if is_learn {
                learnt.map(|(address, write)| Access { address, write })
            } else {
                driven.map(|address| Access { address, write: None })
            }
        };
        let row = usize::from(now.event_count) << 4 | usize::from(now.pair_count >> 4);
        let row = (is_in_event && now.pair_count & 15 == 0).then_some(row);
        let output_row =
            (now.event_state == EventState::Count && next_event == EventState::Event && spike)
                .then_some(now.event_count.into());
        let input_access = weights(
            (spi::PROG_INPUT_WEIGHTS, 1 << 2),
            0xFFF,
            learning.input_weights,
            row.filter(|_| input_event),
        );
        let recurrent_access = weights(
            (spi::PROG_RECURRENT_WEIGHTS, 1 << 3),
            0xFFF,
            learning.recurrent_weights,
            row.filter(|_| spike),
        );
        let output_access =
            weights((spi::PROG_OUTPUT_WEIGHTS, 1 << 4), 0x1FF, learning.output_weights, output_row);
        if let Some(Access { address, write }) = neuron_access {
            new.neuron_word = self.neurons[address];
            if let Some(write) = write {
                self.neurons[address] = changed(new.neuron_word, write);
            }
        }
        access(&mut self.input_weights, &mut new.input_weights, input_access.as_ref());
        access(&mut self.recurrent_weights, &mut new.recurrent_weights, recurrent_access.as_ref());
        access(&mut self.output_weights, &mut new.output_weights, output_access.as_ref());

        // The handshake of the input bus.
        if event_comes || target_comes {
            new.acknowledge = true;
        } else if now.acknowledge && !now.request[1] {
            new.acknowledge = false;
        }
        let ends_event = selects
            && writes
            && matches!(now.event_state, EventState::Event | EventState::Trace)
            && matches!(next_event, EventState::Count | EventState::Wait);
        if is_reset || to_idle {
            (new.inputs, new.next_inputs) = ([0; 4], [0; 4]);
        } else if tick {
            (new.inputs, new.next_inputs) = (now.next_inputs, [0; 4]);
        } else {
            if event_comes {
                put(&mut new.next_inputs, pins.address, true);
            }
            if ends_event && !(event_comes && pins.address == now.event_count) {
                put(&mut new.inputs, now.event_count, false);
            }
        }
        if event_comes && !is_reset {
            self.taken.push(pins.address);
        }

        // The targets received so far.
        if now.state == State::Idle || now.state == State::GetTarget && next != State::GetTarget {
            new.target_count = 0;
        } else if target_comes {
            new.target_count = (now.target_count + 1) & 31;
        }
        if target_comes && self.flag(25) {
            let target = &mut new.targets[usize::from(now.target_count >> 1)];
            let [low, high] = target.to_le_bytes();
            *target = i16::from_le_bytes(if now.target_count & 1 == 1 {
                [low, pins.address]
            } else {
                [pins.address, high]
            });
        }
        if target_comes && !self.flag(25) {
            new.label = pins.address & 15;
        }
        if now.state == State::Idle {
            new.has_label = false;
        } else if target_comes && !self.flag(25) {
            new.has_label = true;
        }

        // The handshake of the output bus, and the bytes of the answer.
        if now.state == State::Idle {
            (new.output_request, new.output, new.send_count) = (false, 0, 0);
        } else if now.state == State::Send && next != State::Send {
            (new.output_request, new.send_count) = (false, 0);
        } else if now.state == State::Send && now.send_count <= send_last {
            match (now.output_acknowledge[1], now.output_request) {
                (false, false) => {
                    new.output_request = true;
                    let value = now.outputs[usize::from(now.send_count >> 1)];
                    let [low, high] = value.to_le_bytes();
                    new.output = match (self.flag(31), now.send_count & 1) {
                        (true, _) => self.sent_winner(),
                        (_, 0) => low,
                        _ => high,
                    };
                }
                (true, true) => {
                    new.output_request = false;
                    new.send_count = (now.send_count + 1) & 31;
                }
                _ => {}
            }
        }

        // Counters of steps and events.
        let error = tick
            && (!matches!(now.state, State::Idle | State::Prop)
                || now.state == State::Prop && now.event_state != EventState::Wait);
        new.timing_error |= error;
        new.state = if self.flag(11) && now.timing_error { State::Idle } else { next };
        new.event_state = next_event;
        let counts_ticks =
            self.flag(10) && now.state != State::Idle && now.tick_count != self.register(64);
        new.tick_count = if counts_ticks { now.tick_count.wrapping_add(1) } else { 1 };
        if next != State::Step {
            new.step_count = 0;
        } else if is_step {
            new.step_count = now.step_count.wrapping_add(1);
        }
        new.output_weights_come = output_row.is_some();
        new.is_trace_cycle = now.event_state == EventState::Trace;
        if next_event != EventState::Event {
            new.pair_count = 0;
        } else if is_in_event {
            new.pair_count = now.pair_count.wrapping_add(1);
        }
        if now.event_state == EventState::Wait {
            new.event_count = 0;
        } else if next_event == EventState::Count {
            new.event_count = now.event_count.wrapping_add(1);
        }

        // The neurons that fired, and those whose state was updated since the sample began.
        let flags = prog & spi::PROG_NEURON != 0 && address >> 9 & 1 == 1;
        if is_reset || to_idle {
            (new.fired, new.dirty) = ([0; 4], [0; 4]);
        } else {
            if ends_event {
                put(&mut new.fired, now.event_count, false);
            }
            if is_step {
                for n in [0, 1] {
                    let neuron = now.step_count & 0xFE | n;
                    put(&mut new.fired, neuron, fires[usize::from(n)]);
                    if fires[usize::from(n)] {
                        self.fired.push(neuron);
                    }
                }
            }
            if let Some(pair) = neuron_write {
                put(&mut new.dirty, (pair as u8) << 1, true);
                put(&mut new.dirty, (pair as u8) << 1 | 1, true);
            }
            if flags {
                put(&mut new.fired, address as u8, word & 1 == 1);
                put(&mut new.dirty, address as u8, word >> 1 & 1 == 1);
            }
        }

        // The potentials of the outputs.
        if is_reset || to_idle {
            new.outputs = [0; 16];
        } else {
            for k in 0..16_u8 {
                let at = usize::from(k);
                let old = now.outputs[at];
                if prog & spi::PROG_OUTPUT != 0 && k == address as u8 & 15 {
                    new.outputs[at] = word as i16;
                } else if k > self.last_output() {
                } else if now.output_weights_come {
                    let weight = shifted(now.output_weights, k.into(), self.register(14));
                    new.outputs[at] = add(old, weight, 0);
                } else if is_step && now.step_count == k {
                    let product = i32::from(old) * kappa as i32;
                    let up = is_rounding
                        && kappa != 0x80
                        && product as u32 & 0x7F >= now.output_rounding.word()
                        && product as u32 >> 7 & 0xFFFF != 0;
                    new.outputs[at] = ((product >> 7) as i16).wrapping_add(i16::from(up));
                }
            }
        }

        // The number of steps that each output has won.
        if now.state == State::Idle {
            new.winners = [0; 16];
        } else if now.infer[1] && now.state == State::StepDone {
            let winner =
                if self.flag(25) { 0 } else { first_most(&now.outputs, self.last_output()) };
            let count = &mut new.winners[usize::from(winner)];
            *count = count.wrapping_add(1);
        }

        // The word that SPI reads.
        let shift = u32::from(address & 3) * 32;
        let read = |memory: u128| (memory >> shift) as u32;
        if reading & 1 != 0 {
            new.read = read(now.neuron_word);
        } else if reading & 2 != 0 {
            new.read = u32::from(now.outputs[usize::from(address & 15)] as u16);
        } else if reading & 4 != 0 {
            new.read = read(now.input_weights);
        } else if reading & 8 != 0 {
            new.read = read(now.recurrent_weights);
        } else if reading & 16 != 0 {
            new.read = read(now.output_weights);
        }

        self.random(&mut new, prog, alpha, learning.draws);
        self.synchronise(&mut new);
        self.now = new;
    }

    /// Advances the random generators that the chip uses in this clock cycle. During a reset, sets all generators to
    /// their initial states. If a seed is written, sets the generator of this seed; `prog` has one flag for each seed.
    /// `alpha` is the factor by which a step multiplies a neuron's potential, in units of 1/32 768. `draws` selects the
    /// generators that learning uses.
    fn random(&self, new: &mut Clocked, prog: u16, alpha: u32, draws: [bool; 3]) {
        let now = &self.now;
        let is_reset = now.resets[1];
        let clock = |lfsr: &mut Lfsr, reset: u32, seed: usize, lane: u32, steps: bool| {
            if is_reset {
                lfsr.set(reset);
            } else if prog & spi::PROG_SEED << (seed - 85) != 0 {
                lfsr.set(self.register(seed) >> (15 * lane));
            } else if steps {
                lfsr.step();
            }
        };
        let is_step = now.state == State::Step;
        let rounds = self.flag(21) && is_step;
        let is_odd = rounds && now.step_count & 1 == 1;
        let [input, recurrent, output] = draws;
        clock(&mut new.input_random, 1, 85, 0, input);
        clock(&mut new.recurrent_random, 0x0042_4242, 86, 0, recurrent);
        clock(&mut new.output_random, 1, 87, 0, output);
        let is_noise = self.flag(32) && now.state == State::Prop && now.pair_count & 1 == 1;
        clock(&mut new.noise, 0x1_F0F1, 93, 0, is_noise);
        let leaks = self.register(69) != 0x80;
        clock(&mut new.output_rounding, 0x7ABA, 89, 0, rounds && leaks && now.step_count < 16);
        for (n, [neuron, input, recurrent, output]) in
            [[0x1234, 0x1348, 0x4321, 0x3FF3], [0x70F0, 0x7FCF, 0x7BEA, 0x7EF0]]
                .into_iter()
                .enumerate()
        {
            let lane = n as u32;
            clock(&mut new.rounding[n], neuron, 88, lane, is_odd && alpha != 0x8000);
            clock(&mut new.input_trace_rounding[n], input, 90, lane, is_odd);
            clock(&mut new.recurrent_trace_rounding[n], recurrent, 91, lane, is_odd);
            clock(&mut new.output_trace_rounding[n], output, 92, lane, is_odd);
        }
    }

    /// Advances the synchronisers, which take over the levels of the pins. During a reset, clears the synchronisers and
    /// the states of the controllers.
    fn synchronise(&self, new: &mut Clocked) {
        let (now, pins) = (&self.now, &self.inputs);
        let shift = |bits: [bool; 2], pin| [pin, bits[0]];
        if self.register(9) != 0 {
            new.target_valid = shift(now.target_valid, pins.target_valid);
        }
        new.request = shift(now.request, pins.request);
        new.sample = shift(now.sample, pins.sample);
        new.infer = shift(now.infer, pins.infer);
        new.output_acknowledge = shift(now.output_acknowledge, pins.output_acknowledge);
        if self.flag(0) {
            new.writing = [self.spi.writing, now.writing[0], now.writing[1]];
            new.reading = [self.spi.reading, now.reading[0]];
        }
        if !self.flag(10) {
            new.tick = [pins.tick, now.tick[0], now.tick[1]];
        }
        if now.resets[1] || new.resets[1] {
            new.target_valid = [false; 2];
            (new.request, new.sample, new.infer) = ([false; 2], [false; 2], [false; 2]);
            new.output_acknowledge = [false; 2];
            (new.writing, new.reading, new.tick) = ([0; 3], [0; 2], [false; 3]);
            (new.acknowledge, new.timing_error) = (false, false);
            (new.state, new.event_state) = (State::Idle, EventState::Wait);
        }
    }

    fn sent_winner(&self) -> u8 {
        if self.flag(25) {
            return 0;
        }
        let winners = self.now.winners.map(i32::from);
        first_most(&winners, self.last_output())
    }
}

/// Returns the index of the first of the largest values among `values[..=last]`.
fn first_most<T: PartialOrd>(values: &[T; 16], last: u8) -> u8 {
    (0..=last).fold(
        0,
        |most, at| {
            if values[usize::from(at)] > values[usize::from(most)] { at } else { most }
        },
    )
}

fn pair_of(word: u128, dirty: [bool; 2]) -> Pair {
    let mut pair = Pair::default();
    for (n, _) in dirty.iter().enumerate().filter(|(_, dirty)| **dirty) {
        let own = word >> (50 * n);
        pair.potential[n] = own as i16;
        pair.input_trace[n] = (own >> 16) as u16 & 0xFFF;
        pair.recurrent_trace[n] = (own >> 28) as u16 & 0xFFF;
        pair.output_trace[n] = (own >> 40) as u16 & 0x3FF;
    }
    pair
}
