//! A bank: `N` encoders side by side, their codes as events with time, address and polarity.

use crate::common;

use common::{cases, flight_channels, float};
use host_tests::compare::encode;
use proptest::collection::vec;
use proptest::prelude::*;
use spikewire::link::Snapshot;
use spikewire::population::{Centres, Position, ReceptiveFields, Slots};
use spikewire::rate::{Hough, Taps};
use spikewire::sink::{EventQueue, Overflow};
use spikewire::temporal::StepForward;
use spikewire::{Bank, Code, ConfigError, Encoder, Event, Mark, Output, Polarity, Scheme};

/// One recording a channel, sample by sample through a bank.
fn events<E: Encoder<Sample = f32>, const N: usize>(
    bank: &mut Bank<E, N>,
    channels: &[Vec<f32>; N],
    ticks: &[u32],
) -> Vec<Event> {
    let mut events = Vec::new();
    for (i, &tick) in ticks.iter().enumerate() {
        let samples = std::array::from_fn(|channel| channels[channel][i]);
        bank.encode(tick, samples, |event| events.push(event));
    }
    events
}

/// The same from each channel's own run.
fn expected<P, const N: usize>(
    scheme: P,
    channels: &[Vec<f32>; N],
    ticks: &[u32],
    slot_ticks: u32,
) -> Vec<Event>
where
    P: Scheme<Sample = f32>,
    P::Encoder: Clone,
    <P::Encoder as Encoder>::Output: std::fmt::Debug + PartialEq,
    <<P::Encoder as Encoder>::Output as Output>::Code: std::fmt::Debug + PartialEq,
{
    let runs = channels.each_ref().map(|channel| encode(scheme, channel).outputs);
    let neurons = <<P::Encoder as Encoder>::Output as Output>::Code::NEURONS;
    let mut events = Vec::new();
    for (i, &tick) in ticks.iter().enumerate() {
        let mut firings = Vec::new();
        for (channel, outputs) in runs.iter().enumerate() {
            let Some(code) = outputs[i].code() else { continue };
            firings.extend(code.firings().map(|firing| {
                let event = Event {
                    tick: tick.wrapping_add(slot_ticks.wrapping_mul(firing.slot.into())),
                    address: (channel * neurons) as u16 + firing.neuron,
                    polarity: firing.polarity,
                };
                (if slot_ticks > 0 { firing.slot } else { 0 }, event)
            }));
        }
        firings.sort_by_key(|&(slot, _)| slot);
        events.extend(firings.into_iter().map(|(_, event)| event));
    }
    events
}

#[test]
fn addresses_times_and_polarities_by_hand() {
    let mut bank = Bank::<_, 3>::new(StepForward::new(1.0_f32).unwrap());
    let channels = [vec![0.0, 2.0, f32::NAN], vec![0.0, 0.0, -2.0], vec![5.0, 3.0, 9.0]];
    let event = |tick, address, polarity| Event { tick, address, polarity };
    assert_eq!(
        events(&mut bank, &channels, &[10, 20, u32::MAX]),
        [
            event(20, 0, Polarity::Up),
            event(20, 2, Polarity::Down),
            event(u32::MAX, 1, Polarity::Down),
            event(u32::MAX, 2, Polarity::Up),
        ]
    );
    assert_eq!(bank.rejected(), 1);
    let values = [Some(1.0), Some(-1.0), Some(5.0)];
    let mark = Mark { lost: 7, place: Some(2) };
    assert_eq!(bank.snapshot(30, mark), Snapshot { tick: 30, mark, values });
    bank.reset();
    assert_eq!((bank.rejected(), bank.channels()[0].keyframe()), (0, None));
}

#[test]
fn slots_are_times() {
    // Centres -0.25, 0.25, 0.75, 1.25; at 0.1 the slots are 42, 10, 85, none.
    let fields = ReceptiveFields::<f32, 4, 100>::new(0.0, 1.0, 1.5).unwrap();
    let mut bank = Bank::<_, 2>::new(Slots::new(&fields)).with_slot_ticks(5);
    let channels = [vec![99.0], vec![0.1]];
    let events = events(&mut bank, &channels, &[u32::MAX]);
    let told: Vec<_> = events.iter().map(|event| (event.tick, event.address)).collect();
    assert_eq!(told, [(49, 5), (209, 4), (424, 6)]);
}

#[test]
fn channels_may_have_parameters_of_their_own() {
    let mut bank = Bank::from_schemes([1.0_f32, 2.0].map(|t| StepForward::new(t).unwrap()));
    let channels = [vec![0.0, 1.5], vec![0.0, 1.5]];
    let told = events(&mut bank, &channels, &[1, 2]);
    assert_eq!(told, [Event { tick: 2, address: 0, polarity: Polarity::Up }]);
}

