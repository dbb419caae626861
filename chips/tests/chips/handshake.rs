//! Tests on the models of tinyODIN and ODIN: the frames on the SPI bus and their order, handshakes, and time steps.

use std::cell::{Cell, RefCell};
use std::num::NonZeroU32;
use std::rc::Rc;

use crate::bus::Failing;
use embedded_hal::spi::{ErrorKind, ErrorType, Operation, SpiDevice};
use proptest::prelude::*;
use silicon::Board;
use spikewire::{Event, FromEvents, Polarity};
use spikewire_chips::{
    AerPort, ChipError, Input, Odin, OdinInput, OdinRegisters, OutputSource, Phase, TinyOdin,
    TinyOdinInput, TinyOdinNeuron, TinyOdinRegisters,
};

type TinyBoard = Board<silicon::TinyOdin>;
type Tiny = TinyOdin<silicon::Spi<silicon::TinyOdin>, silicon::Port<silicon::TinyOdin>>;

const OPEN: TinyOdinRegisters = TinyOdinRegisters {
    is_open_loop: true,
    output_source: OutputSource::Neurons,
    last_neuron: 255,
};

/// Makes a board and a driver, and starts the chip. The first `firing` neurons fire at every event. A port call takes
/// `clocks` clock cycles of the chip. The driver's waits end after `polls` pin reads.
fn running(clocks: u32, polls: u32, firing: usize) -> (TinyBoard, Tiny) {
    let board = TinyBoard::new(4, clocks);
    let mut chip = TinyOdin::new(board.spi(), board.port(), polls);
    let gated = chip.reset(&mut board.clone()).unwrap();
    board.pins().chip.neurons.fill(2047 << 12 | 1 << 24);
    board.pins().chip.neurons[..firing].fill(0);
    board.pins().chip.neurons[254] |= 1 << 31;
    gated.run(&TinyOdinRegisters { last_neuron: 15, ..OPEN }).unwrap();
    board.pins().chip.taken.clear();
    (board, chip)
}

fn event(tick: u32, address: u16) -> Event {
    Event { tick: tick.into(), address, polarity: Polarity::Up }
}

fn spike(event: Event) -> TinyOdinInput {
    TinyOdinInput::Spike { pre: event.address as u8 }
}

/// An SPI device that records the frames that it passes on.
struct Recorder<D> {
    device: D,
    frames: Rc<RefCell<Vec<[u8; 5]>>>,
}

impl<D: ErrorType> ErrorType for Recorder<D> {
    type Error = D::Error;
}

impl<D: SpiDevice> SpiDevice for Recorder<D> {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), D::Error> {
        for operation in operations.iter() {
            let bytes: &[u8] = match operation {
                Operation::Write(bytes) => bytes,
                Operation::TransferInPlace(bytes) => bytes,
                _ => panic!("not used"),
            };
            self.frames.borrow_mut().push(bytes.try_into().unwrap());
        }
        self.device.transaction(operations)
    }
}

#[test]
fn reads_per_clock_multiply_the_polls_of_every_wait() {
    /// Sends a word to a chip that is gated, and therefore never acknowledges the word. Returns the number of port
    /// calls that the driver makes before it gives up. `polls` is the driver's limit of polls, and `reads` is the
    /// number that multiplies this limit: the number of pin reads for each clock cycle of the chip.
    fn polls(reads: u32, polls: u32) -> u64 {
        let board = Board::<silicon::TinyOdin>::new(8, 1);
        board.pins().chip.neurons.fill(0x1000);
        let mut chip = TinyOdin::new(board.spi(), board.port(), polls)
            .with_reads_per_clock(NonZeroU32::new(reads).unwrap());
        let registers = TinyOdinRegisters {
            is_open_loop: true,
            output_source: OutputSource::Neurons,
            last_neuron: 255,
        };
        chip.reset(&mut board.clone()).unwrap().run(&registers).unwrap();
        // Shuts the gate without the driver's knowledge.
        board.spi().write(&[0, 0, 0, 0, 1]).unwrap();
        board.run(20);
        let before = board.pins().calls;
        let sent = chip.running().unwrap().send(TinyOdinInput::LeakAll, drop);
        assert_eq!(sent, Err(ChipError::Handshake(Phase::Acknowledge)));
        board.pins().calls - before
    }
    // Each poll reads REQ and ACK; a few more calls come before and after.
    let (one, five) = (polls(1, 100), polls(5, 100));
    assert!((200..210).contains(&one) && (1000..1010).contains(&five), "{one} {five}");
}

