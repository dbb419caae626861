//! tinyODIN and ODIN: golden bytes and words, and a model of the chip's state machine with every trap.

#![allow(
    clippy::struct_excessive_bools,
    clippy::verbose_bit_mask,
    reason = "the model is written like the RTL"
)]

mod bus;

use std::cell::RefCell;
use std::collections::VecDeque;
use std::num::NonZeroU32;
use std::rc::Rc;

use bus::Failing;
use embedded_hal::spi::{ErrorKind, Operation, SpiDevice};
use embedded_hal_mock::eh1::delay::NoopDelay;
use embedded_hal_mock::eh1::spi::{Mock, Transaction};
use proptest::prelude::*;
use spikewire::chip::{AerPort, ChipError, Input, Odin, OdinInput, Phase, TinyOdin, TinyOdinInput};
use spikewire::population::Position;
use spikewire::{Bank, Event, FromEvents, Polarity, Readout, Scheme, Tick};

type Word = Result<u32, ChipError<(), ()>>;

#[test]
fn tiny_odin_words_are_golden() {
    use TinyOdinInput::{Leak, LeakAll, Spike, Virtual};
    for (input, word) in [
        (Spike { pre: 7 }, 0x007),
        (Virtual { neuron: 5, weight: 2 }, 0x225),
        (Virtual { neuron: 15, weight: -8 }, 0x28F),
        (Virtual { neuron: 0, weight: -1 }, 0x2F0),
        (Leak { neuron: 254 }, 0x1FE),
        (LeakAll, 0x1FF),
    ] {
        let got: Word = input.word();
        assert_eq!(got, Ok(word), "{input:?}");
    }
    let zero: Word = Virtual { neuron: 5, weight: 0 }.word();
    assert_eq!(zero, Err(ChipError::ZeroWeight));
    for input in [
        Virtual { neuron: 16, weight: 1 },
        Virtual { neuron: 0, weight: 8 },
        Virtual { neuron: 0, weight: -9 },
        Leak { neuron: 255 },
    ] {
        let got: Word = input.word();
        assert!(matches!(got, Err(ChipError::OutOfRange { .. })), "{input:?}");
    }
}

#[test]
fn odin_words_are_those_of_the_documentation() {
    use OdinInput::{
        Bistability, BistabilityAll, Leak, LeakAll, Spike, Synapse, Virtual, VirtualLeak,
    };
    for (input, word) in [
        (Synapse { pre: 0xAB, post: 0xCD }, 0x1_ABCD),
        (Spike { pre: 0xAB }, 0x0_AB07),
        (Virtual { neuron: 3, weight: 5, is_inhibitory: false }, 0x0_03A1),
        (Virtual { neuron: 3, weight: 5, is_inhibitory: true }, 0x0_03B1),
        (VirtualLeak { neuron: 3 }, 0x0_0309),
        (Leak { neuron: 3 }, 0x0_03FF),
        (LeakAll, 0x0_007F),
        (Bistability { neuron: 3 }, 0x0_0380),
        (BistabilityAll, 0),
    ] {
        let got: Word = input.word();
        assert_eq!(got, Ok(word), "{input:?}");
    }
    let zero: Word = Virtual { neuron: 3, weight: 0, is_inhibitory: true }.word();
    assert_eq!(zero, Err(ChipError::ZeroWeight));
    let wide: Word = Virtual { neuron: 3, weight: 8, is_inhibitory: true }.word();
    assert!(matches!(wide, Err(ChipError::OutOfRange { what: "weight", .. })));
}

/// A port on which nothing happens.
#[derive(Debug, Default)]
struct Silent {
    acknowledge: bool,
}

impl AerPort for Silent {
    type Error = ();

