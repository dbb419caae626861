//! Tests of the driver of `ReckOn` on the model of the chip. (`cargo verify reckon` compares the model with the chip's
//! register-transfer code.)

#![allow(clippy::needless_range_loop, reason = "a neuron's number is its column in several tables")]

use std::cell::Cell;

use embedded_hal::spi::{ErrorKind, SpiDevice};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use silicon::board::{CallFault, ClockFault};
use silicon::reckon::{Board, Port, Spi, State};
use spikewire::{Bank, Tick, population::Position};
use spikewire_chips::{
    ChipError, DescribeReckOn, FormatError, Phase, ReckOn, ReckOnAnswer, ReckOnBytes,
    ReckOnLearning, ReckOnNetwork, ReckOnOutputs, ReckOnPair, ReckOnPort, ReckOnSample,
    ReckOnSettings, ReckOnShared, ReckOnStep, ReckOnSteps, ReckOnStepsState, ReckOnTarget,
    ReckOnTask, ReckOnTick,
};

type Chip = ReckOn<Spi, Port>;
type Error = ChipError<ErrorKind, u64>;

const PAIRS: [ReckOnPair; 2] =
    [ReckOnPair { keep: 30_000, threshold: 300 }, ReckOnPair { keep: 33_000, threshold: 250 }];
const RECURRENT: [[i8; 4]; 4] =
    [[0, 60, -20, 11], [-128, 0, 127, 3], [40, -40, 0, 90], [5, 6, -7, 0]];
const NETWORK: ReckOnNetwork<5, 4, 3> = ReckOnNetwork {
    pairs: &PAIRS,
    inputs: [[100, -30, 20, 7], [127, 127, -128, 60], [3, 2, 1, 90], [-9, 80, 80, 0], [1, 1, 1, 1]],
    recurrent: &RECURRENT,
    outputs: [[10, -20, 30], [-128, 127, 1], [50, 50, -50], [0, 9, 99]],
    shared: ReckOnShared { shifts: [1, 2, 0], keep: 110, resets_to_zero: false },
};

fn on(board: &Board) -> Chip {
    ReckOn::new(board.spi(), board.port(), Chip::MAX_CLOCKS)
}

/// The reference: the network in plain arithmetic. At a tick, neurons fire and outputs are read. After that, spikes
/// and inputs act on the potentials.
#[derive(Clone)]
struct Plain {
    potentials: [i32; 4],
    fired: [bool; 4],
    outputs: [i32; 3],
}

impl Plain {
    const NEW: Self = Self { potentials: [0; 4], fired: [false; 4], outputs: [0; 3] };

    fn step(&mut self, inputs: &[u8]) -> [i16; 16] {
        let clamp = |value: i32| value.clamp(-32_768, 32_767);
        for n in 0..4 {
            let ReckOnPair { keep, threshold } = PAIRS[n / 2];
            let potential = self.potentials[n];
            self.fired[n] = potential >= i32::from(threshold);
            // The chip keeps 16 bits: with a `keep` above 1 a potential near the end of its range wraps around.
            self.potentials[n] = i32::from(((potential * i32::from(keep)) >> 15) as i16);
            if self.fired[n] {
                let reset = self.potentials[n] - i32::from(threshold);
                self.potentials[n] = i32::from(reset as i16);
            }
        }
        self.outputs.iter_mut().for_each(|output| *output = (*output * 110) >> 7);
        let mut answer = [0; 16];
        answer.iter_mut().zip(self.outputs).for_each(|(to, output)| *to = output as i16);
        for source in 0..5 {
            let is_input = inputs.contains(&source);
            let at = usize::from(source);
            let is_spike = at < 4 && self.fired[at];
            for n in 0..4 {
                let input = if is_input { i32::from(NETWORK.inputs[at][n]) << 1 } else { 0 };
                let own = if is_spike { i32::from(RECURRENT[at][n]) << 2 } else { 0 };
                self.potentials[n] = clamp(self.potentials[n] + clamp(input + own));
            }
            for k in 0..3 {
                let own = if is_spike { i32::from(NETWORK.outputs[at][k]) } else { 0 };
                self.outputs[k] = clamp(self.outputs[k] + own);
            }
        }
        answer
    }
}