/// The sync check changes the byte of synapses (255, 248) and (255, 249), and restores it.
#[test]
fn the_byte_that_the_sync_check_writes_keeps_its_synapses() {
    let board = TinyBoard::new(4, 1);
    let mut chip = TinyOdin::new(board.spi(), board.port(), 1_600);
    let mut gated = chip.reset(&mut board.clone()).unwrap();
    gated.set_synapse(255, 249, 3).unwrap();
    gated.set_synapse(255, 248, -5).unwrap();
    assert_eq!((gated.synapse(255, 249), gated.synapse(255, 248)), (Ok(3), Ok(-5)));
}

#[test]
fn the_bytes_on_the_bus_are_golden() {
    let board = TinyBoard::new(4, 1);
    let frames = Rc::new(RefCell::new(Vec::new()));
    let device = Recorder { device: board.spi(), frames: frames.clone() };
    let mut chip = TinyOdin::new(device, board.port(), 1_600);
    let mut gated = chip.reset(&mut board.clone()).unwrap();
    let taken = || std::mem::take(&mut *frames.borrow_mut());
    assert_eq!(taken()[..2], [[0, 0, 0, 0, 1], [0, 0, 0x10, 0, 1]], "gated, in open loop");
    gated.set_neuron_byte(5, 1, 0x30).unwrap();
    // Each access is a read, five frames of check, a write, five frames of check, and a read. The data of a read is
    // ones, which the chip ignores.
    let ends = |frames: Vec<[u8; 5]>| [frames[0], frames[6], frames[12]];
    let read = [0x90, 0x10, 0x5F, 0xFF, 0xFF];
    assert_eq!(ends(taken()), [read, [0x50, 0x10, 0x50, 0, 0x30], read]);
    let read = [0xA4, 0x0E, 0x0F, 0xFF, 0xFF];
    gated.set_synapse(7, 5, 3).unwrap();
    assert_eq!(ends(taken()), [read, [0x64, 0x0E, 0, 0x0F, 0x30], read]);
    gated.set_synapse(7, 4, -5).unwrap();
    assert_eq!(ends(taken()), [read, [0x64, 0x0E, 0, 0xF0, 0x0B], read]);
    assert_eq!((gated.synapse(7, 5), gated.synapse(7, 4)), (Ok(3), Ok(-5)));
    // The sync check changes its byte to a different value, even if that byte is the one accessed. It also reads a byte
    // that is not 0.
    gated.set_synapse(255, 248, 5).unwrap();
    gated.set_synapse(255, 249, -6).unwrap();
    for leak in [3, 0] {
        let neuron = TinyOdinNeuron { threshold: 9, leak, ..TinyOdinNeuron::REST };
        gated.set_neuron(5, &neuron).unwrap();
    }
    taken();
    gated.check_sync().unwrap();
    let check = taken();
    let written: Vec<_> = check.iter().filter(|frame| frame[0] == 0x61).copied().collect();
    assert_eq!(written, [[0x61, 0xFF, 0xF0, 0, 0x5A], [0x61, 0xFF, 0xF0, 0, 0xA5]]);
    assert_eq!(check.len(), 5);
    gated.run(&TinyOdinRegisters { last_neuron: 32, ..OPEN }).unwrap();
    let all = taken();
    let registers = |frame: &&[u8; 5]| frame[0] == 0;
    let written: Vec<_> = all.iter().filter(registers).copied().collect();
    let expected = [[0, 0, 0x20, 0, 0], [0, 0, 0x30, 0, 0x20], [0, 0, 0x10, 0, 1], [0; 5]];
    assert_eq!(written, expected);
    assert_eq!(all.last(), Some(&[0; 5]), "the gate opens last");
}

