//! A trained network, as `spikewire network` brought it onto the chip: does the aircraft roll one way, the other, or
//! neither?

use crate::{rates, rig::Rig, roll, tape::Tape};
use board::digest::Digest;
use core::fmt::{self, Write};
use spikewire::{Bank, Event, population::Position};
use spikewire_chips::{Describe, Spikes, TinyOdinInput};

/// As `--scheme position --neurons 20 --min -2 --max 2`.
static RATES: Position<f32, 20> = Position::linear(-2.0..=2.0);

pub fn fly(out: &mut impl Write) -> fmt::Result {
    // The steps are the samples', not those of a clock: each has its leak, its bias and its spikes as in training.
    let mut rig = Rig::start(&roll::NETWORK, core::num::NonZeroU32::MAX, Tape::new(), "roll", out)?;
    let mut bank = Bank::<_, 1>::new(&RATES);
    let mut digest = Digest::new();
    let mut counts = [0_u32; 3];
    for (step, (now, rate)) in rates().enumerate() {
        let mut events = Spikes::<4>::new();
        if step > 0 && step as u32 % roll::STEPS_A_LEAK == 0 {
            events.push(of(now, LEAK));
        }
        events.push(of(now, roll::BIAS));
        bank.encode(now, [rate], |event| events.push(event));
        let answers = roll::NETWORK.answers(now, |event| {
            digest.add([event.tick.micros(), event.address.into()]);
            counts[usize::from(event.address)] += 1;
        });
        rig.step(events.as_slice(), input, answers)?;
    }
    let [falls, holds, rises] = counts;
    let all = falls + holds + rises;
    writeln!(
        out,
        "roll: {all} spikes back, {falls} falls, {holds} holds, {rises} rises, {digest}"
    )?;
    rig.cost.print("roll", out)
}

/// No input: a leak of all neurons.
const LEAK: u16 = u16::MAX;

fn of(tick: spikewire::Tick, address: u16) -> Event {
    Event { tick, address, polarity: spikewire::Polarity::Up }
}

fn input(event: Event) -> TinyOdinInput {
    roll::NETWORK.input(event.address).unwrap_or(TinyOdinInput::LeakAll)
}
