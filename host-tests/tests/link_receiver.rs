//! A receiver of rate and population codes: exact after every loss as their decoders recover, and never
//! wrong.

use rand_core::Rng;
use rand_pcg::Pcg32;
use spikewire::link::{Coding, MAX_FRAME, Reader, Receiver, Transmitter};
use spikewire::population::{Position, Slots};
use spikewire::rate::{BsaToolbox, Hough, Taps, ThresholdHough};
use spikewire::temporal::StepForward;
use spikewire::{
    Bank, EventQueue, Keyframe, Output, Overflow, Recovery, Sample, Source, Start, Tick,
};

const CHANNELS: usize = 2;
const PERIOD: u32 = 1_000;
const SAMPLES: u32 = 600;

/// How a run goes.
#[derive(Clone, Copy, Debug)]
struct Way {
    seed: u64,
    /// Of ticks, to either side, in µs.
    jitter: u32,
    /// Of frames, in per cent.
    loss: u32,
    slot_ticks: u32,
}

/// Sends two channels through a scheme, and compares every value that is called exact with those of decoders
/// beside the encoders. Says how many were.
fn run<P, const EVENTS: usize>(
    scheme: &'static P,
    signal: impl Fn(u32, usize) -> P::Sample,
    way: Way,
) -> usize
where
    P: Start,
    P::Sample: PartialEq,
{
    let mut random = Pcg32::new(way.seed, 3);
    let start = Tick::from(u32::MAX - 200 * PERIOD); // it wraps on the way
    let queue = EventQueue::<256>::new(Overflow::Refuse);
    let mut consumer = queue.consumer().unwrap();
    let mut bank = Bank::<_, CHANNELS>::new(scheme).with_slot_ticks(way.slot_ticks);
    let mut transmitter = Transmitter::new(Coding::for_channels(8, PERIOD as u16), 1);
    let mut reader = Reader::<MAX_FRAME>::new();
    let mut receiver = Receiver::<_, CHANNELS, EVENTS>::new(scheme);
    if way.slot_ticks > 0 {
        receiver = receiver.with_slot_ticks(way.slot_ticks, start);
    }
    let mut encoders = [(); CHANNELS].map(|()| scheme.encoder());
    let mut decoders = [(); CHANNELS].map(|()| scheme.decoder());
    let mut truths: Vec<[P::Sample; CHANNELS]> = Vec::new();
    let mut exact = 0;

    for sample in 0..SAMPLES {
        let away = if way.jitter == 0 { 0 } else { random.next_u32() % (2 * way.jitter) };
        let tick = (start + sample * PERIOD + away).shifted(-way.jitter.cast_signed());
        let samples = std::array::from_fn(|channel| signal(sample, channel));
        bank.encode_into(tick, samples, &queue);
        let mut truth = [P::Sample::default(); CHANNELS];
        for channel in 0..CHANNELS {
            if let Some(code) = encoders[channel].encode(samples[channel]).code() {
                truth[channel] = decoders[channel].decode(code);
            }
        }
        truths.push(truth);
        if !random.next_u32().is_multiple_of(10) {
            continue;
        }
        let mut buffer = [0; 64];
        while let Some(mut bytes) = transmitter.next_frame(&mut consumer, &mut buffer).unwrap() {
            if random.next_u32() % 100 < way.loss {
                continue;
            }
            while let Some(received) = reader.next_frame(&mut bytes) {
                let mut values = Vec::new();
                receiver
                    .apply(&received, |channel, tick, value| values.push((channel, tick, value)));
                // What was handed over last is what is exact now.
                for channel in 0..CHANNELS as u16 {
                    let last = values.iter().rev().find(|value| value.0 == channel);
                    if let (Some(&(_, tick, value)), Some(known)) = (last, receiver.exact(channel))
                    {
                        assert_eq!(known, value);
                        let since = tick.since(start) + PERIOD.cast_signed() / 2;
                        let at = (since as u32 / PERIOD) as usize;
                        assert_eq!(value, truths[at][usize::from(channel)], "sample {at}: {way:?}");
                        exact += 1;
                    }
                }
            }
        }
    }
    exact
}

fn wave(sample: u32, channel: usize) -> f32 {
    let t = sample as f32 * (0.05 + 0.02 * channel as f32);
    // Silent for a while, so that whole filters run empty.
    if sample / 80 % 3 == 1 { 0.0 } else { 1.0 + t.sin() }
}

fn check<P: Start<Sample = f32>>(scheme: &'static P, slot_ticks: u32, jitter: u32) {
    for seed in 0..10 {
        let at = |loss| run::<_, 32>(scheme, wave, Way { seed, jitter, loss, slot_ticks });
        assert!(at(0) > 20, "nearly always exact without losses");
        assert!(at(10) > 5, "and often with them");
    }
}