#[test]
fn a_start_takes_as_many_frames_as_it_says() {
    let board = TinyBoard::new(4, 1);
    let mut chip = TinyOdin::new(board.spi(), board.port(), 1_600);
    let gated = chip.reset(&mut board.clone()).unwrap();
    let before = board.pins().spi_clocks;
    gated.run(&OPEN).unwrap();
    assert_eq!(board.pins().spi_clocks - before, 38 * 40);

    let board = Board::<silicon::Odin>::new(4, 1);
    let mut chip = Odin::new(board.spi(), board.port(), 1_600);
    let gated = chip.reset(&mut board.clone()).unwrap();
    let before = board.pins().spi_clocks;
    gated.run(&OdinRegisters::PLAIN).unwrap();
    assert_eq!(board.pins().spi_clocks - before, 206 * 40);
}

#[test]
fn what_is_out_of_order_or_range_is_refused_without_a_byte() {
    let board = TinyBoard::new(4, 1);
    let mut chip = TinyOdin::new(board.spi(), board.port(), 1_600);
    assert_eq!(chip.gated().err(), Some(ChipError::NotReset));
    assert_eq!(chip.running().err(), Some(ChipError::NotReset));
    let mut gated = chip.reset(&mut board.clone()).unwrap();
    let clocks = board.pins().spi_clocks;
    let out_of_range = |result| matches!(result, Err(ChipError::OutOfRange { .. }));
    assert!(out_of_range(gated.set_neuron_byte(0, 4, 0)));
    assert!(out_of_range(gated.neuron_byte(0, 4).map(drop)));
    assert!(out_of_range(gated.set_synapse(0, 0, 8)));
    assert!(out_of_range(
        gated.set_neuron(0, &TinyOdinNeuron { threshold: 0, ..TinyOdinNeuron::REST })
    ));
    assert_eq!(chip.running().err(), Some(ChipError::Gated));
    assert_eq!(board.pins().spi_clocks, clocks);
    chip.gated().unwrap().run(&OPEN).unwrap();
    assert_eq!(chip.gated().err(), Some(ChipError::NotGated));

    let board = Board::<silicon::Odin>::new(4, 1);
    let mut chip = Odin::new(board.spi(), board.port(), 1_600);
    let gated = chip.reset(&mut board.clone()).unwrap();
    let wide = OdinRegisters { burst_clocks: 1 << 20, ..OdinRegisters::PLAIN };
    assert!(matches!(gated.run(&wide), Err(ChipError::OutOfRange { what: "burst clocks", .. })));
}

#[test]
fn an_error_at_every_transfer_asks_for_a_reset() {
    let program = |chip: &mut TinyOdin<Failing<_>, _>, board: &TinyBoard| {
        let mut gated = chip.reset(&mut board.clone())?;
        gated.set_neuron(5, &TinyOdinNeuron { threshold: 5, ..TinyOdinNeuron::REST })?;
        gated.set_synapse(7, 5, 3)?;
        gated.run(&OPEN)?;
        Ok::<(), ChipError<_, _>>(())
    };
    for index in 0.. {
        let board = TinyBoard::new(4, 1);
        let bus = Failing { device: board.spi(), left: index };
        let mut chip = TinyOdin::new(bus, board.port(), 1_600);
        let result = program(&mut chip, &board);
        if result.is_ok() {
            assert!(index > 30);
            return;
        }
        assert_eq!(result, Err(ChipError::Bus(ErrorKind::Other)), "{index}");
        assert_eq!(chip.gated().err(), Some(ChipError::NotReset));
        assert_eq!(program(&mut chip, &board), Ok(()));
        assert_eq!(chip.counters().resets, 2);
    }
}

/// A port that passes calls on to `port`, with two faults that a test can switch on: the input bus's ACK stays at one
/// level, or the output bus always seems busy. Counts the reads of the output bus's REQ.
struct Held<P> {
    port: P,
    acknowledge: Rc<Cell<Option<bool>>>,
    is_noisy: Rc<Cell<bool>>,
    reads: Rc<Cell<u32>>,
}

impl<P> Held<P> {
    fn new(port: P, acknowledge: Rc<Cell<Option<bool>>>) -> Self {
        Self { port, acknowledge, is_noisy: Rc::default(), reads: Rc::default() }
    }
}

impl<P: AerPort> AerPort for Held<P> {
    type Error = P::Error;