    fn set_input(&mut self, _: u32) -> Result<(), ()> {
        Ok(())
    }
    fn set_input_request(&mut self, _: bool) -> Result<(), ()> {
        Ok(())
    }
    fn input_acknowledge(&mut self) -> Result<bool, ()> {
        Ok(self.acknowledge)
    }
    fn output_request(&mut self) -> Result<bool, ()> {
        Ok(false)
    }
    fn output(&mut self) -> Result<u8, ()> {
        Ok(0)
    }
    fn set_output_acknowledge(&mut self, _: bool) -> Result<(), ()> {
        Ok(())
    }
    fn set_reset(&mut self, _: bool) -> Result<(), ()> {
        Ok(())
    }
}

fn write(bytes: [u8; 5]) -> [Transaction<u8>; 3] {
    [
        Transaction::transaction_start(),
        Transaction::write_vec(bytes.to_vec()),
        Transaction::transaction_end(),
    ]
}

fn read(bytes: [u8; 5], back: u8) -> [Transaction<u8>; 3] {
    [
        Transaction::transaction_start(),
        Transaction::transfer_in_place(bytes.to_vec(), vec![0, 0, 0, 0, back]),
        Transaction::transaction_end(),
    ]
}

const GATE: [u8; 5] = [0, 0, 0, 0, 1];

#[test]
fn the_bytes_on_the_bus_are_golden() {
    let expected = [
        write(GATE),
        write([0x00, 0x00, 0x30, 0x00, 0x20]),
        write([0x50, 0x10, 0x50, 0x00, 0x30]),
        read([0x90, 0x10, 0x50, 0x00, 0x00], 0x30),
        write([0x64, 0x0E, 0x00, 0x0F, 0x30]),
        read([0xA4, 0x0E, 0x00, 0x00, 0x00], 0x3C),
        write([0x64, 0x0E, 0x00, 0xF0, 0x03]), // the even neighbour, 4
        write([0, 0, 0, 0, 0]),
    ]
    .concat();
    let mut chip = TinyOdin::new(Mock::new(&expected), Silent::default(), 3);
    chip.reset(&mut NoopDelay).unwrap();
    chip.gate().unwrap();
    chip.configure(3, 32).unwrap();
    chip.write_neuron(5, 1, 0x30).unwrap();
    assert_eq!(chip.read_neuron(5, 1), Ok(0x30));
    chip.write_synapse(7, 5, 3).unwrap();
    assert_eq!(chip.read_synapse(7, 5), Ok(3));
    chip.write_synapse(7, 4, 3).unwrap();
    chip.run().unwrap();
    chip.release().0.done();
}

#[test]
fn what_is_out_of_order_or_range_is_refused_without_a_byte() {
    let mut chip =
        TinyOdin::new(Mock::new(&[write(GATE), write([0; 5])].concat()), Silent::default(), 3);
    assert_eq!(chip.gate(), Err(ChipError::NotReset));
    assert_eq!(chip.send(TinyOdinInput::LeakAll, drop), Err(ChipError::NotReset));
    chip.reset(&mut NoopDelay).unwrap();
    assert_eq!(chip.read_neuron(0, 0), Err(ChipError::NotGated));
    assert_eq!(chip.send(TinyOdinInput::LeakAll, drop), Err(ChipError::Gated));
    chip.gate().unwrap();
    assert_eq!(chip.send(TinyOdinInput::LeakAll, drop), Err(ChipError::Gated));
    assert!(matches!(chip.write_neuron(0, 4, 0), Err(ChipError::OutOfRange { max: 3, .. })));
    assert!(matches!(chip.write_synapse(0, 0, 16), Err(ChipError::OutOfRange { max: 15, .. })));
    assert!(matches!(chip.configure(3, 1 << 20), Err(ChipError::OutOfRange { .. })));
    assert!(matches!(chip.configure(0, 0), Err(ChipError::OutOfRange { .. })));
    chip.run().unwrap();
    assert_eq!(chip.write_synapse(0, 0, 1), Err(ChipError::NotGated));
    assert_eq!(chip.configure(3, 1), Err(ChipError::NotGated));
    chip.release().0.done();
}