/// The driver leaks outputs whose leaks differ: the chip's answers, which it halves at each tick, must give the exact sum
/// of the weights of the neurons that fired.
#[test]
fn outputs_of_different_leaks_add_up_the_weights_of_the_neurons_that_fired() {
    let network = ReckOnNetwork {
        shared: ReckOnShared {
            shifts: [1, 2, 1],
            keep: ReckOnOutputs::LEAKY_KEEP,
            ..NETWORK.shared
        },
        ..NETWORK
    };
    let (unit, keeps) = (0.25, [0.5, 1.0, 0.9]);
    let outputs = ReckOnOutputs::Leaky { unit, keeps: &keeps };
    let ticks = [ReckOnTick { always: &[4], raises: &[] }];
    let steps = ReckOnSteps { inputs: 4, ticks: &ticks, late: 2, outputs };
    let board = Board::new(10, 1);
    let mut chip = on(&board);
    let mut programmed = chip.reset(&mut board.clone()).unwrap();
    programmed.load(&network, |_| ()).unwrap();
    let mut sample = programmed.run(&ReckOnSettings::POTENTIALS).unwrap().begin().unwrap();
    let (mut state, mut random) = (ReckOnStepsState::REST, Pcg32::seed_from_u64(7));
    let (mut fired, mut expected, mut spikes): (Vec<u8>, [f32; 3], usize) = (vec![], [0.0; 3], 0);
    for _ in 0..500 {
        let inputs = random.next_u32();
        let inputs = (0..4).filter(|input| inputs >> input & 1 == 1);
        let values = sample.run(&steps, &mut state, inputs).unwrap();
        for (output, (value, keep)) in expected.iter_mut().zip(keeps).enumerate() {
            let weight = |neuron: &u8| 2 * i32::from(network.outputs[usize::from(*neuron)][output]);
            *value = *value * keep + fired.iter().map(weight).sum::<i32>() as f32 * unit;
        }
        assert_eq!(values[..3], expected);
        fired = std::mem::take(&mut board.pins().chip.fired);
        spikes += fired.len();
    }
    assert!(spikes > 100, "{spikes} spikes");

    let beyond = sample.run(&steps, &mut state, [4]);
    assert!(matches!(beyond, Err(ChipError::OutOfRange { what: "input", value: 4, .. })));
    let error = sample.run(&ReckOnSteps { inputs: 0, ..steps }, &mut state, [0]);
    assert!(matches!(error, Err(ChipError::OutOfRange { what: "input", .. })));
    let (_, started) = sample.end().unwrap();
    let mut sample =
        started.program().unwrap().run(&ReckOnSettings::LABEL).unwrap().begin().unwrap();
    let no_answer = sample.run(&steps, &mut { ReckOnStepsState::REST }, []);
    assert!(matches!(no_answer, Err(ChipError::OutOfRange { what: "answers", .. })));
}

#[test]
fn a_network_answers_as_plain_arithmetic_does_step_by_step() {
    let board = Board::new(10, 1);
    let mut chip = on(&board);
    let mut programmed = chip.reset(&mut board.clone()).unwrap();
    programmed.load(&NETWORK, |_| ()).unwrap();
    let mut started = programmed.run(&ReckOnSettings::POTENTIALS).unwrap();
    let mut random = Pcg32::seed_from_u64(3);
    let mut spikes = 0;
    for _ in 0..4 {
        let mut plain = Plain::NEW;
        let mut sample = started.begin().unwrap();
        for _ in 0..100 {
            let inputs: Vec<u8> = (0..5).filter(|_| random.next_u32() % 3 == 0).collect();
            for &input in &inputs {
                sample.send(input).unwrap();
            }
            let answer = sample.step(ReckOnStep::default()).unwrap();
            assert_eq!(answer, Some(ReckOnAnswer::Potentials(plain.step(&inputs))));
        }
        let (answer, next) = sample.end().unwrap();
        assert_eq!(answer, ReckOnAnswer::Potentials(plain.step(&[])));
        started = next;
        spikes += std::mem::take(&mut board.pins().chip.fired).len();
    }
    assert!(spikes > 100, "{spikes}");
    started.program().unwrap().verify(&NETWORK).unwrap();
}

#[test]
fn a_network_as_bytes_is_the_same_and_damaged_bytes_are_refused() {
    let mut buffer = [0; 256];
    let length = ReckOnBytes::write(&NETWORK, &mut buffer).unwrap();
    assert_eq!(length, 16 + 2 * 4 + 5 * 4 + 4 * 4 + 4 * 3);
    let bytes = &buffer[..length];
    assert_eq!(&bytes[..12], b"SWN1\x03\x01\x04\0\x05\0\x03\0");
    let network = ReckOnBytes::new(bytes).unwrap();
    assert_eq!(network.shared(), NETWORK.shared());
    for pair in 0..3 {
        assert_eq!(network.pair(pair), NETWORK.pair(pair));
    }
    for from in 0..6 {
        for to in 0..6 {
            assert_eq!(network.input_weight(from, to), NETWORK.input_weight(from, to));
            assert_eq!(network.recurrent_weight(from, to), NETWORK.recurrent_weight(from, to));
            assert_eq!(network.output_weight(from, to), NETWORK.output_weight(from, to));
        }
    }
    let board = Board::new(10, 1);
    let mut chip = on(&board);
    let mut programmed = chip.reset(&mut board.clone()).unwrap();
    programmed.load(&network, |_| ()).unwrap();
    programmed.verify(&NETWORK).unwrap();

    let refused = |at: usize, byte: u8| {
        let mut bytes = bytes.to_vec();
        bytes[at] = byte;
        ReckOnBytes::new(&bytes).map(drop).unwrap_err()
    };
    assert_eq!(refused(0, b'T'), FormatError::Magic);
    assert_eq!(refused(4, 1), FormatError::Chip);
    assert_eq!(refused(6, 0), FormatError::Size);
    assert_eq!(refused(10, 17), FormatError::Size);
    assert_eq!(refused(12, 8), FormatError::Value, "a shift");
    assert_eq!(refused(17, 0), FormatError::Value, "a keep");
    assert_eq!(refused(19, 0x80), FormatError::Value, "a threshold below 0");
    let short = FormatError::Length { needed: length, given: length - 1 };
    assert_eq!(ReckOnBytes::new(&bytes[..length - 1]).unwrap_err(), short);
    let small = ReckOnBytes::write(&NETWORK, &mut [0; 71]).unwrap_err();
    assert_eq!(small, FormatError::Length { needed: length, given: 71 });

    // A network without weights between neurons is written without rows for them.
    let shared = ReckOnShared { resets_to_zero: true, ..NETWORK.shared };
    let layer = ReckOnNetwork { recurrent: &[[0; 4]; 4], shared, ..NETWORK };
    assert_eq!(ReckOnBytes::write(&layer, &mut buffer), Ok(length - 16));
    assert_eq!(buffer[5], 2, "it has no flag but that of neurons that return to 0");
}

