//! Events back to values: a readout gives what decoders beside the encoders give, and takes anything.

use proptest::prelude::*;
use spikewire::population::{Centres, Neuron, Position, ReceptiveFields, Slots, Volley};
use spikewire::rate::{Hough, Taps};
use spikewire::temporal::StepForward;
use spikewire::{
    Assemble, Bank, Decoder, Encoder, Event, Firing, Output, Polarity, Readout, Scheme, Spike, Tick,
};

static CENTRES: Centres<f32, 9> = Centres::<f32, _>::linear(-1.0, 1.0);
static FIELDS: ReceptiveFields<f32, 8, 50> = ReceptiveFields::<f32, _, _>::checked(-1.0, 1.0, 1.5);
static TAPS: Taps<f32, 5> = Taps::<f32, _>::triangular(1.0);

fn samples() -> impl Strategy<Value = Vec<[f32; 3]>> {
    prop::collection::vec(prop::array::uniform3(-1.2_f32..1.2), 1..60)
}

/// Through events and back, against the codes themselves.
fn agrees<P: Scheme<Sample = f32>>(scheme: P, samples: &[[f32; 3]], start: u32, slot_ticks: u32)
where
    <P::Decoder as Decoder>::Code: Assemble,
{
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

/// All 256 slots are legal: the last one too.
#[test]
fn the_last_of_256_slots_comes_back() {
    let fields = ReceptiveFields::<f32, 5, 256>::new(-1.0, 1.0, 1.5).unwrap();
    let samples: Vec<_> = (-1_000..1_000).map(|i| [i as f32 / 900.0; 3]).collect();
    agrees(Slots::new(&fields), &samples, 0, 3);
}

proptest! {
    #[test]
    fn every_code_comes_back(samples in samples(), start: u32) {
        agrees(StepForward::<f32>::checked(0.2), &samples, start, 0);
        agrees(Position::new(&CENTRES), &samples, start, 0);
        agrees(Slots::new(&FIELDS), &samples, start, 20);
        agrees(Hough::new(&TAPS).with_shift(-1.2).unwrap(), &samples, start, 0);
    }

    #[test]
    fn anything_can_be_put_together(
        firings in prop::collection::vec((0_u16..20, any::<u16>(), any::<bool>()), 0..40),
        narrow in any::<bool>(),
    ) {
        let firings = firings.into_iter().map(|(neuron, slot, is_up)| Firing {
            neuron,
            slot: if narrow { slot % 60 } else { slot },
            polarity: if is_up { Polarity::Up } else { Polarity::Down },
        });
        Spike::assemble(firings.clone());
        let winner = Option::<Neuron<9>>::assemble(firings.clone());
        prop_assert_eq!(winner.is_some(), firings.clone().any(|firing| firing.neuron < 9));
        let volley = Volley::<8, 50>::assemble(firings.clone());
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
        let mut readout = Readout::<_, 3>::new(Slots::new(&FIELDS)).with_slot_ticks(slot_ticks);
        prop_assert!(readout.decode(tick.into(), &events).iter().all(|value| value.is_finite()));
    }
}

#[test]
fn a_crowd_of_neurons_gives_one_answer() {
    let at = |neuron, slot| Firing { neuron, slot, polarity: Polarity::Up };
    let winner = |firings: &[Firing]| {
        Option::<Neuron<9>>::assemble(firings.iter().copied()).map(Neuron::index)
    };
    assert_eq!(winner(&[at(4, 0), at(2, 0), at(4, 0)]), Some(4));
    assert_eq!(winner(&[at(4, 0), at(2, 0)]), Some(2));
    assert_eq!(winner(&[at(9, 0)]), None);

    let volley = |firings: &[Firing]| {
        Volley::<8, 50>::assemble(firings.iter().copied()).iter().collect::<Vec<_>>()
    };
    let firings = [at(1, 9), at(3, 7), at(4, 2), at(4, 1), at(5, 30), at(7, 3)];
    assert_eq!(volley(&firings), [(3, 7), (4, 1), (5, 30)]);
    assert_eq!(volley(&[at(0, 50), at(8, 0)]), []);

    let down = Firing { polarity: Polarity::Down, ..at(0, 0) };
    assert_eq!(Spike::assemble([down, at(0, 0), down].into_iter()), Spike::Down);
    assert_eq!(Spike::assemble([down, at(0, 0)].into_iter()), Spike::None);
}