#[test]
fn an_error_at_every_transfer_asks_for_a_reset() {
    let program = |chip: &mut TinyOdin<Failing<Mock<u8>>, Silent>| {
        chip.gate()?;
        chip.configure(3, 32)?;
        chip.program_neuron(5, 1, 0x30)?;
        chip.program_synapse(7, 5, 3)?;
        chip.run()
    };
    let all = [
        write(GATE),
        write([0x00, 0x00, 0x30, 0x00, 0x20]),
        write([0x50, 0x10, 0x50, 0x00, 0x30]),
        read([0x90, 0x10, 0x50, 0x00, 0x00], 0x30),
        write([0x64, 0x0E, 0x00, 0x0F, 0x30]),
        read([0xA4, 0x0E, 0x00, 0x00, 0x00], 0x30),
        write([0; 5]),
    ];
    for index in 0..all.len() {
        let expected = [all[..index].concat(), all.concat()].concat();
        let bus = Failing { device: Mock::new(&expected), left: index };
        let mut chip = TinyOdin::new(bus, Silent::default(), 3);
        chip.reset(&mut NoopDelay).unwrap();
        assert_eq!(program(&mut chip), Err(ChipError::Bus(ErrorKind::Other)), "{index}");
        assert_eq!(chip.gate(), Err(ChipError::NotReset));
        chip.reset(&mut NoopDelay).unwrap();
        assert_eq!(program(&mut chip), Ok(()));
        assert_eq!(chip.resets(), 2);
        chip.release().0.device.done();
    }
}

#[test]
fn a_silent_chip_times_out_in_every_phase() {
    let expected = write([0; 5]);
    let mut chip = TinyOdin::new(Mock::new(&expected), Silent { acknowledge: true }, 3);
    chip.reset(&mut NoopDelay).unwrap();
    chip.run().unwrap();
    let spike = TinyOdinInput::Spike { pre: 1 };
    assert_eq!(chip.send(spike, drop), Err(ChipError::Handshake(Phase::Idle)));
    chip.release().0.done();

    let mut chip = TinyOdin::new(Mock::new(&expected), Silent { acknowledge: false }, 3);
    chip.reset(&mut NoopDelay).unwrap();
    chip.run().unwrap();
    assert_eq!(chip.send(spike, drop), Err(ChipError::Handshake(Phase::Acknowledge)));
    chip.release().0.done();
}

/// tinyODIN, clock by clock, after its controller, scheduler, output and SPI slave. Neurons `n` below
/// `firing` fire whenever the spike of neuron `n` is worked off.
#[derive(Debug, Default)]
struct Chip {
    // SPI, bit by bit.
    bits: u64,
    count: u32,
    gate: bool,
    max_neuron: u8,
    neurons: Vec<[u8; 4]>,
    synapses: Vec<u8>,
    /// Bits that the chip misses, as many as this.
    lost_clocks: u32,
    // Buses.
    reset: bool,
    request: [bool; 3],
    word: u32,
    output_acknowledge: [bool; 3],
    output_request: bool,
    output: u8,
    acknowledge: bool,
    state: State,
    fifo: VecDeque<u32>,
    firing: u8,
    /// What the chip took in, and what it fired.
    taken: Vec<u32>,
    fired: Vec<u8>,
}

#[derive(Debug, Default, Clone, Copy, PartialEq)]
enum State {
    #[default]
    Wait,
    Busy(u32),
    /// Reads the word for as long as it lasts, as the chip does.
    Leak(u32),
    RequestDown,
}

impl Chip {
    fn new(firing: u8) -> Rc<RefCell<Self>> {
        Rc::new(RefCell::new(Self {
            gate: true, // no reset value: the worst
            neurons: vec![[0; 4]; 256],
            synapses: vec![0; 1 << 15],
            firing,
            ..Self::default()
        }))
    }

