//! Tests of the driver of `ReckOn` with slow pins: each call of the port takes many clock cycles of the chip, and the
//! driver must return the same answers as with fast pins, for networks of any size.

use std::cell::Cell;

use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use silicon::reckon::{Board, Port, Spi};
use spikewire_chips::{
    ChipError, DescribeReckOn, ReckOn, ReckOnAnswer, ReckOnAnswers, ReckOnPair, ReckOnPort,
    ReckOnSettings, ReckOnShared, ReckOnStep, Started,
};

/// A network with random weights and three outputs. It has as many inputs as neurons, but never more than eight inputs.
struct RandomNetwork {
    neurons: u16,
}

/// Returns a random weight that depends only on the arguments. `kind` is 0 for weights from inputs, 1 for weights
/// between neurons, and 2 for weights to outputs.
fn weight(kind: u64, from: u16, to: u16) -> i8 {
    let place = kind << 32 | u64::from(from) << 16 | u64::from(to);
    Pcg32::seed_from_u64(place).next_u32() as i8
}

impl DescribeReckOn for RandomNetwork {
    fn neurons(&self) -> u16 {
        self.neurons
    }
    fn inputs(&self) -> u16 {
        self.neurons.min(8)
    }
    fn outputs(&self) -> u16 {
        3
    }
    fn pair(&self, _: u16) -> ReckOnPair {
        ReckOnPair { keep: 30_000, threshold: 200 }
    }
    fn input_weight(&self, input: u16, neuron: u16) -> i8 {
        weight(0, input, neuron)
    }
    fn recurrent_weight(&self, from: u16, to: u16) -> i8 {
        weight(1, from, to) / 8
    }
    fn output_weight(&self, neuron: u16, output: u16) -> i8 {
        weight(2, neuron, output)
    }
    fn shared(&self) -> ReckOnShared {
        ReckOnShared { shifts: [2, 0, 0], keep: 110, resets_to_zero: true }
    }
}

/// Pace of the port: the chip's clock cycles that pass in each call before the pin is read or set, and those that pass
/// afterwards. Also selects a tick that is lost.
#[derive(Default)]
struct Pace {
    before: Cell<u32>,
    after: Cell<u32>,
    /// Number of the tick that does not reach the chip, where the first tick is 0; `None` if all ticks reach the chip.
    lost: Cell<Option<u32>>,
    /// Number of ticks so far.
    ticks: Cell<u32>,
}

struct Slow<'a> {
    port: Port,
    board: Board,
    pace: &'a Pace,
}

impl Slow<'_> {
    fn slowly<T>(&mut self, call: impl FnOnce(&mut Port) -> T) -> T {
        self.board.run(self.pace.before.get());
        let result = call(&mut self.port);
        self.board.run(self.pace.after.get());
        result
    }
}

impl ReckOnPort for Slow<'_> {
    type Error = u64;

    fn set_input(&mut self, byte: u8, is_target: bool) -> Result<(), u64> {
        self.slowly(|port| port.set_input(byte, is_target))
    }
    fn set_input_request(&mut self, is_high: bool) -> Result<(), u64> {
        self.slowly(|port| port.set_input_request(is_high))
    }
    fn input_acknowledge(&mut self) -> Result<bool, u64> {
        self.slowly(Port::input_acknowledge)
    }
    fn output_request(&mut self) -> Result<bool, u64> {
        self.slowly(Port::output_request)
    }
    fn output(&mut self) -> Result<u8, u64> {
        self.slowly(Port::output)
    }
    fn set_output_acknowledge(&mut self, is_high: bool) -> Result<(), u64> {
        self.slowly(|port| port.set_output_acknowledge(is_high))
    }
    fn set_sample(&mut self, is_high: bool) -> Result<(), u64> {
        self.slowly(|port| port.set_sample(is_high))
    }
    fn set_tick(&mut self, is_high: bool) -> Result<(), u64> {
        let tick = self.pace.ticks.get();
        let is_lost = self.pace.lost.get() == Some(tick);
        self.pace.ticks.set(tick + u32::from(!is_high));
        self.slowly(|port| if is_lost { Ok(()) } else { port.set_tick(is_high) })
    }
    fn set_target_valid(&mut self, is_high: bool) -> Result<(), u64> {
        self.slowly(|port| port.set_target_valid(is_high))
    }
    fn set_infer(&mut self, is_high: bool) -> Result<(), u64> {
        self.slowly(|port| port.set_infer(is_high))
    }
    fn ready(&mut self) -> Result<bool, u64> {
        self.slowly(Port::ready)
    }
    fn set_reset(&mut self, is_high: bool) -> Result<(), u64> {
        self.slowly(|port| port.set_reset(is_high))
    }
}

type Error = ChipError<embedded_hal::spi::ErrorKind, u64>;

/// Number of time steps in a sample.
const STEPS: u32 = 6;

const SETTINGS: [ReckOnSettings; 3] = [
    ReckOnSettings::LABEL,
    ReckOnSettings { answers: ReckOnAnswers::Potentials, ..ReckOnSettings::POTENTIALS },
    ReckOnSettings::POTENTIALS,
];