    fn set_input(&mut self, word: u32) -> Result<(), P::Error> {
        self.port.set_input(word)
    }
    fn set_input_request(&mut self, is_high: bool) -> Result<(), P::Error> {
        self.port.set_input_request(is_high)
    }
    fn input_acknowledge(&mut self) -> Result<bool, P::Error> {
        let pin = self.port.input_acknowledge()?;
        Ok(self.acknowledge.get().unwrap_or(pin))
    }
    fn output_request(&mut self) -> Result<bool, P::Error> {
        self.reads.set(self.reads.get() + 1);
        let pin = self.port.output_request()?;
        Ok(if self.is_noisy.get() { self.reads.get() % 2 == 1 } else { pin })
    }
    fn output(&mut self) -> Result<u8, P::Error> {
        self.port.output()
    }
    fn set_output_acknowledge(&mut self, is_high: bool) -> Result<(), P::Error> {
        self.port.set_output_acknowledge(is_high)
    }
    fn set_reset(&mut self, is_high: bool) -> Result<(), P::Error> {
        self.port.set_reset(is_high)
    }
}

/// Because no pin shows that the chip is at rest, the driver waits for the longest time that the chip may work without
/// an output, and longer if outputs come.
#[test]
fn quiesce_waits_as_long_as_the_chip_may_work() {
    let waits = |is_open_loop: bool, is_noisy: bool| {
        let board = TinyBoard::new(4, 1);
        let port = Held::new(board.port(), Rc::default());
        let (noise, reads) = (port.is_noisy.clone(), port.reads.clone());
        let mut chip = TinyOdin::new(board.spi(), port, 1_600);
        let gated = chip.reset(&mut board.clone()).unwrap();
        board.pins().chip.neurons.fill(1 << 31);
        let registers = TinyOdinRegisters { is_open_loop, last_neuron: 9, ..OPEN };
        let mut running = gated.run(&registers).unwrap();
        noise.set(is_noisy);
        reads.set(0);
        let result = running.quiesce(drop);
        assert_eq!(result, if is_noisy { Err(ChipError::Busy) } else { Ok(()) });
        reads.get()
    };
    // Applying a spike to ten neurons takes at most 24 clock cycles. The driver waits for four such sweeps in open
    // loop; in closed loop for one for each place of the queue, and two more.
    let (open, closed) = (4 * 24 + 32, (128 + 2) * 24 + 32);
    assert_eq!((waits(true, false), waits(false, false)), (open, closed));
    assert_eq!(waits(true, true), 4 * open + (1 << 15));
}

/// A port without a pin for `SCHED_FULL` cannot tell whether the chip's queue is full. Its `queue_full`, which the
/// trait provides, returns `None`.
#[test]
fn a_port_may_leave_the_full_pin_unwired() {
    let port = TinyBoard::new(4, 1).port();
    let mut port = Held::new(port, Rc::default());
    assert_eq!(port.queue_full(), Ok(None));
}

#[test]
fn a_silent_chip_times_out_in_every_phase() {
    for (held, phase) in [(true, Phase::Idle), (false, Phase::Acknowledge)] {
        let board = TinyBoard::new(4, 1);
        let acknowledge = Rc::new(Cell::new(None));
        let port = Held::new(board.port(), acknowledge.clone());
        let mut chip = TinyOdin::new(board.spi(), port, 50);
        let gated = chip.reset(&mut board.clone()).unwrap();
        board.pins().chip.neurons.fill(1 << 31);
        let mut running = gated.run(&OPEN).unwrap();
        acknowledge.set(Some(held));
        let spike = TinyOdinInput::Spike { pre: 1 };
        assert_eq!(running.send(spike, drop), Err(ChipError::Handshake(phase)));
    }
}

#[test]
fn a_chip_that_does_not_answer_is_not_started() {
    let board = TinyBoard::new(4, 1);
    let acknowledge = Rc::new(Cell::new(Some(false)));
    let port = Held::new(board.port(), acknowledge);
    let mut chip = TinyOdin::new(board.spi(), port, 50);
    let gated = chip.reset(&mut board.clone()).unwrap();
    board.pins().chip.neurons.fill(1 << 31);
    assert_eq!(gated.run(&OPEN).err(), Some(ChipError::NotStarted));
    assert_eq!(chip.running().err(), Some(ChipError::NotReset));
    chip.reset(&mut board.clone()).unwrap();
    assert_eq!(chip.counters().dropped_words, 0, "it was none of the caller's");
}