#[test]
fn rate_codes_are_exact_again_after_their_filter() {
    static HOUGH: Hough<f32, 7> = Hough::new(Taps::triangular(0.5));
    static THRESHOLD: ThresholdHough<f32, 7> = ThresholdHough::new(Taps::triangular(0.5), 0.2);
    static TOOLBOX: BsaToolbox<f32, 7> = BsaToolbox::new(Taps::triangular(0.5), 0.9);
    for jitter in [0, 200] {
        check(&HOUGH, 0, jitter);
        check(&THRESHOLD, 0, jitter);
        check(&TOOLBOX, 0, jitter);
    }
}

#[test]
fn population_codes_are_exact_again_at_their_next_spike() {
    static POSITION: Position<f32, 9> = Position::linear(0.0..=2.0);
    static SLOTS: Slots<f32, 8, 50> = Slots::new(0.0..=2.0, 1.5);
    check(&POSITION, 0, 0);
    check(&POSITION, 0, 200);
    check(&SLOTS, PERIOD / 50, 0);
}

/// An event without room belongs to a channel that is not exact until it has recovered.
#[test]
fn a_sample_with_more_events_than_there_is_room_for_is_not_exact() {
    static HOUGH: Hough<f32, 7> = Hough::new(Taps::triangular(0.5));
    static SLOTS: Slots<f32, 8, 50> = Slots::new(0.0..=2.0, 1.5);
    for seed in 0..10 {
        let way = Way { seed, jitter: 0, loss: 0, slot_ticks: 0 };
        assert!(run::<_, 1>(&HOUGH, wave, way) > 20);
        let slots = Way { slot_ticks: PERIOD / 50, ..way };
        assert!(run::<_, 8>(&SLOTS, wave, slots) > 0);
    }
}

/// What `advance` does for a value that nothing follows.
#[test]
fn a_sample_is_over_when_time_has_passed() {
    static POSITION: Position<f32, 9> = Position::linear(0.0..=2.0);
    let queue = EventQueue::<8>::new(Overflow::Refuse);
    let mut bank = Bank::<_, 1>::new(&POSITION);
    let mut transmitter = Transmitter::new(Coding::for_channels(9, 1_000), 1);
    let mut receiver = Receiver::<_, 1>::new(&POSITION);
    let mut reader = Reader::<MAX_FRAME>::new();
    for (tick, sample) in [(1_000, 0.5), (2_000, 1.0)] {
        bank.encode_into(Tick::from(tick), [sample], &queue);
    }
    let mut buffer = [0; 64];
    let mut consumer = queue.consumer().unwrap();
    let mut bytes = transmitter.next_frame(&mut consumer, &mut buffer).unwrap().unwrap();
    receiver.apply(&reader.next_frame(&mut bytes).unwrap(), |_, _, _| ());
    assert_eq!(receiver.exact(0), None, "before the first sample something may have been lost");
    receiver.advance(Tick::from(2_400), |_, _, _| ());
    assert_eq!(receiver.exact(0), None);
    receiver.advance(Tick::from(3_000), |_, _, _| ());
    assert_eq!(receiver.exact(0), Some(1.0));
    receiver.mark_stale();
    assert_eq!((receiver.exact(0), receiver.estimate(0)), (None, 1.0));
}

#[test]
fn what_does_not_belong_is_counted() {
    use spikewire::{Event, FromItems, Item, Polarity};
    static STEP: StepForward<f32> = StepForward::new(0.5);
    assert_eq!(<StepForward<f32> as spikewire::Scheme>::RECOVERY, Recovery::Keyframe);
    let tick = Tick::from(5);
    let items = [
        Item::Keyframe(Keyframe::new(tick, 10, 1.5_f32)),
        Item::Keyframe(Keyframe::new(tick, 9, 1.5_f32)),
        Item::Keyframe(Keyframe::new(tick, 11, 3_i16)),
        Item::Event(Event { tick, address: 12, polarity: Polarity::Up }),
        Item::Event(Event { tick, address: 10, polarity: Polarity::Up }),
    ];
    let mut receiver = Receiver::<_, 2, 0>::new(&STEP).with_first_address(10);
    let mut reader = Reader::<MAX_FRAME>::new();
    let mut transmitter = Transmitter::new(Coding::for_channels(2, 1), 1);
    let mut source = FromItems(items.into_iter());
    let mut buffer = [0; 64];
    while let Some(mut bytes) = transmitter.next_frame(&mut source, &mut buffer).unwrap() {
        receiver.apply(&reader.next_frame(&mut bytes).unwrap(), |_, _, _| ());
    }
    assert!(source.take().is_none());
    assert_eq!((receiver.exact(0), receiver.exact(1)), (Some(2.0), None));
    assert_eq!((receiver.outside(), receiver.misfits()), (2, 1));
    assert_eq!(f32::from_bits32(2.0_f32.to_bits32()), 2.0);
}