/// Makes a board, and a driver for its chip. Each call of the driver's port takes the clock cycles that `pace` holds at
/// the time of the call.
fn on<'a>(pace: &'a Pace) -> (Board, ReckOn<Spi, Slow<'a>>) {
    let board = Board::new(10, 0);
    let port = Slow { port: board.port(), board: board.clone(), pace };
    let chip = ReckOn::new(board.spi(), port, ReckOn::<Spi, Slow<'a>>::MAX_CLOCKS);
    (board, chip)
}

/// The answers in a sample, and the neurons that fired in it.
type Answered = (Vec<Option<ReckOnAnswer>>, Vec<u8>);

fn sample<'a, 'b>(
    started: Started<'a, Spi, Slow<'b>>,
    board: &Board,
    inputs: u16,
) -> Result<(Answered, Started<'a, Spi, Slow<'b>>), Error> {
    board.pins().chip.fired.clear();
    let mut sample = started.begin()?;
    let mut answers = vec![];
    for step in 0..STEPS {
        for input in (0..inputs).filter(|input| (u32::from(*input) + step) % 3 != 2) {
            sample.send(input as u8)?;
        }
        answers.push(sample.step(ReckOnStep { counts: true, target: None })?);
    }
    let (last, started) = sample.end()?;
    answers.push(Some(last));
    let fired = board.pins().chip.fired.clone();
    Ok(((answers, fired), started))
}

/// Checks that calls of the port that take up to 26 clock cycles change no answer of a network of `neurons` neurons.
/// A slow call can miss the time in which the ready pin is low. With up to 10 neurons it can miss it in every step,
/// because the pin is low for at most 26 clock cycles. With 11 to 25 neurons it can miss it only at the first tick of a
/// sample. Networks of 32 neurons and more are tried with calls of 1 and 26 clock cycles only.
fn read_seldom(neurons: u16) {
    let network = RandomNetwork { neurons };
    let pace = Pace::default();
    let (board, mut chip) = on(&pace);
    pace.before.set(1);
    let mut programmed = chip.reset(&mut board.clone()).unwrap();
    programmed.load(&network, |_| ()).unwrap();
    let every = if neurons < 32 { 1 } else { 25 };
    for settings in &SETTINGS {
        let started = programmed.run(settings).unwrap();
        let (expected, mut started) = sample(started, &board, network.inputs()).unwrap();
        assert!(neurons < 8 || !expected.1.is_empty(), "{neurons} neurons: none fires");
        for clocks in (1..=26).step_by(every) {
            for (before, after) in [(clocks, 0), (1, clocks - 1)] {
                let at = format!("{neurons} neurons, {settings:?}, {before} and {after} clocks");
                pace.before.set(before);
                pace.after.set(after);
                let (answered, next) = sample(started, &board, network.inputs())
                    .unwrap_or_else(|error| panic!("{at}: {error}"));
                assert_eq!(answered, expected, "{at}");
                started = next;
            }
        }
        pace.before.set(1);
        pace.after.set(0);
        programmed = started.program().unwrap();
    }
    programmed.verify(&network).unwrap();
}

#[test]
fn pins_that_are_read_seldom_change_no_answer() {
    [1, 2, 3, 5, 8, 10, 11, 12, 16, 20, 24, 25, 26, 32, 64, 256].into_iter().for_each(read_seldom);
}

#[test]
#[ignore = "256 networks are loaded, bit by bit"]
fn pins_that_are_read_seldom_change_no_answer_in_a_network_of_any_size() {
    (1..=256).for_each(read_seldom);
}

/// If a tick does not reach the chip, the driver must return an error, and never the answer to a different step. The
/// test tries fast and slow calls of the port.
#[test]
fn a_tick_that_is_lost_is_an_error_before_an_answer_is_wrong() {
    for neurons in [2, 16, 64] {
        let network = RandomNetwork { neurons };
        let pace = Pace::default();
        let (board, mut chip) = on(&pace);
        pace.before.set(1);
        chip.reset(&mut board.clone()).unwrap().load(&network, |_| ()).unwrap();
        for settings in &SETTINGS {
            for (lost, clocks) in (0..=STEPS + 1).flat_map(|lost| [1, 9, 26].map(|at| (lost, at))) {
                pace.before.set(1);
                let mut programmed = chip.reset(&mut board.clone()).unwrap();
                // A reset keeps the memories but clears the registers, so write the registers of the network again.
                let last = u32::from(neurons) - 1;
                for (register, value) in
                    [(12, 2), (8, 1), (69, 110), (94, last.min(7)), (95, last | 1), (96, 2)]
                {
                    programmed.set_register(register, value).unwrap();
                }
                let started = programmed.run(settings).unwrap();
                pace.ticks.set(0);
                pace.lost.set(Some(lost));
                pace.before.set(clocks);
                let result =
                    sample(started, &board, network.inputs()).map(|(answered, _)| answered);
                let at = format!("tick {lost}, {neurons} neurons, {settings:?}, {clocks} clocks");
                let is_said =
                    matches!(result, Err(ChipError::Handshake(_) | ChipError::Unfinished));
                assert!(is_said, "{at}: {result:?}");
                assert!(matches!(chip.sample(), Err(ChipError::NotReset)), "{at}");
                pace.lost.set(None);
            }
        }
    }
}