    /// A clock with our wires at these levels.
    fn step(&mut self, request: bool, output_acknowledge: bool) {
        if self.reset {
            self.state = State::Wait;
            self.fifo.clear();
            self.output_request = false;
            self.acknowledge = false;
            self.count = 0;
            return;
        }
        self.request = [request, self.request[0], self.request[1]];
        self.output_acknowledge =
            [output_acknowledge, self.output_acknowledge[0], self.output_acknowledge[1]];
        let (request, acknowledged) = (self.request[2], self.output_acknowledge[2]);
        if self.output_request && acknowledged {
            self.output_request = false;
        }
        let is_output_busy = self.output_request || acknowledged;
        match self.state {
            State::Wait if is_output_busy || self.gate => {}
            State::Wait if self.fifo.len() < 128 && request => {
                if self.word >> 8 == 1 {
                    self.state = State::Leak(0);
                } else {
                    self.fifo.push_back(self.word);
                    self.take();
                }
            }
            State::Wait => {
                if let Some(word) = self.fifo.pop_front() {
                    // A virtual event of weight 0 is popped as a spike.
                    let is_spike = word >> 9 == 0 || word >> 4 & 0xF == 0;
                    if is_spike && (word as u8) < self.firing {
                        self.output = word as u8;
                        self.output_request = true;
                        self.fired.push(self.output);
                    }
                    self.state = State::Busy(if is_spike { self.all_neurons() } else { 2 });
                }
            }
            State::Busy(0) => self.state = State::Wait,
            State::Busy(left) => self.state = State::Busy(left - 1),
            State::Leak(clock) => {
                let is_for_all = self.word as u8 == 0xFF;
                if clock == if is_for_all { self.all_neurons() } else { 1 } {
                    self.take();
                } else {
                    self.state = State::Leak(clock + 1); // for good, if the word is another now
                }
            }
            State::RequestDown if !request => self.state = State::Wait,
            State::RequestDown => {}
        }
        self.acknowledge = self.state == State::RequestDown;
    }

    fn take(&mut self) {
        self.taken.push(self.word);
        self.state = State::RequestDown;
    }

    /// The last of two clocks each.
    fn all_neurons(&self) -> u32 {
        2 * u32::from(self.max_neuron) + 1
    }

    /// A bit in, a bit out.
    fn shift(&mut self, bit: bool) -> bool {
        if self.lost_clocks > 0 {
            self.lost_clocks -= 1;
            return false;
        }
        let mut out = false;
        if self.count >= 32 && self.bits >> (self.count - 1) & 1 == 1 {
            let address = (self.bits >> (self.count - 20)) as u32;
            let place = 39 - self.count;
            out = self.memory(address).is_some_and(|byte| *byte >> place & 1 == 1);
        }
        self.bits = self.bits << 1 | u64::from(bit);
        self.count += 1;
        if self.count == 40 {
            self.frame();
            (self.bits, self.count) = (0, 0);
        }
        out
    }

    fn memory(&mut self, address: u32) -> Option<&mut u8> {
        let neuron = address as usize & 0xFF;
        let byte = address as usize >> 8 & 3;
        match address >> 16 & 3 {
            1 => self.neurons[neuron].get_mut(byte),
            2 => {
                self.synapses.get_mut((address as usize & 0x1FFF) << 2 | address as usize >> 13 & 3)
            }
            _ => None,
        }
    }

    fn frame(&mut self) {
        let (address, data) = ((self.bits >> 20) as u32, self.bits as u32 & 0xF_FFFF);
        match address >> 16 & 3 {
            0 if address & 0xFFFF == 0 => self.gate = data & 1 == 1,
            0 if address & 0xFFFF == 3 => self.max_neuron = data as u8,
            0 => {}
            _ if address >> 18 & 3 == 1 && self.gate => {
                let (keep, byte) = ((data >> 8) as u8, data as u8);
                if let Some(cell) = self.memory(address) {
                    *cell = *cell & keep | byte & !keep;
                }
            }
            _ => {}
        }
    }
}

/// The chip's SPI pins.
struct Spi(Rc<RefCell<Chip>>);

impl embedded_hal::spi::ErrorType for Spi {
    type Error = ErrorKind;
}

