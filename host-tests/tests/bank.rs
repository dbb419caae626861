//! A bank: `N` encoders side by side, their codes as items with time, address and polarity.

use crate::common::{Drawn, cases, in_every_type};
use host_tests::flight;
use proptest::collection::vec;
use proptest::prelude::*;
use spikewire::population::{Position, Slots};
use spikewire::rate::{Hough, Taps};
use spikewire::temporal::{SendOnDelta, StepForward};
use spikewire::timing::FirstSpike;
use spikewire::{
    Bank, Code, ConfigError, Encoder, Event, EventQueue, Item, Keyframe, Output, Overflow,
    Polarity, Readout, Sample, Scheme, Schemes, Source, SpscQueue, Start, Tick, dynamic,
};

static GYRO: StepForward<f32> = StepForward::new(1.0);
static COUNTS: StepForward<i16> = StepForward::new(1);

/// One recording a channel, sample by sample through a bank.
fn events<T, P, const N: usize>(
    bank: &mut Bank<T, N>,
    channels: &[Vec<P::Sample>; N],
    ticks: &[u32],
) -> Vec<Event>
where
    T: Schemes<N, Scheme = P>,
    P: Start,
{
    let mut events = Vec::new();
    for (i, &tick) in ticks.iter().enumerate() {
        let samples = std::array::from_fn(|channel| channels[channel][i]);
        bank.encode(tick.into(), samples, |event| events.push(event));
    }
    events
}

/// What each channel's own encoder gives.
fn expected<P: Start, const N: usize>(
    scheme: &P,
    channels: &[Vec<P::Sample>; N],
    ticks: &[u32],
    slot_ticks: u32,
) -> Vec<Event> {
    expected_of(&mut [(); N].map(|()| scheme.encoder()), channels, ticks, slot_ticks)
}