/// A network of 65 540 neurons must be refused. Cut to 16 bits, 65 540 would become 4, a valid number of neurons.
#[test]
fn a_network_of_far_too_many_neurons_is_refused() {
    static LARGE: ReckOnNetwork<1, 65_540, 1> = ReckOnNetwork {
        pairs: &PAIRS,
        inputs: [[0; 65_540]; 1],
        recurrent: &[],
        outputs: [[0; 1]; 65_540],
        shared: NETWORK.shared,
    };
    assert_eq!(ReckOnBytes::write(&LARGE, &mut [0; 256]), Err(FormatError::Size));
}

#[test]
fn the_label_is_the_output_that_was_highest_most_often() {
    let board = Board::new(10, 1);
    let mut chip = on(&board);
    let mut programmed = chip.reset(&mut board.clone()).unwrap();
    programmed.load(&NETWORK, |_| ()).unwrap();
    let mut started = programmed.run(&ReckOnSettings::LABEL).unwrap();
    for (inputs, label) in [(&[1][..], 1), (&[2], 2)] {
        let mut sample = started.begin().unwrap();
        for _ in 0..40 {
            for &input in inputs {
                sample.send(input).unwrap();
            }
            let step = ReckOnStep { counts: true, target: None };
            assert_eq!(sample.step(step).unwrap(), None);
        }
        let (answer, next) = sample.end().unwrap();
        assert_eq!(answer, ReckOnAnswer::Label(label));
        started = next;
    }
}

const LEARNING: ReckOnLearning = ReckOnLearning {
    learns: [true; 3],
    traces: [0; 3],
    signal: 4,
    thresholds: [-100, 0, 100, 200],
    slopes: [1, 4, 8, 8, 4],
    rates: [(8, 15), (8, 15), (2, 20)],
    is_linear: true,
};

#[test]
fn learning_moves_an_outputs_potential_towards_its_target() {
    let board = Board::new(10, 1);
    let mut chip = on(&board);
    let mut programmed = chip.reset(&mut board.clone()).unwrap();
    programmed.load(&NETWORK, |_| ()).unwrap();
    let settings = ReckOnSettings { learning: Some(LEARNING), ..ReckOnSettings::POTENTIALS };
    let mut started = programmed.run(&settings).unwrap();
    let mut errors = vec![];
    for _ in 0..40 {
        let mut sample = started.begin().unwrap();
        let mut error = 0;
        for at in 0..20 {
            for input in [0, 1, 3] {
                sample.send(input).unwrap();
            }
            let target = ReckOnTarget::Potentials(&[300, -200, 50]);
            let step = ReckOnStep { counts: false, target: (at > 4).then_some(target) };
            let Some(ReckOnAnswer::Potentials(outputs)) = sample.step(step).unwrap() else {
                panic!("no potentials")
            };
            let away = |output: i16, target: i32| (i32::from(output) - target).abs();
            if at > 4 {
                error += away(outputs[0], 300) + away(outputs[1], -200) + away(outputs[2], 50);
            }
        }
        errors.push(error);
        started = sample.end().unwrap().1;
    }
    let (first, last) = (errors[0], errors[errors.len() - 1]);
    assert!(2 * last < first, "{errors:?}");
    let mut programmed = started.program().unwrap();
    assert!(programmed.verify(&NETWORK).is_err(), "weights have moved");
}

#[test]
fn a_label_is_told_once_and_learnt() {
    let board = Board::new(10, 1);
    let mut chip = on(&board);
    let mut programmed = chip.reset(&mut board.clone()).unwrap();
    programmed.load(&NETWORK, |_| ()).unwrap();
    let settings = ReckOnSettings {
        learning: Some(ReckOnLearning { is_linear: false, ..LEARNING }),
        ..ReckOnSettings::LABEL
    };
    let mut sample = programmed.run(&settings).unwrap().begin().unwrap();
    for _ in 0..20 {
        sample.send(1).unwrap();
        let target = Some(ReckOnTarget::Label(2));
        sample.step(ReckOnStep { counts: true, target }).unwrap();
    }
    assert!(matches!(sample.end().unwrap().0, ReckOnAnswer::Label(0..=2)));
    assert!(chip.started().unwrap().program().unwrap().verify(&NETWORK).is_err());
}