impl SpiDevice for Spi {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        let mut chip = self.0.borrow_mut();
        let mut byte = |byte: u8| {
            (0..8).rev().fold(0, |out, bit| out << 1 | u8::from(chip.shift(byte >> bit & 1 == 1)))
        };
        for operation in operations {
            match operation {
                Operation::Write(bytes) => bytes.iter().for_each(|&b| {
                    byte(b);
                }),
                Operation::TransferInPlace(bytes) => {
                    for b in bytes.iter_mut() {
                        *b = byte(*b);
                    }
                }
                _ => panic!("not used"),
            }
        }
        Ok(())
    }
}

/// The chip's parallel pins. Every call takes some of its clocks.
struct Port {
    chip: Rc<RefCell<Chip>>,
    clocks: u32,
    request: bool,
    output_acknowledge: bool,
    /// Fails at this call.
    fails_at: Option<u32>,
    calls: u32,
}

impl Port {
    fn new(chip: &Rc<RefCell<Chip>>, clocks: u32) -> Self {
        Self {
            chip: chip.clone(),
            clocks,
            request: false,
            output_acknowledge: false,
            fails_at: None,
            calls: 0,
        }
    }

    fn call(&mut self) -> Result<std::cell::RefMut<'_, Chip>, u32> {
        self.calls += 1;
        if self.fails_at == Some(self.calls) {
            return Err(self.calls);
        }
        let mut chip = self.chip.borrow_mut();
        for _ in 0..self.clocks {
            chip.step(self.request, self.output_acknowledge);
        }
        Ok(chip)
    }
}

impl AerPort for Port {
    /// The number of the call.
    type Error = u32;

    fn set_input(&mut self, word: u32) -> Result<(), u32> {
        self.call()?.word = word;
        Ok(())
    }
    fn set_input_request(&mut self, is_high: bool) -> Result<(), u32> {
        self.call()?;
        self.request = is_high;
        Ok(())
    }
    fn input_acknowledge(&mut self) -> Result<bool, u32> {
        Ok(self.call()?.acknowledge)
    }
    fn output_request(&mut self) -> Result<bool, u32> {
        Ok(self.call()?.output_request)
    }
    fn output(&mut self) -> Result<u8, u32> {
        Ok(self.call()?.output)
    }
    fn set_output_acknowledge(&mut self, is_high: bool) -> Result<(), u32> {
        self.call()?;
        self.output_acknowledge = is_high;
        Ok(())
    }
    fn set_reset(&mut self, is_high: bool) -> Result<(), u32> {
        self.call()?.reset = is_high;
        self.call().map(|_| ())
    }
}

fn running(model: &Rc<RefCell<Chip>>, clocks: u32) -> TinyOdin<Spi, Port> {
    running_with(model, clocks, TinyOdinInput::MAX_CLOCKS)
}

fn running_with(model: &Rc<RefCell<Chip>>, clocks: u32, polls: u32) -> TinyOdin<Spi, Port> {
    let mut chip = TinyOdin::new(Spi(model.clone()), Port::new(model, clocks), polls);
    chip.reset(&mut NoopDelay).unwrap();
    chip.gate().unwrap();
    chip.configure(3, 255).unwrap();
    chip.run().unwrap();
    chip
}

fn event(tick: u32, address: u16) -> Event {
    let tick = Tick::from(tick);
    Event { tick, address, polarity: Polarity::Up }
}

fn spike(event: Event) -> TinyOdinInput {
    TinyOdinInput::Spike { pre: event.address as u8 }
}

#[test]
fn the_trap_is_there_a_sender_that_does_not_serve_outputs_hangs() {
    let model = Chip::new(255);
    running(&model, 4);
    let mut port = Port::new(&model, 4);
    let mut naive = |word| {
        port.set_input(word).unwrap();
        port.set_input_request(true).unwrap();
        let is_taken = (0..10_000).any(|_| port.input_acknowledge().unwrap());
        port.set_input_request(false).unwrap();
        for _ in 0..100 {
            port.input_acknowledge().unwrap();
        }
        is_taken
    };
    assert!(naive(1));
    assert!(!naive(2), "while the output waits, no input is acknowledged");
}

