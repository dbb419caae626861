//! Events back to values: a readout gives what decoders beside the encoders give, and takes anything.

use proptest::prelude::*;
use rand_pcg::Pcg32;
use spikewire::population::{FiredNeurons, Neuron, Position, Probabilistic, SlotSpikes, Slots};
use spikewire::rate::{Hough, Taps};
use spikewire::temporal::StepForward;
use spikewire::{Bank, Code, Event, NeuronSpike, Output, Polarity, Readout, Spike, Start, Tick};

static STEP: StepForward<f32> = StepForward::new(0.2);
static POSITION: Position<f32, 9> = Position::linear(-1.0..=1.0);
static SLOTS: Slots<f32, 8, 50> = Slots::new(-1.0..=1.0, 1.5);
static HOUGH: Hough<f32, 5> = Hough::new(Taps::triangular(1.0)).with_shift(-1.2);

fn samples() -> impl Strategy<Value = Vec<[f32; 3]>> {
    prop::collection::vec(prop::array::uniform3(-1.2_f32..1.2), 1..60)
}

/// Through events and back, against the codes themselves.
fn agrees<P: Start<Sample = f32>>(scheme: &P, samples: &[[f32; 3]], start: u32, slot_ticks: u32) {
    let mut bank = Bank::<_, 3>::new(scheme).with_slot_ticks(slot_ticks);
    let mut readout = Readout::<_, 3>::new(scheme).with_slot_ticks(slot_ticks);
    let mut encoders = [(); 3].map(|()| scheme.encoder());
    let mut decoders = [(); 3].map(|()| scheme.decoder());
    for (index, &sample) in samples.iter().enumerate() {
        let tick = Tick::from(start) + index as u32 * 1_000;
        let mut events = Vec::new();
        bank.encode(tick, sample, |event| events.push(event));
        events.reverse(); // in any order
        let mut expected = [None; 3];
        for channel in 0..3 {
            let code = encoders[channel].encode(sample[channel]).code();
            expected[channel] = code.map(|code| decoders[channel].decode(code));
        }
        if let [Some(x), Some(y), Some(z)] = expected {
            assert_eq!(readout.decode(tick, &events), [x, y, z]);
        }
    }
}

/// Its decoders begin with a known value, go on from it, and begin anew.
#[test]
fn a_readout_is_set_and_reset() {
    let mut readout = Readout::<_, 2>::new(&STEP).try_with_first_address(10).unwrap();
    let up = |address| Event { tick: Tick::from(0), address, polarity: Polarity::Up };
    readout.resync(1, 3.0);
    readout.resync(2, 9.0); // there is no such channel
    assert_eq!(readout.decode(Tick::from(0), &[up(10), up(9), up(12)]), [0.2, 3.0]);
    assert_eq!(readout.decode(Tick::from(0), &[up(11)]), [0.2, 3.2]);
    readout.reset();
    assert_eq!(readout.decode(Tick::from(0), &[]), [0.0, 0.0]);
    let error = readout.try_with_first_address(0xFFFF).err().unwrap();
    assert_eq!(error.to_string(), "first address 65535 must lie in 0..=65534");
}

/// All 256 slots are legal: the last one too.
#[test]
fn the_last_of_256_slots_comes_back() {
    let scheme = Slots::<f32, 5, 256>::new(-1.0..=1.0, 1.5);
    let samples: Vec<_> = (-1_000..1_000).map(|i| [i as f32 / 900.0; 3]).collect();
    agrees(&scheme, &samples, 0, 3);
}