#[test]
fn a_target_that_does_not_fit_is_refused_and_the_sample_goes_on() {
    let board = Board::new(10, 1);
    let mut chip = on(&board);
    let mut programmed = chip.reset(&mut board.clone()).unwrap();
    programmed.load(&NETWORK, |_| ()).unwrap();
    let mut sample = programmed.run(&ReckOnSettings::POTENTIALS).unwrap().begin().unwrap();
    let with = |target| ReckOnStep { counts: false, target: Some(target) };
    // Without learning, every target is refused.
    for target in [ReckOnTarget::Label(0), ReckOnTarget::Potentials(&[1, 2, 3])] {
        assert!(matches!(sample.step(with(target)), Err(Error::OutOfRange { .. })));
    }
    assert!(matches!(sample.send(5), Err(Error::OutOfRange { .. })));
    sample.step(ReckOnStep::default()).unwrap();

    let settings = ReckOnSettings { learning: Some(LEARNING), ..ReckOnSettings::POTENTIALS };
    let programmed = sample.end().unwrap().1.program().unwrap();
    let mut sample = programmed.run(&settings).unwrap().begin().unwrap();
    for target in [ReckOnTarget::Label(0), ReckOnTarget::Potentials(&[1])] {
        assert!(matches!(sample.step(with(target)), Err(Error::OutOfRange { .. })));
    }
    sample.step(with(ReckOnTarget::Potentials(&[1, 2, 3]))).unwrap();
}

#[test]
fn settings_that_the_chip_has_no_bits_for_are_refused() {
    let with = |learning| ReckOnSettings { learning: Some(learning), ..ReckOnSettings::POTENTIALS };
    let label = ReckOnSettings { task: ReckOnTask::Regression, ..ReckOnSettings::LABEL };
    for (settings, message) in [
        (label, "label of a regression 1 must lie in 0..=0"),
        (with(ReckOnLearning { signal: 16, ..LEARNING }), "signal 16 must lie in 0..=15"),
        (with(ReckOnLearning { traces: [0, 8, 0], ..LEARNING }), "trace 8 must lie in 0..=7"),
        (
            with(ReckOnLearning { slopes: [1, 4, 16, 8, 4], ..LEARNING }),
            "slope 16 must lie in -16..=15",
        ),
        (with(ReckOnLearning { rates: [(8, 32); 3], ..LEARNING }), "rate 32 must lie in 0..=31"),
    ] {
        let board = Board::new(10, 1);
        let mut chip = on(&board);
        let programmed = chip.reset(&mut board.clone()).unwrap();
        assert_eq!(programmed.run(&settings).err().unwrap().to_string(), message);
    }
}

/// Every weight of a loaded network can be read back, for example after the chip has learnt.
#[test]
fn each_weight_can_be_read() {
    let board = Board::new(10, 1);
    let mut chip = on(&board);
    let mut programmed = chip.reset(&mut board.clone()).unwrap();
    programmed.load(&NETWORK, |_| ()).unwrap();
    programmed.verify(&NETWORK).unwrap();
    for neuron in 0..4_u8 {
        let at = usize::from(neuron);
        for input in 0..5_u8 {
            let weight = programmed.input_weight(input, neuron).unwrap();
            assert_eq!(weight, NETWORK.inputs[usize::from(input)][at]);
        }
        for from in 0..4_u8 {
            let weight = programmed.recurrent_weight(from, neuron).unwrap();
            assert_eq!(weight, RECURRENT[usize::from(from)][at]);
        }
        for output in 0..3_u8 {
            let weight = programmed.output_weight(neuron, output).unwrap();
            assert_eq!(weight, NETWORK.outputs[at][usize::from(output)]);
        }
    }
    assert!(matches!(programmed.output_weight(0, 16), Err(Error::OutOfRange { .. })));
}

#[test]
fn loading_says_how_far_it_is() {
    let board = Board::new(10, 1);
    let mut chip = on(&board);
    let mut programmed = chip.reset(&mut board.clone()).unwrap();
    let mut reports = Vec::new();
    programmed.load(&NETWORK, |progress| reports.push(progress)).unwrap();
    assert!(reports.is_sorted_by_key(|progress| progress.done));
    let last = reports.pop().unwrap();
    assert_eq!(last.done, last.total);
}

/// Loads a network whose outputs take two words in each row. Registers 65 to 68 have one bit for each pair of neurons,
/// including the unused pairs. The bit is 1 if `keep`, the share of the potential that a time step keeps, is 32 768 or
/// more.
#[test]
fn many_pairs_and_outputs_are_loaded() {
    static MOSTLY_GROW: [ReckOnPair; 33] = {
        let mut pairs = [ReckOnPair { keep: 36_000, threshold: 9 }; 33];
        pairs[32].keep = 32_000;
        pairs
    };
    let wide = ReckOnNetwork::<1, 66, 5> {
        pairs: &MOSTLY_GROW,
        inputs: [[1; 66]],
        recurrent: &[[0; 66]; 66],
        outputs: [[1; 5]; 66],
        shared: NETWORK.shared,
    };
    let board = Board::new(10, 1);
    let mut chip = on(&board);
    let mut programmed = chip.reset(&mut board.clone()).unwrap();
    let mut reports = Vec::new();
    programmed.load(&wide, |progress| reports.push(progress)).unwrap();
    let last = reports.pop().unwrap();
    assert_eq!(last.done, last.total);
    let grows = [65, 66, 67, 68].map(|register| board.pins().chip.register_value(register));
    assert_eq!(grows, [u32::MAX, !1, u32::MAX, u32::MAX], "one of 128 does not");
}