#[test]
fn a_gated_chip_acknowledges_nothing() {
    let model = Chip::new(0);
    let mut chip = running(&model, 4);
    model.borrow_mut().gate = true;
    let result = chip.send(TinyOdinInput::Spike { pre: 1 }, drop);
    assert_eq!(result, Err(ChipError::Handshake(Phase::Acknowledge)));
    model.borrow_mut().gate = false;
    assert_eq!(chip.send(TinyOdinInput::Spike { pre: 1 }, drop), Ok(()));
}

proptest! {
    #[test]
    fn all_events_go_in_and_all_outputs_come_out(
        addresses in prop::collection::vec(any::<u8>(), 0..300),
        clocks in 1_u32..40,
        firing in any::<u8>(),
    ) {
        let model = Chip::new(firing);
        let mut chip = running(&model, clocks);
        let mut out = Vec::new();
        let events = FromEvents(addresses.iter().map(|&address| event(0, address.into())));
        let sent = chip.feed(events, spike, |neuron| out.push(neuron));
        prop_assert_eq!(sent, Ok(addresses.len() as u32));
        for _ in 0..4_000 {
            chip.poll(|neuron| out.push(neuron)).unwrap();
        }
        let words: Vec<u32> = addresses.iter().map(|&address| address.into()).collect();
        prop_assert_eq!(&model.borrow().taken, &words);
        let fired: Vec<u8> = addresses.iter().copied().filter(|&n| n < firing).collect();
        prop_assert_eq!(&out, &fired);
        prop_assert_eq!(&model.borrow().fired, &fired);
    }

    #[test]
    fn programming_reads_back(
        neurons in prop::collection::vec((any::<u8>(), 0_u8..4, any::<u8>()), 0..50),
        synapses in prop::collection::vec((any::<u8>(), any::<u8>(), 0_u8..16), 0..50),
    ) {
        let model = Chip::new(0);
        let mut chip = running(&model, 1);
        chip.gate().unwrap();
        for &(neuron, byte, value) in &neurons {
            prop_assert_eq!(chip.program_neuron(neuron, byte, value), Ok(()));
            prop_assert_eq!(model.borrow().neurons[usize::from(neuron)][usize::from(byte)], value);
        }
        for &(pre, post, weight) in &synapses {
            prop_assert_eq!(chip.program_synapse(pre, post, weight), Ok(()));
        }
        for (index, &(pre, post, weight)) in synapses.iter().enumerate() {
            if !synapses[index + 1..].iter().any(|&(p, q, _)| (p, q) == (pre, post)) {
                prop_assert_eq!(chip.read_synapse(pre, post), Ok(weight));
            }
        }
    }
}

#[test]
fn a_lost_clock_is_noticed_and_a_reset_brings_it_back() {
    for bit in 1..40 {
        let model = Chip::new(0);
        let mut chip = running(&model, 1);
        chip.gate().unwrap();
        chip.program_neuron(5, 1, 0x30).unwrap();
        model.borrow_mut().lost_clocks = bit;
        let result = chip.program_neuron(6, 1, 0x31);
        assert!(matches!(result, Err(ChipError::ReadBack { written: 0x31, .. })), "{result:?}");
        assert_eq!(chip.gate(), Err(ChipError::NotReset));
        chip.reset(&mut NoopDelay).unwrap();
        chip.gate().unwrap();
        chip.program_neuron(6, 1, 0x31).unwrap();
        assert_eq!(chip.resets(), 2);
    }
}