proptest! {
    #![proptest_config(crate::cases(64))]

    #[test]
    fn all_events_go_in_and_all_outputs_come_out(
        addresses in prop::collection::vec(any::<u8>(), 0..60),
        clocks in 1_u32..40,
        firing in 0..16_usize,
    ) {
        let (board, mut chip) = running(clocks, TinyOdinInput::MAX_CLOCKS, firing);
        let mut running = chip.running().unwrap();
        let mut out = Vec::new();
        let events = addresses.iter().map(|&address| event(0, address.into()));
        let sent = running.feed(FromEvents(events), spike, |neuron| out.push(neuron));
        prop_assert_eq!(sent, Ok(addresses.len() as u32));
        running.quiesce(|neuron| out.push(neuron)).unwrap();
        let words: Vec<u32> = addresses.iter().map(|&address| address.into()).collect();
        prop_assert_eq!(&board.pins().chip.taken, &words);
        let fired: Vec<u8> = addresses.iter().flat_map(|_| 0..firing as u8).collect();
        prop_assert_eq!(&out, &fired);
    }

    #[test]
    fn however_early_a_wait_ends_no_word_is_lost_or_sent_twice(
        addresses in prop::collection::vec(any::<u8>(), 0..20),
        polls in 1_u32..100,
        clocks in 1_u32..10,
        firing in 0..3_usize,
    ) {
        let (board, chip) = running(clocks, polls, firing);
        let mut chip = chip.with_time_step(NonZeroU32::new(1_000).unwrap());
        let mut running = chip.running().unwrap();
        let mut out = Vec::new();
        let mut events = (0..).zip(&addresses).map(|(n, &a)| event(n * 1_000, a.into()));
        let is_fed = (0..10_000).any(|_| {
            running.feed(FromEvents(&mut events), spike, |neuron| out.push(neuron)).is_ok()
        });
        prop_assert!(is_fed);
        let words: Vec<u32> = addresses.iter().flat_map(|&a| [0x1FF, a.into()]).skip(1).collect();
        prop_assert_eq!(&board.pins().chip.taken, &words);
        running.quiesce(|neuron| out.push(neuron)).unwrap();
        prop_assert_eq!(&out, &board.pins().chip.fired);
        prop_assert_eq!(out.len(), words.len() * firing);
    }
}

#[test]
fn a_word_that_takes_the_chip_long_is_finished_before_the_next() {
    use TinyOdinInput::{LeakAll, Spike};
    let (board, mut chip) = running(1, 5, 0);
    let mut running = chip.running().unwrap();
    assert_eq!(running.send(LeakAll, drop), Err(ChipError::Handshake(Phase::Acknowledge)));
    let not_sent = Err(ChipError::Handshake(Phase::Idle));
    let refused = (0..100).take_while(|_| running.send(Spike { pre: 4 }, drop) == not_sent).count();
    assert_eq!(board.pins().chip.taken, [0x1FF, 4]);
    assert!(refused > 0);
    for _ in 0..1_000 {
        running.poll(drop).unwrap();
    }
    assert_eq!(running.send(Spike { pre: 5 }, drop), Ok(()), "polling finishes it as well");
}

#[test]
fn any_word_is_through_within_the_most_clocks_of_the_chip() {
    let board = TinyBoard::new(4, 1);
    let mut chip = TinyOdin::new(board.spi(), board.port(), TinyOdinInput::MAX_CLOCKS);
    let gated = chip.reset(&mut board.clone()).unwrap();
    // The queue fills because 255 neurons fire at the first spike.
    board.pins().chip.neurons.fill(1 << 12 | 1);
    board.pins().chip.neurons[254] = 1 << 31;
    let mut running = gated.run(&TinyOdinRegisters { is_open_loop: false, ..OPEN }).unwrap();
    running.send(TinyOdinInput::Spike { pre: 0 }, drop).unwrap();
    while !board.pins().chip.is_full() {
        running.poll(drop).unwrap();
    }
    let mut most = 0;
    for _ in 0..5 {
        let start = board.pins().chip.clocks;
        while running.send(TinyOdinInput::LeakAll, drop).is_err() {}
        let outputs = board.pins().chip.fired.len();
        let clocks = board.pins().chip.clocks - start;
        board.pins().chip.fired.clear();
        most = most.max(clocks.saturating_sub(12 * outputs as u64));
    }
    assert!(most < u64::from(TinyOdinInput::MAX_CLOCKS), "{most}");
}