/// Each slope of the surrogate gradient is written to its register as a signed number of five bits.
#[test]
fn slopes_are_written_with_their_sign() {
    let board = Board::new(10, 1);
    let mut chip = on(&board);
    let learning = ReckOnLearning { slopes: [-16, -1, 0, 5, 15], ..LEARNING };
    let settings = ReckOnSettings { learning: Some(learning), ..ReckOnSettings::POTENTIALS };
    chip.reset(&mut board.clone()).unwrap().run(&settings).unwrap();
    let slopes = [74, 75, 76, 77, 78].map(|register| board.pins().chip.register_value(register));
    assert_eq!(slopes, [16, 31, 0, 5, 15]);
}

/// Faults of the port: levels at which `AERIN_ACK` and `OUT_REQ` are stuck, and an answer with the wrong number of
/// bytes.
#[derive(Default)]
struct Lines {
    acknowledge: Cell<Option<bool>>,
    request: Cell<Option<bool>>,
    bytes: Cell<Option<u32>>,
}

/// A port that passes calls on to `port`, but shows the faults that `lines` selects.
struct FaultyPort<'a> {
    port: Port,
    lines: &'a Lines,
    is_taken: bool,
}

impl ReckOnPort for FaultyPort<'_> {
    type Error = u64;

    fn set_input(&mut self, byte: u8, is_target: bool) -> Result<(), u64> {
        self.port.set_input(byte, is_target)
    }
    fn set_input_request(&mut self, is_high: bool) -> Result<(), u64> {
        self.port.set_input_request(is_high)
    }
    fn input_acknowledge(&mut self) -> Result<bool, u64> {
        let pin = self.port.input_acknowledge()?;
        Ok(self.lines.acknowledge.get().unwrap_or(pin))
    }
    fn output_request(&mut self) -> Result<bool, u64> {
        let pin = self.port.output_request()?;
        let reports = self.lines.bytes.get().map(|left| left > 0 && !self.is_taken);
        Ok(self.lines.request.get().or(reports).unwrap_or(pin))
    }
    fn output(&mut self) -> Result<u8, u64> {
        self.port.output()
    }
    fn set_output_acknowledge(&mut self, is_high: bool) -> Result<(), u64> {
        if !is_high && self.is_taken {
            self.lines.bytes.set(self.lines.bytes.get().map(|left| left - 1));
        }
        self.is_taken = is_high && self.lines.bytes.get().is_some();
        self.port.set_output_acknowledge(is_high)
    }
    fn set_sample(&mut self, is_high: bool) -> Result<(), u64> {
        self.port.set_sample(is_high)
    }
    fn set_tick(&mut self, is_high: bool) -> Result<(), u64> {
        self.port.set_tick(is_high)
    }
    fn set_target_valid(&mut self, is_high: bool) -> Result<(), u64> {
        self.port.set_target_valid(is_high)
    }
    fn set_infer(&mut self, is_high: bool) -> Result<(), u64> {
        self.port.set_infer(is_high)
    }
    fn ready(&mut self) -> Result<bool, u64> {
        let pin = self.port.ready()?;
        Ok(pin || self.lines.bytes.get() == Some(0))
    }
    fn set_reset(&mut self, is_high: bool) -> Result<(), u64> {
        self.port.set_reset(is_high)
    }
}

/// Begins a sample on a chip without a network, sets faults of the pins with `set`, and returns the result of `act` on
/// the sample. Without a network, an answer with potentials has all 16 outputs.
fn with_faults<T>(
    settings: &ReckOnSettings,
    set: impl Fn(&Lines),
    act: impl Fn(&mut ReckOnSample<'_, Spi, FaultyPort<'_>>) -> T,
) -> T {
    let (board, lines) = (Board::new(10, 1), Lines::default());
    let port = FaultyPort { port: board.port(), lines: &lines, is_taken: false };
    let mut chip = ReckOn::new(board.spi(), port, Chip::MAX_CLOCKS);
    let started = chip.reset(&mut board.clone()).unwrap().run(settings).unwrap();
    let mut sample = started.begin().unwrap();
    set(&lines);
    act(&mut sample)
}

#[test]
fn a_line_that_stays_as_it_is_ends_the_handshake() {
    let settings = &ReckOnSettings::POTENTIALS;
    let silent =
        with_faults(settings, |lines| lines.acknowledge.set(Some(false)), |sample| sample.send(0));
    assert_eq!(silent, Err(Error::Handshake(Phase::Acknowledge)));
    let stuck = with_faults(
        settings,
        |lines| lines.request.set(Some(true)),
        |sample| sample.step(ReckOnStep::default()),
    );
    assert_eq!(stuck, Err(Error::Handshake(Phase::Release)));
}