#[test]
fn an_error_at_every_call_of_the_port_loses_and_repeats_nothing() {
    let addresses: Vec<u16> = vec![1, 2, 200, 3, 201, 4];
    let words: Vec<u32> = addresses.iter().map(|&address| address.into()).collect();
    for index in 1.. {
        let model = Chip::new(100);
        let mut chip = running(&model, 5);
        let mut out = Vec::new();
        let mut events = FromEvents(addresses.iter().map(|&address| event(0, address)));
        let (spi, mut port) = chip.release();
        port.fails_at = Some(port.calls + index + 6); // after reset
        chip = TinyOdin::new(spi, port, 1_000);
        chip.reset(&mut NoopDelay).unwrap();
        chip.run().unwrap();
        let first = chip.feed(&mut events, spike, |neuron| out.push(neuron));
        if first == Ok(addresses.len() as u32) {
            assert!(index > 20);
            return;
        }
        assert!(matches!(first, Err(ChipError::Port(_))), "{first:?}");
        chip.feed(&mut events, spike, |neuron| out.push(neuron)).unwrap();
        for _ in 0..1_000 {
            chip.poll(|neuron| out.push(neuron)).unwrap();
        }
        assert_eq!(model.borrow().taken, words, "call {index}");
        assert_eq!(out, model.borrow().fired, "call {index}");
    }
}

#[test]
fn a_word_that_takes_the_chip_long_is_finished_before_the_next() {
    use TinyOdinInput::{LeakAll, Spike};
    let model = Chip::new(0);
    let mut chip = running_with(&model, 1, 50);
    assert_eq!(chip.send(LeakAll, drop), Err(ChipError::Handshake(Phase::Acknowledge)));
    let not_sent = Err(ChipError::Handshake(Phase::Idle));
    let refused = (0..100).take_while(|_| chip.send(Spike { pre: 4 }, drop) == not_sent).count();
    assert_eq!(model.borrow().taken, [0x1FF, 4]);
    assert!(refused > 0);

    assert_eq!(chip.send(LeakAll, drop), Err(ChipError::Handshake(Phase::Acknowledge)));
    for _ in 0..1_000 {
        chip.poll(drop).unwrap();
    }
    assert_eq!(model.borrow().taken, [0x1FF, 4, 0x1FF], "polling finishes it as well");
    assert_eq!(chip.send(Spike { pre: 5 }, drop), Ok(()));
}

#[test]
fn any_word_is_through_within_the_most_clocks_of_the_chip() {
    let model = Chip::new(0);
    let mut chip = running(&model, 1);
    model.borrow_mut().fifo = (0..129).collect(); // one at work when REQ comes, one before there is room
    assert_eq!(chip.send(TinyOdinInput::LeakAll, drop), Ok(()));
    assert_eq!(model.borrow().taken, [0x1FF]);
}

#[test]
fn an_event_under_way_at_a_reset_is_held_again() {
    let model = Chip::new(0);
    let mut chip = running(&model, 4);
    model.borrow_mut().gate = true; // takes nothing
    let mut events = FromEvents([1, 2, 3].map(|address| event(0, address)).into_iter());
    let unanswered = Err(ChipError::Handshake(Phase::Acknowledge));
    assert_eq!(chip.feed(&mut events, spike, drop), unanswered);
    assert_eq!(chip.feed(&mut events, spike, drop), unanswered, "and takes no other");
    chip.reset(&mut NoopDelay).unwrap();
    chip.run().unwrap();
    assert_eq!(chip.feed(&mut events, spike, drop), Ok(3));
    assert_eq!(model.borrow().taken, [1, 2, 3]);
}

proptest! {
    #[test]
    fn however_early_a_wait_ends_no_word_is_lost_or_sent_twice(
        addresses in prop::collection::vec(any::<u8>(), 0..20),
        polls in 2_u32..100,
        clocks in 1_u32..10,
        firing in any::<u8>(),
    ) {
        let model = Chip::new(firing);
        let step = NonZeroU32::new(1_000).unwrap();
        let mut chip = running_with(&model, clocks, polls).with_time_step(step);
        let mut out = Vec::new();
        let mut events = FromEvents((0..).zip(&addresses).map(|(n, &a)| event(n * 1_000, a.into())));
        let is_fed = (0..10_000).any(|_| {
            chip.feed(&mut events, spike, |neuron| out.push(neuron)).is_ok()
        });
        prop_assert!(is_fed);
        let words: Vec<u32> = addresses.iter().flat_map(|&a| [0x1FF, a.into()]).skip(1).collect();
        prop_assert_eq!(&model.borrow().taken, &words);
        for _ in 0..3_000 {
            chip.poll(|neuron| out.push(neuron)).unwrap();
        }
        let fired: Vec<u8> = addresses.into_iter().filter(|&neuron| neuron < firing).collect();
        prop_assert_eq!(out, fired);
    }
}