#[test]
fn banks_share_the_addresses() {
    let bank = Bank::<_, 3>::new(StepForward::<i16>::checked(1));
    let mut behind = bank.with_first_address(0xFFFD).unwrap();
    let mut addresses = Vec::new();
    for sample in [0, 5] {
        behind.encode(0, [sample; 3], |event| addresses.push(event.address));
    }
    assert_eq!(addresses, [0xFFFD, 0xFFFE, 0xFFFF]);
    let (parameter, min, max) = ("first address", 0.0, 65_533.0);
    let error = ConfigError::OutOfRange { parameter, value: 65_534.0, min, max };
    assert_eq!(bank.with_first_address(0xFFFE).err(), Some(error));
}

#[test]
fn a_queue_counts_what_a_bank_has_no_room_for() {
    for (overflow, expected, refused) in [
        (Overflow::DropOldest, [1, 2], 0),
        (Overflow::DropNewest, [0, 1], 0),
        (Overflow::Refuse, [0, 1], 1),
    ] {
        let queue = EventQueue::<2>::new(overflow);
        let mut bank = Bank::<_, 3>::new(StepForward::<i16>::checked(1));
        bank.encode_into(1, [0; 3], &queue);
        bank.encode_into(2, [5; 3], &queue);
        assert_eq!((queue.lost(), queue.refused()), (1, refused), "{overflow:?}");
        assert!(queue.drain().into_iter().map(|event| event.address).eq(expected), "{overflow:?}");
    }
}

/// As many neurons as there are addresses.
#[test]
fn all_addresses() {
    let centres = Centres::<f32, 1024>::new_linear(0.0, 1.0).unwrap();
    let mut bank = Bank::<_, 64>::new(Position::new(&centres));
    let mut addresses = Vec::new();
    bank.encode(0, [9.0; 64], |event| addresses.push(event.address));
    assert!(addresses.iter().copied().eq((0..64).map(|channel| 1024 * channel + 1023)));
}

#[test]
fn flights() {
    let taps = Taps::<f32, 9>::triangular(0.1);
    let fields = ReceptiveFields::<f32, 15, 10>::new(-4.0, 4.0, 1.5).unwrap();
    let centres = Centres::<f32, 20>::new_linear(-9.0, 9.0).unwrap();
    for flight in flight_channels().chunks(6) {
        let channels: [_; 6] = flight.to_vec().try_into().unwrap();
        let ticks: Vec<_> = (0..channels[0].len() as u32).map(|i| i * 5_000).collect();
        let scheme = StepForward::new(0.1).unwrap();
        let told = events(&mut Bank::new(scheme), &channels, &ticks);
        assert_eq!(told, expected(scheme, &channels, &ticks, 0));
        let scheme = Hough::new(&taps).with_shift(-0.5).unwrap();
        let told = events(&mut Bank::new(scheme), &channels, &ticks);
        assert_eq!(told, expected(scheme, &channels, &ticks, 0));
        let scheme = Position::new(&centres);
        let told = events(&mut Bank::new(scheme), &channels, &ticks);
        assert_eq!(told, expected(scheme, &channels, &ticks, 0));
        let scheme = Slots::new(&fields);
        let told = events(&mut Bank::new(scheme).with_slot_ticks(500), &channels, &ticks);
        assert_eq!(told, expected(scheme, &channels, &ticks, 500));
    }
}

#[test]
fn drawn_recordings() {
    let recordings = (1..40_usize).prop_flat_map(|length| {
        (vec(vec(float(), length), 3), vec(any::<u32>(), length), any::<u32>())
    });
    proptest!(cases(128), |((channels, ticks, slot_ticks) in recordings)| {
        let channels: [_; 3] = channels.try_into().unwrap();
        let scheme = StepForward::new(0.5).unwrap();
        let mut bank = Bank::new(scheme);
        let told = events(&mut bank, &channels, &ticks);
        prop_assert_eq!(told, expected(scheme, &channels, &ticks, 0));
        let faults = channels.iter().flatten().filter(|x| !x.is_finite()).count();
        prop_assert_eq!(bank.rejected() as usize, faults);
        let fields = ReceptiveFields::<f32, 4, 100>::new(-1.0, 1.0, 1.5).unwrap();
        let scheme = Slots::new(&fields);
        let told = events(&mut Bank::new(scheme).with_slot_ticks(slot_ticks), &channels, &ticks);
        prop_assert_eq!(told, expected(scheme, &channels, &ticks, slot_ticks));
    });
}