/// An answer with potentials must have two bytes for each of 16 outputs, and a label must have one byte. Any other
/// length is an error.
#[test]
fn an_answer_of_the_wrong_length_is_an_error() {
    let answer = |settings, bytes| {
        let set = |lines: &Lines| lines.bytes.set(Some(bytes));
        with_faults(settings, set, |sample| sample.step(ReckOnStep::default()))
    };
    let potentials = |bytes| answer(&ReckOnSettings::POTENTIALS, bytes);
    assert!(matches!(potentials(32), Ok(Some(ReckOnAnswer::Potentials(_)))));
    assert_eq!([1, 31, 33].map(potentials), [1, 31, 33].map(|_| Err(Error::Unfinished)));
    let label = |bytes| answer(&ReckOnSettings::LABEL, bytes);
    // The chip sends a label in every step, which proves the step, but the driver returns only the label after the
    // sample.
    assert_eq!(label(1), Ok(None));
    assert_eq!([2, 32].map(label), [2, 32].map(|_| Err(Error::Unfinished)));
}

/// An SPI device that drops the write to register 0, so that the chip's memories stay open.
#[derive(Debug)]
struct Open(Spi);

impl embedded_hal::spi::ErrorType for Open {
    type Error = ErrorKind;
}

impl SpiDevice for Open {
    fn transaction(
        &mut self,
        operations: &mut [embedded_hal::spi::Operation<'_, u8>],
    ) -> Result<(), ErrorKind> {
        // The header of a write of one word to register 0, and a value of 0.
        let close = [0, 1, 0, 0, 0, 0, 0, 0];
        match operations {
            [embedded_hal::spi::Operation::Write(bytes)] if **bytes == close => Ok(()),
            operations => self.0.transaction(operations),
        }
    }
}

#[test]
fn a_chip_whose_memories_stay_open_is_not_started() {
    let board = Board::new(10, 1);
    let mut chip = ReckOn::new(Open(board.spi()), board.port(), Chip::MAX_CLOCKS);
    let programmed = chip.reset(&mut board.clone()).unwrap();
    let error = programmed.run(&ReckOnSettings::POTENTIALS).map(drop).unwrap_err();
    assert_eq!(error, Error::NotStarted);
}

/// `verify` notices different parameters of a pair of neurons, but ignores potentials.
#[test]
fn verify_compares_the_parameters_of_pairs() {
    static OTHERS: [[ReckOnPair; 2]; 3] = [
        [PAIRS[0], ReckOnPair { keep: 0x88E8, ..PAIRS[1] }],
        [PAIRS[0], ReckOnPair { threshold: 251, ..PAIRS[1] }],
        [PAIRS[0], ReckOnPair { keep: 33_001, ..PAIRS[1] }],
    ];
    for pairs in &OTHERS {
        let board = Board::new(10, 1);
        let mut chip = on(&board);
        let mut programmed = chip.reset(&mut board.clone()).unwrap();
        programmed.load(&NETWORK, |_| ()).unwrap();
        // Changes part of a potential, as running the network does.
        board.pins().chip.neurons[1] ^= 0xF << 96;
        programmed.verify(&NETWORK).unwrap();
        let other = ReckOnNetwork { pairs, ..NETWORK };
        assert!(matches!(programmed.verify(&other), Err(Error::ReadBack { .. })));
    }
}

#[test]
fn words_are_those_of_the_chips_documentation() {
    #[derive(Debug, Default)]
    struct Heard(Vec<u8>);
    impl embedded_hal::spi::ErrorType for Heard {
        type Error = ErrorKind;
    }
    impl SpiDevice for Heard {
        fn transaction(
            &mut self,
            operations: &mut [embedded_hal::spi::Operation<'_, u8>],
        ) -> Result<(), ErrorKind> {
            for operation in operations {
                match operation {
                    embedded_hal::spi::Operation::Write(bytes) => self.0.extend_from_slice(bytes),
                    embedded_hal::spi::Operation::TransferInPlace(bytes) => {
                        self.0.extend_from_slice(bytes);
                    }
                    _ => panic!("neither"),
                }
            }
            Ok(())
        }
    }
    let board = Board::new(10, 1);
    let mut chip = ReckOn::new(Heard::default(), board.port(), 10);
    let error = chip.reset(&mut board.clone()).unwrap_err();
    assert!(matches!(error, ChipError::ReadBack { .. }));
    let (heard, _) = chip.release();
    let words: Vec<u32> =
        heard.0.as_chunks().0.iter().map(|&bytes| u32::from_be_bytes(bytes)).collect();
    // A write and a read of the output weights of row 0x1AA, which no network uses.
    assert_eq!(words, [0x5001_06A8, 0xA53C_0F96, 0xD001_06A8, 0xFFFF_0000]);
}

#[test]
fn a_tick_that_comes_too_early_stops_the_chip_and_the_driver_says_so() {
    let board = Board::new(10, 1);
    let mut chip = ReckOn::new(board.spi(), board.port(), 2_000);
    let mut programmed = chip.reset(&mut board.clone()).unwrap();
    programmed.load(&NETWORK, |_| ()).unwrap();
    let mut sample = programmed.run(&ReckOnSettings::POTENTIALS).unwrap().begin().unwrap();
    let mut pins = board.pins();
    for is_high in [true, false, true, false] {
        let mut inputs = pins.chip.inputs();
        inputs.tick = is_high;
        pins.chip.set_inputs(inputs);
        pins.chip.run(4);
    }
    pins.chip.run(1_000);
    assert!(pins.chip.timing_error() && pins.chip.outputs().error_or_ready);
    drop(pins);
    assert!(matches!(sample.step(ReckOnStep::default()), Err(Error::Handshake(_))));
    assert!(matches!(chip.sample().unwrap_err(), Error::NotReset));
}

#[test]
fn sample_falling_while_the_chip_learns_ends_in_an_answer() {
    let board = Board::new(10, 1);
    let mut chip = on(&board);
    let mut programmed = chip.reset(&mut board.clone()).unwrap();
    programmed.load(&NETWORK, |_| ()).unwrap();
    let settings = ReckOnSettings { learning: Some(LEARNING), ..ReckOnSettings::LABEL };
    let settings = ReckOnSettings { task: ReckOnTask::Classification, ..settings };
    let mut sample = programmed.run(&settings).unwrap().begin().unwrap();
    let step = ReckOnStep { counts: true, target: Some(ReckOnTarget::Label(1)) };
    sample.step(step).unwrap();
    let mut pins = board.pins();
    let mut inputs = pins.chip.inputs();
    inputs.tick = true;
    pins.chip.set_inputs(inputs);
    while pins.chip.state() != State::Learn {
        pins.chip.run(1);
    }
    inputs.sample = false;
    pins.chip.set_inputs(inputs);
    pins.chip.run(100_000);
    // Without an answer in each step, the chip would go on learning without end.
    assert_eq!(pins.chip.state(), State::Send);
}

#[test]
fn spi_needs_an_eighth_of_the_chips_clock_to_read() {
    let reads = |ratio: u32| {
        let board = Board::new(ratio, 1);
        let mut chip = on(&board);
        chip.reset(&mut board.clone()).is_ok()
    };
    let ratios: Vec<u32> = (2..16).filter(|&ratio| !reads(ratio)).collect();
    assert_eq!(ratios, [2, 3, 4, 5, 6, 7]);
}

/// Asserts that the chip's weights and registers are those of `network`.
fn assert_holds(board: &Board, network: &impl DescribeReckOn, at: &str) {
    let pins = board.pins();
    for input in 0..network.inputs() {
        for neuron in 0..network.neurons() {
            let word = pins.chip.input_weights[usize::from(input << 4 | neuron >> 4)];
            let weight = (word >> (8 * (neuron & 15))) as i8;
            assert_eq!(weight, network.input_weight(input, neuron), "{at}");
        }
    }
    for from in 0..network.neurons() {
        for to in 0..network.neurons() {
            let word = pins.chip.recurrent_weights[usize::from(from << 4 | to >> 4)];
            let weight = (word >> (8 * (to & 15))) as i8;
            assert_eq!(weight, network.recurrent_weight(from, to), "{at}");
        }
        for output in 0..network.outputs() {
            let weight = (pins.chip.output_weights[usize::from(from)] >> (8 * output)) as i8;
            assert_eq!(weight, network.output_weight(from, output), "{at}");
        }
    }
    assert_eq!([94, 95, 96].map(|register| pins.chip.register_value(register)), [4, 3, 2], "{at}");
    assert_eq!([12, 13, 14].map(|register| pins.chip.register_value(register)), [1, 2, 0], "{at}");
    assert_eq!(pins.chip.register_value(69), 110, "{at}");
}

/// Makes calls in random order, while up to three SPI clock pulses are lost or doubled and up to two calls of the port
/// fail. Asserts that the chip holds [`NETWORK`] whenever `load` or `verify` returns `Ok`, and that every answer is the
/// one that [`Plain`] computes in plain arithmetic.
fn search(seed: u64, count: &mut [u32; 2]) {
    let mut random = Pcg32::seed_from_u64(seed);
    let mut below = |end: u32| random.next_u32() % end;
    let ratio = 10 + below(10);
    let board = Board::new(ratio, 1 + below(4));
    let mut chip = ReckOn::new(board.spi(), board.port(), 3_000);
    let mut last = 0;
    for _ in 0..below(4) {
        // The faults lie further apart than the frame of a register and its check, because closer faults may cancel out
        // unnoticed.
        last += 400 + u64::from(below(240_000));
        let fault = if below(2) == 0 { ClockFault::Lost } else { ClockFault::Doubled };
        board.pins().clock_faults.push_back((last, fault));
    }
    let mut last = 0;
    for _ in 0..below(3) {
        last += 1 + u64::from(below(12_000));
        let fault = if below(2) == 0 { CallFault::Before } else { CallFault::After };
        board.pins().call_faults.push_back((last, fault));
    }
    let mut plain = Plain::NEW;
    let mut is_loaded = false;
    for call in 0..14 {
        let at = format!("seed {seed}, call {call}");
        let next = match () {
            () if chip.sample().is_ok() => 5,
            () if chip.started().is_ok() => 2,
            () if chip.programmed().is_ok() && is_loaded => 1,
            () => 0,
        };
        let any = below(6);
        let is_ok = match if below(3) == 0 { any } else { next } {
            0 => match chip.reset(&mut board.clone()) {
                Ok(mut programmed) => {
                    is_loaded = programmed.load(&NETWORK, |_| ()).is_ok();
                    if is_loaded {
                        assert_holds(&board, &NETWORK, &at);
                    }
                    is_loaded
                }
                Err(_) => false,
            },
            1 if is_loaded => match chip.programmed() {
                Ok(programmed) => programmed.run(&ReckOnSettings::POTENTIALS).is_ok(),
                Err(_) => false,
            },
            2 => {
                let begins = chip.started().is_ok_and(|started| started.begin().is_ok());
                if begins {
                    plain = Plain::NEW;
                }
                begins
            }
            3 => match chip.started().map(spikewire_chips::Started::program) {
                Ok(Ok(mut programmed)) => {
                    let is_same = programmed.verify(&NETWORK).is_ok();
                    if is_same {
                        assert_holds(&board, &NETWORK, &at);
                    }
                    is_same
                }
                _ => false,
            },
            4 => match chip.sample() {
                Ok(sample) => match sample.end() {
                    Ok((answer, _)) => {
                        assert_eq!(answer, ReckOnAnswer::Potentials(plain.step(&[])), "{at}");
                        true
                    }
                    Err(_) => false,
                },
                Err(_) => false,
            },
            _ => match chip.sample() {
                Ok(mut sample) => (0..below(12)).all(|_| {
                    let inputs: Vec<u8> = (0..5).filter(|_| below(3) == 0).collect();
                    let sent = inputs.iter().all(|&input| sample.send(input).is_ok());
                    if !sent {
                        return false;
                    }
                    match sample.step(ReckOnStep::default()) {
                        Ok(answer) => {
                            let reports = Some(ReckOnAnswer::Potentials(plain.step(&inputs)));
                            assert_eq!(answer, reports, "{at}");
                            true
                        }
                        Err(_) => false,
                    }
                }),
                Err(_) => false,
            },
        };
        count[usize::from(is_ok)] += 1;
    }
}

#[test]
fn calls_in_any_order_with_faults_are_right_or_refused() {
    let mut count = [0; 2];
    (0..4).for_each(|seed| search(seed, &mut count));
    assert!(count.iter().all(|&count| count > 10), "{count:?}");
}

#[test]
#[ignore = "takes minutes: run with --release"]
fn two_thousand_orders_with_faults_are_right_or_refused() {
    let mut count = [0; 2];
    (1_000..3_000).for_each(|seed| search(seed, &mut count));
    println!("calls refused, and Ok: {count:?}");
}

/// Returns the number of clock cycles from a tick until the chip is ready, for a network of `size` inputs and `size`
/// neurons, in a step with `events` inputs.
fn clocks_of_a_step(size: u16, events: u16) -> u64 {
    let board = Board::new(10, 1);
    let mut chip = on(&board);
    let mut programmed = chip.reset(&mut board.clone()).unwrap();
    programmed.set_register(94, u32::from(size) - 1).unwrap();
    programmed.set_register(95, u32::from(size) - 1).unwrap();
    board.pins().chip.neurons.fill(0x7FFF << 100);
    let started = programmed.run(&ReckOnSettings::LABEL).unwrap();
    started.begin().unwrap();
    let mut pins = board.pins();
    let mut inputs = pins.chip.inputs();
    for input in 0..events {
        (inputs.address, inputs.request) = (input as u8, true);
        pins.chip.set_inputs(inputs);
        pins.chip.run(5);
        inputs.request = false;
        pins.chip.set_inputs(inputs);
        pins.chip.run(5);
    }
    inputs.tick = true;
    pins.chip.set_inputs(inputs);
    pins.chip.run(4);
    let mut clocks = 4;
    while !pins.chip.is_ready() {
        // Leaves out the time of the answer, which depends on how quickly it is taken.
        clocks += u64::from(pins.chip.state() != State::Send);
        inputs.output_acknowledge = pins.chip.outputs().request;
        pins.chip.set_inputs(inputs);
        pins.chip.run(1);
    }
    clocks
}

#[test]
fn a_step_takes_two_clocks_a_neuron_and_one_for_each_event_and_neuron() {
    for size in [16, 64, 256] {
        for events in [0, 1, 7, size] {
            let [neurons, count] = [size, events].map(u64::from);
            assert_eq!(
                clocks_of_a_step(size, events),
                (2 + count) * neurons + 4,
                "{size} {events}"
            );
        }
    }
}

#[test]
fn a_banks_samples_are_time_steps_of_the_chip() {
    static RATES: Position<f32, 5> = Position::linear(-2.0..=2.0);
    let board = Board::new(10, 1);
    let mut chip = on(&board);
    let mut programmed = chip.reset(&mut board.clone()).unwrap();
    programmed.load(&NETWORK, |_| ()).unwrap();
    let mut sample = programmed.run(&ReckOnSettings::POTENTIALS).unwrap().begin().unwrap();
    let (mut bank, mut plain) = (Bank::<_, 1>::new(&RATES), Plain::NEW);
    for reading in crate::flight().take(2_000) {
        let mut inputs = vec![];
        let now = Tick::from(reading.micros);
        bank.encode(now, [reading.channels[0]], |event| inputs.push(event.address as u8));
        for &input in &inputs {
            sample.send(input).unwrap();
        }
        let answer = sample.step(ReckOnStep::default()).unwrap();
        assert_eq!(answer, Some(ReckOnAnswer::Potentials(plain.step(&inputs))));
    }
    assert!(board.pins().chip.fired.len() > 200);
}