#[test]
fn leak_events_are_the_time_step() {
    let model = Chip::new(0);
    let mut chip = running(&model, 4).with_time_step(NonZeroU32::new(1_000).unwrap());
    let start = u32::MAX - 1_500;
    let events = [0, 900, 1_000, 3_999].map(|since| event(start.wrapping_add(since), 9));
    assert_eq!(chip.feed(FromEvents(events.into_iter()), spike, drop), Ok(4));
    assert_eq!(model.borrow().taken, [9, 9, 0x1FF, 9, 0x1FF, 0x1FF, 9]);
    chip.advance(Tick::from(start) + 4_000, drop).unwrap();
    assert_eq!(model.borrow().taken.len(), 8);
    chip.advance(Tick::from(start) + 1_004_000, drop).unwrap();
    assert_eq!((model.borrow().taken.len(), chip.skipped_steps()), (8 + 255, 745));
}

#[test]
fn events_of_a_step_that_is_over_are_sent_in_the_present_one_and_counted() {
    let model = Chip::new(0);
    let mut chip = running(&model, 4).with_time_step(NonZeroU32::new(1_000).unwrap());
    let events = [0, 2_500, 2_000, 1_999, 3_000, 0].map(|tick| event(tick, 9));
    assert_eq!(chip.feed(FromEvents(events.into_iter()), spike, drop), Ok(6));
    assert_eq!(model.borrow().taken, [9, 0x1FF, 0x1FF, 9, 9, 9, 0x1FF, 9, 9]);
    assert_eq!(chip.late_events(), 2);
}

/// The paper's loop, with a chip that passes every neuron through: a position code in, the chip's
/// output spikes out, a thrust command back.
#[test]
fn output_spikes_become_a_thrust_command() {
    static ERROR: Position<f32, 20> = Position::linear(-1.0..=1.0);

    let model = Chip::new(255);
    let mut chip = running(&model, 4);
    let mut bank = Bank::<_, 1>::new(&ERROR);
    let mut readout = Readout::<_, 1>::new(&ERROR);
    let mut direct = ERROR.decoder();
    for step in 0..200_u32 {
        let error = (step as f32 * 0.1).sin();
        let mut inputs = Vec::new();
        bank.encode(step.into(), [error], |event| inputs.push(event));
        let mut outputs = Vec::new();
        let mut on_output = |neuron: u8| outputs.push(event(step, neuron.into()));
        chip.feed(FromEvents(inputs.into_iter()), spike, &mut on_output).unwrap();
        for _ in 0..50 {
            chip.poll(&mut on_output).unwrap();
        }
        let [thrust] = readout.decode(step.into(), &outputs);
        assert_eq!(thrust, direct.decode(ERROR.encoder().encode(error)));
        assert!((thrust - error).abs() <= 0.5 * 2.0 / 18.0 + 1e-6, "{error} came back as {thrust}");
    }
}

#[test]
fn the_same_handshake_carries_odins_words() {
    let model = Chip::new(0);
    let mut chip = Odin::new(Spi(model.clone()), Port::new(&model, 3), 1_000);
    chip.reset(&mut NoopDelay).unwrap();
    chip.run().unwrap();
    chip.send(OdinInput::Synapse { pre: 7, post: 5 }, drop).unwrap();
    chip.send(OdinInput::LeakAll, drop).unwrap();
    assert_eq!(model.borrow().taken, [0x1_0705, 0x7F]);
}
