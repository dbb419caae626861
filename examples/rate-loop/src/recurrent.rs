//! A recurrent network that was trained on a flight, as `spikewire network` brought it onto ReckOn: has the aircraft rolled
//! one way in the last 0.2 s, the other way, or neither? Through the stretches of the flight that its training never saw.

use crate::{
    rates,
    rig::tenths,
    tape::{Tape, Taped},
    turns::{NETWORK, STEPS},
};
use board::digest::Digest;
use board::stopwatch::instructions;
use core::fmt::{self, Write};
use silicon::reckon::{Board, Port, Spi};
use spikewire::{Scheme, population::Position};
use spikewire_chips::{ReckOn, ReckOnSample, ReckOnSettings, ReckOnStepsState};

/// As `--scheme position --neurons 25 --min=-1.2 --max 1.2`.
static RATES: Position<f32, 25> = Position::linear(-1.2..=1.2);

/// As `turns.py` has them: samples of a stretch, of which each third is held out; samples that a label looks back; and
/// the mean rate in rad/s above which the aircraft rolls.
const STRETCH: usize = 250;
const PAST: usize = 40;
const TURNS: f64 = 0.06;

/// Clocks of the chip to one of SCK, and to a look at its pins: at 10 MHz, beside an STM32F405, 1 MHz and 34 cycles.
const RATIO: u32 = 10;
const LOOK: u32 = 2;

/// Number of steps from an input to the answer that shows its effect.
const LATE: usize = STEPS.late as usize;

type Chip = ReckOn<Spi, Taped<Port>>;

fn held_out() -> impl Iterator<Item = f32> {
    let rates = rates().enumerate().filter(|(at, _)| at / STRETCH % 3 == 2);
    rates.map(|(_, (_, rate))| rate)
}

pub fn fly(out: &mut impl Write) -> fmt::Result {
    let board = Board::new(RATIO, LOOK);
    let tape = Tape::new();
    let mut chip = Chip::new(board.spi(), Taped { port: board.port(), tape }, Chip::MAX_CLOCKS);
    let mut programmed = chip.reset(&mut board.clone()).map_err(|_| fmt::Error)?;
    programmed.load(&NETWORK, |_| ()).map_err(|_| fmt::Error)?;
    let started = programmed.run(&ReckOnSettings::POTENTIALS).map_err(|_| fmt::Error)?;
    let bits = board.pins().spi_clocks;
    writeln!(
        out,
        "turns: 32 neurons, loaded and verified in {} frames, {} ms at 1 MHz",
        bits / 64,
        bits / 1000
    )?;
    let mut sample = started.begin().map_err(|_| fmt::Error)?;
    let mut state = ReckOnStepsState::REST;
    let mut encoder = RATES.encoder();
    let mut labels = Labels::new();
    // The labels of the steps whose answers have not come yet.
    let mut waiting = [1; LATE];
    let mut digest = Digest::new();
    let mut counts = [0_u32; 3];
    let (mut right, mut spikes, mut steps) = (0_u32, 0_usize, 0_u32);
    let (mut clocks, mut driver, mut most) = (0, 0_u64, 0);
    let count = held_out().count();
    board.pins().chip.fired.clear();
    for (step, rate) in held_out().map(Some).chain([None; LATE]).enumerate() {
        let input = rate.and_then(|rate| encoder.encode(rate));
        let before = board.pins().chip.clocks;
        tape.record();
        let input = input.map(|neuron| neuron.index());
        let mut next = state;
        let answer = run(&mut sample, &mut next, input)?;
        clocks += board.pins().chip.clocks - before;
        let fired = core::mem::take(&mut board.pins().chip.fired).len();
        // What the last inputs make fire comes a tick later; what comes after those no recording has.
        spikes += if step <= count { fired } else { 0 };

        tape.repeat();
        let mut again = Err(fmt::Error);
        let cost = instructions(|| again = run(&mut sample, &mut state, input));
        if again? != answer || !tape.is_over() {
            return Err(fmt::Error);
        }
        (driver, most) = (driver + u64::from(cost), most.max(cost));
        tape.record();
        steps += 1;

        let label = core::mem::replace(&mut waiting[step % LATE], labels.of(rate.unwrap_or(0.0)));
        if step < LATE {
            continue;
        }
        let told = (1..3).fold(0, |best, at| if answer[at] > answer[best] { at } else { best });
        let [falls, neither, rises] = answer.map(f32::to_bits);
        digest.add([falls, neither]);
        digest.add([rises, told as u32]);
        counts[told] += 1;
        right += u32::from(told == label);
    }
    let [falls, neither, rises] = counts;
    writeln!(
        out,
        "turns: {spikes} spikes, {right} of {count} labels right: {falls} falls, {neither} neither, {rises} rises, {digest}"
    )?;
    writeln!(out, "turns: a time step takes the chip {} clocks", tenths(clocks, steps))?;
    if cfg!(target_os = "none") {
        let driver = tenths(driver, steps);
        writeln!(
            out,
            "turns: a time step takes the core {driver} instructions to send, tick, wait and take the answer, {most} at most"
        )?;
    }
    Ok(())
}

/// A time step: the input, if there is one, the tick, and the answer.
fn run(
    sample: &mut ReckOnSample<'_, Spi, Taped<Port>>,
    state: &mut ReckOnStepsState,
    input: Option<u16>,
) -> Result<[f32; 3], fmt::Error> {
    let outputs = sample.run(&STEPS, state, input).map_err(|_| fmt::Error)?;
    let [falls, neither, rises, ..] = outputs;
    Ok([falls, neither, rises])
}

/// What the network should say, by the mean of the last rates.
struct Labels {
    rates: [f64; PAST],
    at: usize,
}

impl Labels {
    const fn new() -> Self {
        Self { rates: [0.0; PAST], at: 0 }
    }

    fn of(&mut self, rate: f32) -> usize {
        self.rates[self.at] = rate.into();
        self.at = (self.at + 1) % PAST;
        let mean = self.rates.iter().sum::<f64>() / PAST as f64;
        match mean {
            mean if mean < -TURNS => 0,
            mean if mean > TURNS => 2,
            _ => 1,
        }
    }
}