fn expected_of<P: Start, const N: usize>(
    encoders: &mut [Encoder<'_, P>; N],
    channels: &[Vec<P::Sample>; N],
    ticks: &[u32],
    slot_ticks: u32,
) -> Vec<Event> {
    let mut events = Vec::new();
    for (i, &tick) in ticks.iter().enumerate() {
        let mut firings = Vec::new();
        for (channel, encoder) in encoders.iter_mut().enumerate() {
            let Some(code) = encoder.encode(channels[channel][i]).code() else { continue };
            firings.extend(code.firings().map(|firing| {
                let event = Event {
                    tick: Tick::from(tick) + slot_ticks.wrapping_mul(firing.slot.into()),
                    address: (channel * P::Code::NEURONS) as u16 + firing.neuron,
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

fn event(tick: u32, address: u16, polarity: Polarity) -> Event {
    Event { tick: tick.into(), address, polarity }
}

#[test]
fn addresses_times_and_polarities_by_hand() {
    let mut bank = Bank::<_, 3>::new(&GYRO);
    let channels = [vec![0.0, 2.0, f32::NAN], vec![0.0, 0.0, -2.0], vec![5.0, 3.0, 9.0]];
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
    assert_eq!(
        [0, 1, 2, 3].map(|channel| bank.keyframe(channel)),
        [Some(1.0), Some(-1.0), Some(5.0), None]
    );
    bank.reset();
    assert_eq!((bank.rejected(), bank.keyframe(0)), (0, None));
}

#[test]
fn keyframes_and_resets_stand_between_the_events() {
    let queue = EventQueue::<16>::new(Overflow::Refuse);
    let mut bank = Bank::<_, 2>::new(&COUNTS).with_first_address(7);
    let [first, second, third] = [1, 2, 3].map(Tick::from);
    bank.keyframe_into(first, &queue); // no keyframe yet: a heartbeat
    bank.encode_into(first, [0, 50], &queue);
    bank.encode_into(second, [5, 50], &queue);
    bank.keyframe_into(second, &queue);
    bank.reset_into(third, &queue);
    bank.keyframe_into(third, &queue); // a heartbeat again
    bank.encode_into(third, [9, 9], &queue);
    bank.encode_into(third, [9, 0], &queue);
    let mut consumer = queue.consumer().unwrap();
    let items: Vec<Item> = std::iter::from_fn(|| consumer.take()).map(|taken| taken.item).collect();
    assert_eq!(
        items,
        [
            Item::Heartbeat { tick: first, address: 7 },
            Item::Event(event(2, 7, Polarity::Up)),
            Item::Keyframe(Keyframe::new(second, 7, 1_i16)),
            Item::Keyframe(Keyframe::new(second, 8, 50_i16)),
            Item::Break(third),
            Item::Heartbeat { tick: third, address: 7 },
            Item::Event(event(3, 8, Polarity::Down)),
        ]
    );
}

/// A rate code passes over a sample that is not finite, and its decoder would be one behind: a break says so.
#[test]
fn a_sample_that_a_code_passes_over_is_a_break() {
    static HOUGH: Hough<f32, 3> = Hough::new(Taps::triangular(1.0));
    let queue = EventQueue::<16>::new(Overflow::Refuse);
    let mut bank = Bank::<_, 1>::new(&HOUGH);
    let samples = [0.0, 0.0, 0.0, f32::NAN, 0.0];
    for (tick, sample) in (1..).zip(samples) {
        bank.encode_into(Tick::from(tick), [sample], &queue);
    }
    let mut consumer = queue.consumer().unwrap();
    let items: Vec<Item> = std::iter::from_fn(|| consumer.take()).map(|taken| taken.item).collect();
    assert_eq!(items, [Item::Break(Tick::from(4))]);
}

/// A code without sub-timesteps does not become one that has some.
#[test]
fn a_length_of_slots_changes_nothing_without_slots() {
    static HOUGH: Hough<f32, 3> = Hough::new(Taps::triangular(1.0));
    let queue = EventQueue::<4>::new(Overflow::Refuse);
    let mut bank = Bank::<_, 1>::new(&HOUGH).with_slot_ticks(5);
    bank.encode_into(Tick::from(1), [f32::NAN], &queue);
    assert_eq!(
        queue.consumer().unwrap().take().map(|taken| taken.item),
        Some(Item::Break(1.into()))
    );
}

/// Without a length of slots events come by rising address, whichever slot is earlier.
#[test]
fn slots_without_a_length_are_one_time() {
    let scheme = FirstSpike::<i16, 4>::linear(0..=30);
    let mut bank = Bank::<_, 2>::new(&scheme);
    let mut addresses = Vec::new();
    bank.encode(Tick::from(1), [0, 30], |event| addresses.push((event.tick, event.address)));
    assert_eq!(addresses, [(1.into(), 0), (1.into(), 1)]);
}

/// Room for 1024 neurons, and 5 of them used: a channel's addresses end where the next one's begin.
#[test]
fn channels_whose_size_is_chosen_at_run_time_lie_side_by_side() {
    let scheme = dynamic::Slots::<i16>::try_new(5, 10, &(0..=30), 1.5).unwrap();
    let mut bank = Bank::<_, 2>::with_states(&scheme, [scheme.state(); 2]).with_slot_ticks(1);
    let mut readout = Readout::<_, 2>::new(&scheme).with_slot_ticks(1);
    for samples in [[0, 30], [30, 0], [12, 17]] {
        let (tick, mut events) = (Tick::from(1), Vec::new());
        bank.encode(tick, samples, |event| events.push(event));
        let expected = samples.map(|x| scheme.decoder().decode(scheme.encoder().encode(x)));
        assert_eq!(readout.decode(tick, &events), expected);
    }
}

#[test]
fn banks_and_queues_can_be_static() {
    use std::sync::Mutex;
    static BANK: Mutex<Bank<&StepForward<i16>, 6>> =
        Mutex::new(Bank::new(&COUNTS).with_first_address(12));
    static EVENTS: EventQueue<8> = EventQueue::new(Overflow::DropOldest);
    let mut bank = BANK.lock().unwrap();
    bank.encode_into(Tick::from(1), [0; 6], &EVENTS);
    bank.encode_into(Tick::from(2), [0, 0, 0, 0, 0, 9], &EVENTS);
    assert_eq!(EVENTS.consumer().unwrap().take_event(), Some(event(2, 17, Polarity::Up)));
}

#[test]
fn slots_are_times() {
    // Centres -0.25, 0.25, 0.75, 1.25; at 0.1 the slots are 42, 10, 85, none.
    let scheme = Slots::<f32, 4, 100>::new(0.0..=1.0, 1.5);
    let mut bank = Bank::<_, 2>::new(&scheme).with_slot_ticks(5);
    let channels = [vec![99.0], vec![0.1]];
    let events = events(&mut bank, &channels, &[u32::MAX]);
    let fired: Vec<_> = events.iter().map(|event| (event.tick.micros(), event.address)).collect();
    assert_eq!(fired, [(49, 5), (209, 4), (424, 6)]);
}

#[test]
fn channels_may_have_parameters_of_their_own() {
    let schemes = [1.0_f32, 2.0].map(StepForward::new);
    let mut bank = Bank::per_channel(schemes.each_ref());
    let channels = [vec![0.0, 1.5], vec![0.0, 1.5]];
    let fired = events(&mut bank, &channels, &[1, 2]);
    assert_eq!(fired, [event(2, 0, Polarity::Up)]);
}

#[test]
fn banks_share_the_addresses() {
    let bank = Bank::<_, 3>::new(&COUNTS);
    let mut behind = bank.clone().with_first_address(0xFFFD);
    let mut addresses = Vec::new();
    for sample in [0, 5] {
        behind.encode(Tick::default(), [sample; 3], |event| addresses.push(event.address));
    }
    assert_eq!(addresses, [0xFFFD, 0xFFFE, 0xFFFF]);
    let (parameter, min, max) = ("first address", 0.0, 65_533.0);
    let error = ConfigError::OutOfRange { parameter, value: 65_534.0, min, max };
    assert_eq!(bank.clone().try_with_first_address(0xFFFE).err(), Some(error));
    let behind = bank.try_with_first_address(0xFFFD).unwrap();
    assert!(format!("{behind:?}").ends_with("first_address: 65533, .. }"));
}

#[test]
fn a_queue_counts_what_a_bank_has_no_room_for() {
    let samples = [[0; 3], [5; 3]];
    for (overflow, expected, refused) in [
        (Overflow::DropOldest, [1, 2], 0),
        (Overflow::DropNewest, [0, 1], 0),
        (Overflow::Refuse, [0, 1], 1),
    ] {
        let queue = EventQueue::<2>::new(overflow);
        let mut bank = Bank::<_, 3>::new(&COUNTS);
        for sample in samples {
            bank.encode_into(Tick::default(), sample, &queue);
        }
        assert_eq!((queue.lost(), queue.refused()), (1, refused), "{overflow:?}");
        let mut consumer = queue.consumer().unwrap();
        let events = std::iter::from_fn(|| consumer.take_event());
        assert!(events.map(|event| event.address).eq(expected), "{overflow:?}");
    }
    let queue = SpscQueue::<3>::new();
    let (mut producer, mut consumer) = queue.split().unwrap();
    let mut bank = Bank::<_, 3>::new(&COUNTS);
    for sample in samples {
        bank.encode_into(Tick::default(), sample, &mut producer);
    }
    assert_eq!(producer.lost(), 1);
    assert!(std::iter::from_fn(|| consumer.take_event()).map(|event| event.address).eq([0, 1]));
}

/// As many neurons as there are addresses.
#[test]
fn all_addresses() {
    let scheme = Position::<f32, 1024>::linear(0.0..=1.0);
    let mut bank = Bank::<_, 64>::new(&scheme);
    let mut addresses = Vec::new();
    bank.encode(Tick::default(), [9.0; 64], |event| addresses.push(event.address));
    assert!(addresses.iter().copied().eq((0..64).map(|channel| 1024 * channel + 1023)));
}

#[test]
fn flights() {
    let step = StepForward::new(0.1);
    let hough = Hough::new(Taps::<f32, 9>::triangular(0.1)).with_shift(-0.5);
    let position = Position::<f32, 20>::linear(-9.0..=9.0);
    let slots = Slots::<f32, 15, 10>::new(-4.0..=4.0, 1.5);
    for channels in flight::flights() {
        let ticks: Vec<_> = (0..channels[0].len() as u32).map(|i| i * 5_000).collect();
        let fired = events(&mut Bank::new(&step), &channels, &ticks);
        assert_eq!(fired, expected(&step, &channels, &ticks, 0));
        let fired = events(&mut Bank::new(&hough), &channels, &ticks);
        assert_eq!(fired, expected(&hough, &channels, &ticks, 0));
        let fired = events(&mut Bank::new(&position), &channels, &ticks);
        assert_eq!(fired, expected(&position, &channels, &ticks, 0));
        let fired = events(&mut Bank::new(&slots).with_slot_ticks(500), &channels, &ticks);
        assert_eq!(fired, expected(&slots, &channels, &ticks, 500));
    }
}

/// Any finite float, and those that are not.
fn float() -> impl Strategy<Value = f32> {
    prop_oneof![-4.0_f32..4.0, any::<u32>().prop_map(f32::from_bits), Just(f32::NAN)]
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn drawn_recordings(
        (channels, ticks, slot_ticks) in (1..40_usize).prop_flat_map(|length| {
            (vec(vec(float(), length), 3), vec(any::<u32>(), length), any::<u32>())
        }),
    ) {
        let channels: [_; 3] = channels.try_into().unwrap();
        let scheme = Slots::<f32, 4, 100>::new(-1.0..=1.0, 1.5);
        let fired = events(&mut Bank::new(&scheme).with_slot_ticks(slot_ticks), &channels, &ticks);
        prop_assert_eq!(fired, expected(&scheme, &channels, &ticks, slot_ticks));
    }
}

/// Channels that are quiet are passed over together: events, values and counts are those of an encoder for each.
fn as_encoders<P: Start, const N: usize>(
    schemes: [&P; N],
    channels: &[Vec<P::Sample>; N],
    slot_ticks: u32,
) {
    let length = channels.iter().map(Vec::len).min().unwrap_or(0);
    let ticks: Vec<_> = (0..length as u32).collect();
    let mut bank = Bank::per_channel(schemes).with_slot_ticks(slot_ticks);
    for _ in 0..2 {
        let mut encoders = schemes.map(Scheme::encoder);
        assert_eq!(
            events(&mut bank, channels, &ticks),
            expected_of(&mut encoders, channels, &ticks, slot_ticks)
        );
        for (channel, encoder) in encoders.iter().enumerate() {
            let bits = |value: Option<P::Sample>| value.map(Sample::to_bits32);
            assert_eq!(bits(bank.keyframe(channel)), bits(encoder.keyframe()));
        }
        assert_eq!(bank.rejected(), encoders.iter().map(Encoder::rejected).sum::<u32>());
        bank.reset();
    }
}

#[test]
fn quiet_channels() {
    fn drawn<S: Sample + Drawn>() {
        let thresholds = [S::positive(), S::positive()];
        proptest!(cases(500), |(recording in S::recordings(), thresholds in thresholds)| {
            let channels = std::array::from_fn(|channel| {
                let (end, beginning) = recording.split_at(recording.len().min(channel));
                [beginning, end].concat()
            });
            let [a, b] = thresholds.map(StepForward::try_new);
            let (Ok(a), Ok(b)) = (a, b) else { return Ok(()) };
            as_encoders([&a, &b, &a, &b, &b], &channels, 0);
            let [a, b] = thresholds.map(SendOnDelta::<S, 3>::new);
            as_encoders([&a, &a, &b, &a, &b], &channels, 0);
            as_encoders([&a, &a, &b, &a, &b], &channels, 7);
        });
    }
    in_every_type!(drawn);
}