#[test]
fn leak_events_are_the_time_step() {
    let (board, chip) = running(4, 1_600, 0);
    let mut chip = chip.with_time_step(NonZeroU32::new(1_000).unwrap());
    let mut running = chip.running().unwrap();
    let start = u32::MAX - 1_500;
    let events = [0, 900, 1_000, 3_999].map(|since| event(start.wrapping_add(since), 9));
    assert_eq!(running.feed(FromEvents(events.into_iter()), spike, drop), Ok(4));
    assert_eq!(board.pins().chip.taken, [9, 9, 0x1FF, 9, 0x1FF, 0x1FF, 9]);
    running.advance((start.wrapping_add(4_000)).into(), drop).unwrap();
    assert_eq!(board.pins().chip.taken.len(), 8);
    running.advance((start.wrapping_add(1_004_000)).into(), drop).unwrap();
    let taken = board.pins().chip.taken.len();
    assert_eq!((taken, running.counters().skipped_steps), (8 + 255, 745));
}

/// The 32-bit clock of ticks wraps after 71.6 minutes; steps up to 70 minutes apart must not count as late.
#[test]
fn time_steps_that_passed_in_an_hour_are_not_taken_for_the_past() {
    const MINUTE: u32 = 60_000_000;
    for minutes in [30, 36, 50, 70] {
        let (board, chip) = running(4, 1_600, 0);
        let mut chip = chip.with_time_step(NonZeroU32::new(1_000).unwrap());
        let mut running = chip.running().unwrap();
        running.advance(MINUTE.into(), drop).unwrap();
        let later = MINUTE.wrapping_add(minutes * MINUTE);
        running.advance(later.into(), drop).unwrap();
        assert_eq!(board.pins().chip.taken.len(), 255, "{minutes} minutes");
        let counters = running.counters();
        assert_eq!(counters.skipped_steps, minutes * 60_000 - 255, "{minutes} minutes");
        running.feed(FromEvents([event(later, 9)].into_iter()), spike, drop).unwrap();
        running.advance(later.wrapping_add(1_000).into(), drop).unwrap();
        assert_eq!(board.pins().chip.taken.len(), 255 + 2, "{minutes} minutes");
        // An event that is a minute older than the last one counts as late.
        let late = event(later.wrapping_sub(MINUTE), 9);
        running.feed(FromEvents([late].into_iter()), spike, drop).unwrap();
        assert_eq!(board.pins().chip.taken.len(), 255 + 3, "{minutes} minutes");
        assert_eq!(running.counters().late_events, 1, "{minutes} minutes");
    }
}

#[test]
fn events_of_a_step_that_is_over_are_sent_in_the_present_one_and_counted() {
    let (board, chip) = running(4, 1_600, 0);
    let mut chip = chip.with_time_step(NonZeroU32::new(1_000).unwrap());
    let events = [0, 2_500, 2_000, 1_999, 3_000, 0].map(|tick| event(tick, 9));
    assert_eq!(chip.running().unwrap().feed(FromEvents(events.into_iter()), spike, drop), Ok(6));
    assert_eq!(board.pins().chip.taken, [9, 0x1FF, 0x1FF, 9, 9, 9, 0x1FF, 9, 9]);
    assert_eq!(chip.counters().late_events, 2);
}