/// A probabilistic code needs a generator for its encoder, and nothing for its decoder.
#[test]
fn neurons_that_fire_by_chance_come_back() {
    type Chance = Probabilistic<f32, Pcg32, 8, 64>;
    static SCHEME: Chance = Chance::new(-1.0..=1.0, 1.5);
    let generators = [1, 2].map(|seed| Pcg32::new(seed, 0));
    let states = generators.clone().map(Chance::state);
    let mut bank = Bank::<_, 2>::with_states(&SCHEME, states);
    let mut readout = Readout::<_, 2>::new(&SCHEME);
    let mut encoders = generators.map(|generator| SCHEME.encoder(generator));
    let mut decoders = [(); 2].map(|()| spikewire::Scheme::decoder(&SCHEME));
    for step in 0..500_u32 {
        let samples = [(step as f32 * 0.1).sin(), (step as f32 * 0.07).cos()];
        let mut events = Vec::new();
        bank.encode(step.into(), samples, |event| events.push(event));
        let codes: [FiredNeurons<8>; 2] = [0, 1].map(|at: usize| encoders[at].encode(samples[at]));
        let expected = [0, 1].map(|at: usize| decoders[at].decode(codes[at]));
        assert_eq!(readout.decode(step.into(), &events), expected);
    }
}

proptest! {
    #![proptest_config(crate::common::cases(256))]

    #[test]
    fn every_code_comes_back(samples in samples(), start: u32) {
        agrees(&STEP, &samples, start, 0);
        agrees(&POSITION, &samples, start, 0);
        agrees(&SLOTS, &samples, start, 20);
        agrees(&HOUGH, &samples, start, 0);
    }

    #[test]
    fn anything_can_be_put_together(
        firings in prop::collection::vec((0_u16..20, any::<u16>(), any::<bool>()), 0..40),
        narrow in any::<bool>(),
    ) {
        let firings = firings.into_iter().map(|(neuron, slot, is_up)| NeuronSpike {
            neuron,
            slot: if narrow { slot % 60 } else { slot },
            polarity: if is_up { Polarity::Up } else { Polarity::Down },
        });
        Spike::assemble(firings.clone());
        let winner = Option::<Neuron<9>>::assemble(firings.clone());
        prop_assert_eq!(winner.is_some(), firings.clone().any(|firing| firing.neuron < 9));
        let volley = SlotSpikes::<8, 50>::assemble(firings.clone());
        let heard = firings.filter(|firing| firing.neuron < 8 && firing.slot < 50);
        prop_assert_eq!(volley.is_empty(), heard.clone().next().is_none());
        let earliest = heard.map(|firing| firing.slot).min();
        prop_assert_eq!(volley.iter().map(|(_, slot)| slot).min(), earliest);
    }

    #[test]
    fn a_readout_takes_events_of_any_time_and_address(
        events in prop::collection::vec((any::<u32>(), any::<u16>()), 0..40),
        tick: u32,
        slot_ticks: u32,
    ) {
        let events: Vec<Event> = events
            .into_iter()
            .map(|(tick, address)| Event { tick: tick.into(), address, polarity: Polarity::Up })
            .collect();
        let mut readout = Readout::<_, 3>::new(&SLOTS).with_slot_ticks(slot_ticks);
        prop_assert!(readout.decode(tick.into(), &events).iter().all(|value| value.is_finite()));
    }
}

#[test]
fn a_crowd_of_neurons_gives_one_answer() {
    let at = |neuron, slot| NeuronSpike { neuron, slot, polarity: Polarity::Up };
    let winner = |firings: &[NeuronSpike]| {
        Option::<Neuron<9>>::assemble(firings.iter().copied()).map(Neuron::index)
    };
    assert_eq!(winner(&[at(4, 0), at(2, 0), at(4, 0)]), Some(4));
    assert_eq!(winner(&[at(4, 0), at(2, 0)]), Some(2));
    assert_eq!(winner(&[at(9, 0)]), None);

    let volley = |firings: &[NeuronSpike]| {
        SlotSpikes::<8, 50>::assemble(firings.iter().copied()).iter().collect::<Vec<_>>()
    };
    let firings = [at(1, 9), at(3, 7), at(4, 2), at(4, 1), at(5, 30), at(7, 3)];
    assert_eq!(volley(&firings), [(3, 7), (4, 1), (5, 30)]);
    assert_eq!(volley(&[at(0, 50), at(8, 0)]), []);

    let down = NeuronSpike { polarity: Polarity::Down, ..at(0, 0) };
    assert_eq!(Spike::assemble([down, at(0, 0), down].into_iter()), Spike::Down);
    assert_eq!(Spike::assemble([down, at(0, 0)].into_iter()), Spike::None);
}