#[test]
fn what_a_reset_drops_is_counted() {
    let (board, chip) = running(1, 2, 1);
    let mut chip = chip.with_time_step(NonZeroU32::new(1_000).unwrap());
    let mut delay = board.clone();
    board.pins().chip.registers.0[0] = 1; // takes nothing
    board.run(10);
    let mut running = chip.running().unwrap();
    assert!(running.send(TinyOdinInput::Spike { pre: 1 }, drop).is_err());
    let gated = chip.reset(&mut delay).unwrap();
    let mut running = gated.run(&OPEN).unwrap();
    running.advance(0.into(), drop).unwrap();
    board.pins().chip.registers.0[0] = 1;
    board.run(10);
    assert!(running.advance(1_000.into(), drop).is_err());
    let gated = chip.reset(&mut delay).unwrap();
    let mut running = gated.run(&OPEN).unwrap();
    while running.send(TinyOdinInput::Spike { pre: 1 }, drop).is_err() {
        board.run(20);
    }
    board.run(100); // neuron 0 fires
    chip.reset(&mut delay).unwrap();
    let counters = chip.counters();
    assert_eq!((counters.dropped_words, counters.skipped_steps, counters.lost_outputs), (1, 1, 1));
}

#[test]
fn what_a_chip_says_before_its_first_reset_is_no_output() {
    let board = TinyBoard::new(4, 1);
    board.pins().chip.registers.0[3] = 15;
    board.pins().chip.set_request(true); // the pins float: a spike, at which all neurons fire
    board.run(10);
    board.pins().chip.set_request(false);
    board.run(100);
    assert!(board.pins().chip.output().request);
    let mut chip = TinyOdin::new(board.spi(), board.port(), 1_600);
    chip.reset(&mut board.clone()).unwrap();
    assert_eq!(chip.counters().lost_outputs, 0);
}

#[test]
fn the_same_handshake_carries_odins_words() {
    let board = Board::<silicon::Odin>::new(4, 3);
    let mut chip = Odin::new(board.spi(), board.port(), 1_000);
    let gated = chip.reset(&mut board.clone()).unwrap();
    board.pins().chip.neurons.fill(1 | 255 << 9);
    let mut running = gated.run(&OdinRegisters::PLAIN).unwrap();
    running.send(OdinInput::Synapse { pre: 7, post: 5 }, drop).unwrap();
    running.send(OdinInput::LeakAll, drop).unwrap();
    assert_eq!(board.pins().chip.taken, [0x0_FFFF, 0x1_0705, 0x7F], "the probe comes first");
}

/// The driver is no slower than an earlier version. Each pin read takes one clock cycle of the chip here. In the
/// earlier version, a spike took 32.9 clock cycles with 12 neurons in use, 136.4 with 64, and 518.5 with 256. A virtual
/// event took 15.5 clock cycles, and an output took 11.6.
#[test]
fn throughput_is_that_of_the_chip() {
    for (neurons, most) in [(12, 32.9), (64, 136.4), (256, 518.5)] {
        let board = TinyBoard::new(4, 1);
        let mut chip = TinyOdin::new(board.spi(), board.port(), 1_600);
        let gated = chip.reset(&mut board.clone()).unwrap();
        board.pins().chip.neurons.fill(2047 << 12);
        let last_neuron = (neurons - 1) as u8;
        let mut running = gated.run(&TinyOdinRegisters { last_neuron, ..OPEN }).unwrap();
        let clocks = || board.pins().chip.clocks as f64;
        let start = clocks();
        for pre in 0..200 {
            running.send(TinyOdinInput::Spike { pre }, drop).unwrap();
        }
        let spikes = clocks();
        for _ in 0..200 {
            running.send(TinyOdinInput::Virtual { neuron: 3, weight: 1 }, drop).unwrap();
        }
        let virtuals = clocks();
        let each = [(spikes - start) / 200.0, (virtuals - spikes) / 200.0];
        assert!(each[0] <= most && each[1] <= 15.6, "{neurons}: {each:?}");

        board.pins().chip.neurons.fill(0); // all fire
        let (start, mut outputs) = (clocks(), 0);
        for pre in 0..20 {
            running.send(TinyOdinInput::Spike { pre }, |_| outputs += 1).unwrap();
        }
        while !board.pins().chip.is_idle() {
            running.poll(|_| outputs += 1).unwrap();
        }
        let sweeps = 20.0 * f64::from(2 * neurons + 3);
        let each = (clocks() - start - sweeps) / f64::from(outputs);
        assert!(each <= 11.6, "{neurons}: {each}");
    }
}
