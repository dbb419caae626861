//! A receiver of rate and population codes: exact after every loss as their decoders recover, and never
//! wrong.

use rand_core::Rng;
use rand_pcg::Pcg32;
use spikewire::link::{Coding, MAX_FRAME, Reader, Receiver, Session, Transmitter, Withheld};
use spikewire::population::{Position, Slots};
use spikewire::rate::{BsaToolbox, Hough, Taps, ThresholdHough};
use spikewire::temporal::{AdaptiveStepForward, StepForward};
use spikewire::timing::FirstSpike;
use spikewire::{
    Bank, Event, EventQueue, FromItems, Item, Keyframe, Output, Overflow, Polarity, Recovery,
    Sample, Scheme, Schemes, Spike, Start, Tick, dynamic,
};

const CHANNELS: usize = 2;
const PERIOD: u32 = 1_000;
const SAMPLES: u32 = 600;

static POSITION: Position<f32, 9> = Position::linear(0.0..=2.0);
static HOUGH: Hough<f32, 7> = Hough::new(Taps::triangular(0.5));
static SLOTS: Slots<f32, 8, 50> = Slots::new(0.0..=2.0, 1.5);
static STEP: StepForward<f32> = StepForward::new(0.5);
static LINEAR: FirstSpike<f32, 10> = FirstSpike::linear(0.0..=9.0);

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
    let mut transmitter = Transmitter::new(Coding::for_channels(8, PERIOD), Session::counted(1));
    let mut reader = Reader::<MAX_FRAME>::new();
    let mut receiver = Receiver::<_, CHANNELS, EVENTS>::new(scheme);
    if way.slot_ticks > 0 {
        receiver = receiver.with_slot_ticks(way.slot_ticks).with_clock_tolerance(0);
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
        if way.slot_ticks > 0 && sample.is_multiple_of(30) {
            bank.keyframe_into(tick, &queue);
        }
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
    static THRESHOLD: ThresholdHough<f32, 7> = ThresholdHough::new(Taps::triangular(0.5), 0.2);
    static TOOLBOX: BsaToolbox<f32, 7> = BsaToolbox::new(Taps::triangular(0.5), 0.9);
    for jitter in [0, 124] {
        check(&HOUGH, 0, jitter);
        check(&THRESHOLD, 0, jitter);
        check(&TOOLBOX, 0, jitter);
    }
}

#[test]
fn population_codes_are_exact_again_at_their_next_spike() {
    check(&POSITION, 0, 0);
    check(&POSITION, 0, 499);
    check(&SLOTS, PERIOD / 50, 0);
}

/// A transmitter, and the reader at the far end.
struct Line {
    transmitter: Transmitter,
    reader: Reader<MAX_FRAME>,
}

impl Line {
    /// A line for these channels, with a sample every `period` µs.
    fn new(channels: u16, period: u32) -> Self {
        let coding = Coding::for_channels(channels, period);
        Self { transmitter: Transmitter::new(coding, Session::counted(1)), reader: Reader::new() }
    }

    /// Sends items, and returns the values of the samples that they end, each with its channel.
    fn send<T: Schemes<N>, const N: usize, const EVENTS: usize>(
        &mut self,
        items: impl IntoIterator<Item = Item>,
        receiver: &mut Receiver<T, N, EVENTS>,
    ) -> Vec<(u16, <T::Scheme as Scheme>::Sample)> {
        let (mut source, mut buffer) = (FromItems(items.into_iter()), [0; MAX_FRAME]);
        let mut values = Vec::new();
        while let Some(mut bytes) = self.transmitter.next_frame(&mut source, &mut buffer).unwrap() {
            while let Some(received) = self.reader.next_frame(&mut bytes) {
                receiver.apply(&received, |channel, _, value| values.push((channel, value)));
            }
        }
        values
    }

    /// Sends items whose frames are lost.
    fn lose(&mut self, items: impl IntoIterator<Item = Item>) {
        let (mut source, mut buffer) = (FromItems(items.into_iter()), [0; MAX_FRAME]);
        while self.transmitter.next_frame(&mut source, &mut buffer).unwrap().is_some() {}
    }
}

/// A spike at this time.
fn spike(micros: u64, address: u16) -> Item {
    Item::Event(Event { tick: Tick::from_micros(micros), address, polarity: Polarity::Up })
}

/// A spike of channel 1 at this time.
fn spike_at(micros: u64) -> Item {
    spike(micros, 1)
}

fn beat_at(micros: u64) -> Item {
    Item::Heartbeat { tick: Tick::from_micros(micros), address: 0 }
}

/// Spikes that no encoder fires together, or whose sample is over, leave no value exact; nor is one exact that has not fired.
#[test]
fn spikes_that_make_no_sample_are_not_exact() {
    const BOTH: [bool; 2] = [true; 2];
    const NONE: [bool; 2] = [false; 2];
    fn first(sample: u64) -> Item {
        spike(sample * 1_000, 4)
    }
    fn second(sample: u64) -> Item {
        spike(sample * 1_000, 13)
    }
    for (items, exact, misfits) in [
        (vec![first(1), second(1), first(2), second(2)], BOTH, 0),
        (vec![first(1), first(2)], [true, false], 0),
        (vec![beat_at(1_000), first(2), second(2)], BOTH, 0),
        // Two neurons of a channel, by rising address.
        (vec![first(1), second(1), spike(2_000, 2), spike(2_000, 5), second(2)], [false, true], 1),
        // Another sample of the same tick.
        (vec![first(1), second(1), first(2), second(2), spike(2_000, 5)], NONE, 1),
        // The heartbeat says that all events of its tick have come.
        (vec![first(1), second(1), first(2), second(2), beat_at(2_000), first(2)], NONE, 1),
    ] {
        let mut receiver = Receiver::<_, 2>::new(&POSITION);
        let mut line = Line::new(18, PERIOD);
        for &item in &items {
            line.send([item], &mut receiver);
        }
        receiver.advance(Tick::from(3_000), |_, _, _| ());
        let heard = [0, 1].map(|channel| receiver.exact(channel).is_some());
        assert_eq!((heard, receiver.misfits()), (exact, misfits), "{items:?}");
    }
}

/// Ten samples of a rate code with an event each, in one channel, the last of them at 9 ms.
fn ten_samples() -> (Line, Receiver<&'static Hough<f32, 7>, 2>) {
    let (mut line, mut receiver) = (Line::new(2, PERIOD), Receiver::new(&HOUGH));
    for sample in 0..10 {
        line.send([spike_at(sample * 1_000)], &mut receiver);
    }
    assert!(receiver.exact(1).is_some());
    (line, receiver)
}

/// What comes of a sample that time has ended is a misfit, also where nobody can count how many samples ago that was.
#[test]
fn what_comes_after_its_sample_is_over_is_a_misfit() {
    // Samples after the tenth.
    for (over, comes, is_late) in
        [(1, 2, false), (3, 1, true), (3, 3, false), (300, 500, false), (1_000, 500, true)]
    {
        for item in [spike_at as fn(u64) -> Item, beat_at] {
            let (mut line, mut receiver) = ten_samples();
            receiver.advance(Tick::from(9_000 + over * PERIOD), |_, _, _| ());
            line.send([item(9_000 + comes * 1_000)], &mut receiver);
            let heard = (receiver.misfits(), receiver.exact(1).is_none());
            assert_eq!(heard, (u32::from(is_late), is_late), "{over} {comes}: {:?}", item(0));
        }
    }
}

/// Samples without events count, from the first event after a loss on: seven of them fill the filter.
#[test]
fn silent_samples_after_a_loss_are_whole() {
    for (next, is_exact) in [(17, false), (18, true), (30, true)] {
        let (mut line, mut receiver) = ten_samples();
        receiver.mark_stale();
        line.send([spike_at(10_000)], &mut receiver);
        assert_eq!(receiver.withheld(1), Some(Withheld::Samples(7)));
        line.send([spike_at(next * 1_000)], &mut receiver);
        assert_eq!(receiver.exact(1).is_some(), is_exact, "{next}");
    }
}

/// Four sub-timesteps of 100 µs, with a clock of 2 %: beyond one sample they are told apart by the measured pace alone.
#[test]
fn the_pace_is_measured_from_heartbeats_and_events() {
    const SHORT: u64 = 1_000_000;
    static FOUR: FirstSpike<f32, 4> = FirstSpike::linear(0.0..=3.0);
    let every: Vec<u64> = (1..=100).collect();
    // Heartbeats, events, and the event that is told apart or not, each in a sample.
    for (beats, events, last, is_known) in [
        (&[0][..], &[][..], 1, true),
        (&[0], &[], 2, false),
        (&[0], &every[..], 105, true),
        (&[0, 40], &[], 45, true),
        (&[0, 100], &[], 105, false),
        // Two pieces of 20 samples, and between them more than can be counted.
        (&[0, 20, 120, 140], &[], 150, true),
        (&[0, 20, 120, 140], &[], 157, false),
        (&[0, 40], &[], 57, true),
    ] {
        let mut receiver = Receiver::<_, 1>::new(&FOUR).with_slot_ticks(100);
        let mut line = Line::new(1, PERIOD);
        let at = |sample: u64| SHORT + sample * u64::from(PERIOD);
        for &beat in beats {
            line.send([beat_at(at(beat))], &mut receiver);
        }
        for &event in events.iter().chain([&last]) {
            line.send([spike(at(event) + 100, 0)], &mut receiver);
        }
        let end = Tick::from_micros(at(last + 1));
        receiver.advance(end, |_, _, _| ());
        let why = (!is_known).then_some(Withheld::Clock);
        assert_eq!(receiver.withheld(0), why, "{beats:?} {} {last}", events.len());
        // After a loss nothing is decoded until the next heartbeat, however well the pace is known.
        line.lose([beat_at(at(last + 1))]);
        line.send([spike(at(last + 2) + 100, 0)], &mut receiver);
        receiver.advance(end + 2 * PERIOD, |_, _, _| ());
        assert_eq!(receiver.withheld(0), Some(Withheld::Heartbeat), "{beats:?} {last}");
        line.send([beat_at(at(last + 3))], &mut receiver);
        line.send([spike(at(last + 4) + 100, 0)], &mut receiver);
        receiver.advance(end + 4 * PERIOD, |_, _, _| ());
        assert_eq!(receiver.withheld(0), None, "{beats:?} {last}");
    }
}

/// An event without room belongs to a channel that is not exact until it has recovered.
#[test]
fn a_sample_with_more_events_than_there_is_room_for_is_not_exact() {
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
    let mut bank = Bank::<_, 1>::new(&POSITION);
    let mut receiver = Receiver::<_, 1>::new(&POSITION);
    let mut items = Vec::new();
    for (tick, sample) in [(1_000, 0.5), (2_000, 1.0)] {
        bank.encode(Tick::from(tick), [sample], |event| items.push(Item::Event(event)));
    }
    Line::new(9, 1_000).send(items, &mut receiver);
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
    assert_eq!(<StepForward<f32> as Scheme>::RECOVERY, Recovery::Keyframe);
    let tick = Tick::from(5);
    let items = [
        Item::Keyframe(Keyframe::new(tick, 10, 1.5_f32)),
        Item::Keyframe(Keyframe::new(tick, 9, 1.5_f32)),
        Item::Keyframe(Keyframe::new(tick, 11, 3_i16)),
        Item::Event(Event { tick, address: 12, polarity: Polarity::Up }),
        Item::Event(Event { tick, address: 10, polarity: Polarity::Up }),
    ];
    let mut receiver = Receiver::<_, 2, 0>::new(&STEP).with_first_address(10);
    Line::new(2, 1).send(items, &mut receiver);
    assert_eq!((receiver.exact(0), receiver.exact(1)), (Some(2.0), None));
    assert_eq!((receiver.outside(), receiver.misfits()), (2, 1));
    assert_eq!(f32::from_bits32(2.0_f32.to_bits32()), 2.0);
}

#[test]
fn a_first_address_can_be_set_at_run_time() {
    let receiver = || Receiver::<_, 2, 0>::new(&STEP);
    let mut behind = receiver().with_slot_ticks(7).try_with_first_address(10).unwrap();
    assert_eq!(
        format!("{behind:?}"),
        format!("{:?}", receiver().with_slot_ticks(7).with_first_address(10))
    );
    let items =
        [9, 10].map(|address| Item::Keyframe(Keyframe::new(Tick::from(5), address, 1.5_f32)));
    let mut line = Line::new(2, 1);
    line.send(items, &mut behind);
    assert_eq!((behind.exact(0), behind.outside()), (Some(1.5), 1));
    assert_eq!((line.reader.frames(), line.transmitter.leaps()), (1, 0));
    let error = receiver().try_with_first_address(0xFFFF).err().unwrap();
    assert_eq!(error.to_string(), "first address 65535 must lie in 0..=65534");
}

/// From the first frame on: ticks say nothing of a silence of more than 2³⁰ µs.
#[test]
fn a_transmitter_counts_the_silences_that_it_cannot_measure() {
    let mut transmitter = Transmitter::new(Coding::for_channels(1, 1), Session::counted(1));
    transmitter.observe(Tick::from(1 << 31));
    let mut source = FromItems([Item::Heartbeat { tick: Tick::from(0), address: 0 }].into_iter());
    let mut buffer = [0; 64];
    assert!(transmitter.next_frame(&mut source, &mut buffer).unwrap().is_some());
    for (leaps, now) in [(0, 0), (0, 1 << 30), (1, (1 << 31) + 1), (2, 0)] {
        transmitter.observe(Tick::from(now));
        assert_eq!(transmitter.leaps(), leaps, "{now}");
    }
}

#[test]
fn what_is_withheld_has_a_reason_in_words() {
    let slots = Withheld::Slots { slots: 50, slot_ticks: 21, period: 1_000 };
    for (reason, message) in [
        (Withheld::Keyframe, "no keyframe since the start or the last loss"),
        (Withheld::Samples(3), "3 more samples without a loss are needed"),
        (
            slots,
            "50 sub-timesteps of 21 µs are longer than a period of 1000 µs, the shortest that the clock's tolerance allows",
        ),
        (Withheld::Always, "the error of this code fades, and is never 0"),
    ] {
        assert_eq!(reason.to_string(), message);
    }
}

/// Addresses count neurons: a code of many has as many a channel.
#[test]
fn what_does_not_belong_to_a_code_of_many_neurons_is_counted() {
    let tick = Tick::from(5);
    let mut receiver = Receiver::<_, 2>::new(&POSITION);
    let mut line = Line::new(18, 1);
    let keyframe = |address| Item::Keyframe(Keyframe::new(tick, address, 1.5_f32));
    let heartbeat = |address| Item::Heartbeat { tick, address };
    for (items, outside, misfits) in [
        ([keyframe(0), keyframe(17)], 0, 2),
        ([keyframe(17), keyframe(18)], 1, 3),
        ([heartbeat(0), heartbeat(17)], 1, 3),
        ([heartbeat(17), heartbeat(18)], 2, 3),
    ] {
        line.send(items, &mut receiver);
        assert_eq!((receiver.outside(), receiver.misfits()), (outside, misfits), "{items:?}");
        assert_eq!(receiver.exact(0), None, "the code has no keyframes");
    }
}

/// A sample is over when the next begins, or another session: its value comes then, if it had events.
#[test]
fn the_last_sample_before_a_restart_is_decoded() {
    let mut receiver = Receiver::<_, 1>::new(&POSITION);
    let mut line = Line::new(9, 1_000);
    let mut send = |session, item| {
        let session = Session::counted(session);
        line.transmitter = Transmitter::new(Coding::for_channels(9, 1_000), session);
        line.send([item], &mut receiver)
    };
    let mut event = None;
    Bank::<_, 1>::new(&POSITION).encode(Tick::from(1_000), [0.5], |first| event = Some(first));
    let heartbeat = Item::Heartbeat { tick: Tick::from(9_000), address: 0 };
    assert!(send(1, Item::Event(event.unwrap())).is_empty());
    let value = POSITION.decoder().decode(POSITION.encoder().encode(0.5));
    assert_eq!(send(2, heartbeat), [(0, value)]);
    assert!(send(3, heartbeat).is_empty(), "no event came since");
}

/// A line behind one bank, whose samples are frames of their own.
struct Link<'a, P: Start, const N: usize> {
    bank: Bank<&'a P, N>,
    line: Line,
    now: Tick,
}

impl<'a, P: Start, const N: usize> Link<'a, P, N> {
    fn new(scheme: &'a P, slot_ticks: u32) -> Self {
        let bank = Bank::new(scheme).with_slot_ticks(slot_ticks);
        Self { bank, line: Line::new(8, PERIOD), now: Tick::from(77) }
    }

    /// Sends a sample, with a heartbeat behind it, unless its frames are lost.
    fn send(
        &mut self,
        sample: P::Sample,
        is_lost: bool,
        receiver: &mut Receiver<&'a P, N>,
    ) -> Option<P::Sample> {
        self.now += PERIOD;
        let queue = EventQueue::<64>::new(Overflow::Refuse);
        self.bank.encode_into(self.now, [sample; N], &queue);
        self.bank.keyframe_into(self.now, &queue);
        let (mut consumer, mut buffer) = (queue.consumer().unwrap(), [0; MAX_FRAME]);
        let Line { transmitter, reader } = &mut self.line;
        while let Some(mut bytes) = transmitter.next_frame(&mut consumer, &mut buffer).unwrap() {
            while !is_lost && let Some(received) = reader.next_frame(&mut bytes) {
                receiver.apply(&received, |_, _, _| ());
            }
        }
        receiver.exact(0)
    }
}

/// Even points have no value for silence: after a loss a sample that is not finite says nothing.
#[test]
fn silence_is_exact_only_where_it_has_a_value() {
    static ABOVE: FirstSpike<f32, 10> = FirstSpike::logarithmic(0.0..=9.0, 100.0);
    let mut linear = Link::<_, 1>::new(&LINEAR, 100);
    let mut receiver = Receiver::new(&LINEAR).with_slot_ticks(100).with_clock_tolerance(0);
    linear.send(1.0, false, &mut receiver);
    assert_eq!(linear.send(1.0, false, &mut receiver), Some(1.0));
    linear.send(6.0, true, &mut receiver);
    assert_eq!(linear.send(f32::NAN, false, &mut receiver), None);
    assert_eq!(linear.send(f32::NAN, false, &mut receiver), None);
    assert_eq!(receiver.withheld(0), Some(Withheld::Spike));
    assert_eq!(linear.send(3.0, false, &mut receiver), Some(3.0));
    assert_eq!(linear.send(f32::NAN, false, &mut receiver), Some(3.0), "it holds");

    let mut above = Link::<_, 1>::new(&ABOVE, 100);
    let mut receiver = Receiver::new(&ABOVE).with_slot_ticks(100).with_clock_tolerance(0);
    above.send(0.0, true, &mut receiver);
    above.send(0.0, false, &mut receiver);
    let silence = ABOVE.decoder().decode(None);
    assert_eq!(above.send(0.0, false, &mut receiver), Some(silence));
}

/// Values that sub-timesteps tell are never exact where these are not known, and it is told why.
#[test]
fn without_its_sub_timesteps_a_code_has_no_value() {
    let fly = |slot_ticks: u32| {
        let mut link = Link::<_, 1>::new(&SLOTS, 20);
        let mut receiver =
            Receiver::new(&SLOTS).with_slot_ticks(slot_ticks).with_clock_tolerance(0);
        assert_eq!(link.send(0.7, true, &mut receiver), None);
        for sample in [0.5, 1.0, 1.5, 0.2, 0.4] {
            link.send(sample, false, &mut receiver);
        }
        (receiver.exact(0).is_some(), receiver.withheld(0))
    };
    assert_eq!(fly(20), (true, None));
    assert_eq!(fly(0), (false, Some(Withheld::SlotTicks)));
    let too_long = Withheld::Slots { slots: 50, slot_ticks: 21, period: PERIOD };
    assert_eq!(fly(21), (false, Some(too_long)));
    assert_eq!(
        Receiver::<_, 1>::new(&SLOTS).with_slot_ticks(20).withheld(0),
        Some(Withheld::Heartbeat)
    );
}

/// A rank of one spike has a single sub-timestep, whose length nobody needs to know.
#[test]
fn a_code_of_one_sub_timestep_needs_no_length_of_it() {
    let scheme = dynamic::RankOrder::<f32>::try_linear(9, 1, &(0.0..=2.0)).unwrap();
    let mut receiver = Receiver::<_, 1>::new(&scheme);
    let mut line = Line::new(9, 1_000);
    for sample in 0..3 {
        line.send([spike_at(sample * 1_000)], &mut receiver);
    }
    assert_eq!((receiver.exact(0), receiver.withheld(0)), (Some(scheme.centres()[1]), None));
}

/// What a receiver of two channels passes on of keyframes a second apart.
fn passed_on<P: Start<Sample = f32>>(scheme: &P, address: u16) -> Vec<u16> {
    let mut receiver = Receiver::<_, 2>::new(scheme);
    let mut line = Line::new(9, 1_000);
    let keyframe = |seconds: u32| Keyframe::new(Tick::from(seconds * 1_000_000), address, 1.5_f32);
    let keyframes = (1..4).map(|seconds| Item::Keyframe(keyframe(seconds)));
    let values = keyframes.flat_map(|keyframe| line.send([keyframe], &mut receiver));
    values.map(|(channel, _)| channel).collect()
}

/// A keyframe is a sample's end only where samples are counted, and only if it belongs to a channel.
#[test]
fn a_keyframe_passes_on_its_own_channel() {
    static ADAPTIVE: AdaptiveStepForward<f32> = AdaptiveStepForward::new(0.5, 4);
    assert_eq!(passed_on(&STEP, 1), [1, 1, 1]);
    assert!(passed_on(&STEP, 2).is_empty() && passed_on(&ADAPTIVE, 2).is_empty());
    let ends = passed_on(&ADAPTIVE, 1);
    assert!(ends.len() > 3 && ends.contains(&0), "{ends:?}");
}

/// Ten sub-timesteps of 20 µs in a period of 1000: what comes later than the last belongs to none.
#[test]
fn an_event_after_the_last_sub_timestep_is_a_misfit() {
    let misfits = |slot: u32| {
        let mut link = Link::<_, 2>::new(&LINEAR, 20);
        let mut receiver = Receiver::new(&LINEAR).with_slot_ticks(20).with_clock_tolerance(0);
        link.send(1.0, false, &mut receiver);
        let at = link.now + PERIOD + slot * 20;
        link.line.send([spike_at(at.micros().into())], &mut receiver);
        receiver.misfits()
    };
    assert_eq!([0, 9, 10, 11].map(misfits), [0, 0, 1, 1]);
}

/// Each channel's filter runs as empty as it is long, whichever is the first.
#[test]
fn filters_of_different_lengths_run_empty_each() {
    let filter = |taps: &[f32]| {
        dynamic::Hough::<f32>::try_new(dynamic::Taps::try_new(taps).unwrap()).unwrap()
    };
    let (short, long) = (filter(&[0.2; 3]), filter(&[0.1; 15]));
    let mut receiver = Receiver::<_, 2>::per_channel([&short, &long]);
    let mut line = Line::new(2, 1_000);
    let mut beside = long.decoder();
    let mut truth = Vec::new();
    let mut exact = 0;
    for sample in 0..200_usize {
        let has_spike = sample % 8 == 0;
        if has_spike {
            line.send([spike_at(sample as u64 * 1_000)], &mut receiver);
            if let Some(value) = receiver.exact(1) {
                assert_eq!(value, truth[sample - 1], "{sample}");
                exact += 1;
            }
        }
        truth.push(beside.decode(if has_spike { Spike::Up } else { Spike::None }));
    }
    assert!(exact > 15);
}

/// A filter is empty after any silence, of which the sender was told; and samples go on from there.
#[test]
fn a_rate_code_knows_how_long_it_was_silent() {
    const MINUTE: u64 = 60_000_000;
    for minutes in [1, 35, 36, 40, 71, 72, 90, 143, 1_000, 100_000] {
        let mut receiver = Receiver::<_, 2>::new(&HOUGH);
        let mut line = Line::new(2, 1_000);
        let mut beside = HOUGH.decoder();
        let silent = minutes * MINUTE + (1 << 32) * (minutes / 90);
        let times = (0..20).chain(silent / 1_000..silent / 1_000 + 20).map(|time| time * 1_000);
        let mut before = (0, 0.0);
        for time in times {
            for now in (before.0..time).step_by(1 << 29) {
                line.transmitter.observe(Tick::from_micros(now));
            }
            for _ in 0..(time.saturating_sub(before.0) / 1_000).saturating_sub(1).min(7) {
                before.1 = beside.decode(Spike::None);
            }
            line.send([spike_at(time)], &mut receiver);
            if time > 10_000 {
                assert_eq!(receiver.exact(1), Some(before.1), "{minutes} minutes, {time}");
            }
            before = (time, beside.decode(Spike::Up));
        }
    }
}

/// What a receiver said of a flight of one channel.
#[derive(Debug, Default)]
struct Heard {
    right: usize,
    wrong: usize,
    misfits: u32,
    why: Option<Withheld>,
}

/// Sends samples at these ticks, a keyframe or heartbeat after every `beat` of them, and compares the last value that each
/// frame brings, if it is exact, with that of a decoder beside the encoder.
fn fly<P: Start<Sample = f32>>(
    scheme: &P,
    mut receiver: Receiver<&P, 1, 64>,
    ticks: impl IntoIterator<Item = u32>,
    beat: usize,
) -> Heard {
    let slot_ticks = if scheme.slots() > 1 { SLOT } else { 0 };
    receiver = receiver.with_slot_ticks(slot_ticks);
    let mut bank = Bank::<_, 1>::new(scheme).with_slot_ticks(slot_ticks);
    let mut link = Transmitter::for_bank(&bank, LATE_PERIOD, Session::counted(1));
    let (mut encoder, mut decoder) = (scheme.encoder(), scheme.decoder());
    let (mut reader, mut truth, mut heard) =
        (Reader::<MAX_FRAME>::new(), Vec::new(), Heard::default());
    for (number, tick) in ticks.into_iter().enumerate() {
        let (tick, time) = (Tick::from(tick), number as f32 * 0.07);
        let sample = 1.0 + time.sin() * 0.8 + (3.0 * time).cos() * 0.1;
        let queue = EventQueue::<128>::new(Overflow::Refuse);
        bank.encode_into(tick, [sample], &queue);
        let mut value = encoder.encode(sample).code().map_or(0.0, |code| decoder.decode(code));
        if number % beat == beat - 1 {
            bank.keyframe_into(tick, &queue);
            if let Some(keyframe) = encoder.keyframe() {
                decoder.resync(keyframe);
                value = keyframe;
            }
        }
        truth.push((tick, value));
        let (mut consumer, mut buffer) = (queue.consumer().unwrap(), [0; MAX_FRAME]);
        while let Some(mut bytes) = link.next_frame(&mut consumer, &mut buffer).unwrap() {
            let frame = reader.next_frame(&mut bytes).unwrap();
            let mut last = None;
            receiver.apply(&frame, |_, tick, value| last = Some((tick, value)));
            if let (Some(end), Some(exact)) = (last, receiver.exact(0)) {
                assert_eq!(end.1, exact);
                // Where the clock steps, a sample without events is told of where it was due.
                let is_near = |tick: Tick| tick.since(end.0).unsigned_abs() <= LATE_PERIOD / 2;
                let is_right = truth.iter().any(|&(tick, value)| is_near(tick) && value == end.1);
                heard.right += usize::from(is_right);
                heard.wrong += usize::from(!is_right);
            }
        }
    }
    Heard { misfits: receiver.misfits(), why: receiver.withheld(0), ..heard }
}

const LATE_PERIOD: u32 = 2_500;
const SLOT: u32 = 49;

/// The keyframe is older than the event before it: what was pending does not come on top.
#[test]
fn a_clock_that_steps_back_before_a_keyframe_makes_nothing_wrong() {
    static ADAPTIVE: AdaptiveStepForward<f32> = AdaptiveStepForward::new(0.2, 4);
    let period = LATE_PERIOD;
    for back in [1_500, 2_000, 5_000, 5_001, 50_000] {
        let ticks = (0..300).map(|at| 4_000_000 + at * period - (at + 1) / 5 * back);
        let heard = fly(&ADAPTIVE, Receiver::new(&ADAPTIVE), ticks, 5);
        assert!(heard.wrong == 0 && heard.right > 10, "{back}: {heard:?}");
        assert!(heard.misfits > 0, "{back}: {heard:?}");
    }
}

/// All events of a sample have its tick, so that it ends where another tick begins, however late that is.
#[test]
fn samples_of_a_population_code_may_be_late_by_anything() {
    let period = LATE_PERIOD;
    for late in [0, 1, 1_249, 1_250, 1_251, 2_000, 2_499, 7_000] {
        let ticks = (0..300).map(|at| 1_000_000 + at * period + at % 2 * late);
        let heard = fly(&POSITION, Receiver::new(&POSITION), ticks, 100);
        assert!(heard.wrong == 0 && heard.right > 290, "{late}: {heard:?}");
        assert_eq!(heard.misfits, 0, "{late}");
    }
}

/// Between heartbeats the samples' clock may run off by more than half a sub-timestep: nothing is exact then, unless the
/// receiver knows the clock better, or has measured it.
#[test]
fn sub_timesteps_are_told_apart_only_while_the_clock_is_known() {
    static SPIKE: FirstSpike<f32, 50> = FirstSpike::logarithmic(0.0..=2.0, 100.0);
    let drifting = |millionths: u64| {
        let period = u64::from(LATE_PERIOD);
        (0..4_000_u64)
            .map(move |at| (1_000_000 + at * period + at * period * millionths / 1_000_000) as u32)
    };
    for millionths in [0, 50, 1_000, 10_000, 20_000] {
        let rare = fly(&SPIKE, Receiver::new(&SPIKE), drifting(millionths), 390);
        assert_eq!((rare.wrong, rare.right), (0, 0), "{millionths}");
        assert_eq!(rare.why, Some(Withheld::Clock));
        let often = fly(&SPIKE, Receiver::new(&SPIKE), drifting(millionths), 20);
        assert!(often.wrong == 0 && often.right > 3_000, "{millionths}: {often:?}");
    }
    let known = Receiver::new(&SPIKE).with_clock_tolerance(50);
    let heard = fly(&SPIKE, known, drifting(50), 400);
    assert!(heard.wrong == 0 && heard.right > 3_000, "{heard:?}");
}

/// What was measured of one start says nothing of the next, whose clock may be at the other end of its tolerance.
#[test]
fn a_start_is_measured_anew() {
    static SPIKE: FirstSpike<f32, 50> = FirstSpike::logarithmic(0.0..=2.0, 100.0);
    let (mut reader, mut receiver) =
        (Reader::<MAX_FRAME>::new(), Receiver::<_, 1, 64>::new(&SPIKE).with_slot_ticks(SLOT));
    for (session, period) in [(1, 2_545), (2, 2_455), (3, 2_545)] {
        let mut bank = Bank::<_, 1>::new(&SPIKE).with_slot_ticks(SLOT);
        let mut link = Transmitter::for_bank(&bank, LATE_PERIOD, Session::counted(session));
        let (mut encoder, mut decoder) = (SPIKE.encoder(), SPIKE.decoder());
        let (mut truth, mut right) = (Vec::new(), 0);
        for number in 0..400 {
            let tick = Tick::from(1_000_000 * session + number * period);
            let sample = 1.0 + (number as f32 * 0.07).sin() * 0.8;
            let queue = EventQueue::<128>::new(Overflow::Refuse);
            bank.encode_into(tick, [sample], &queue);
            truth.push((tick, decoder.decode(encoder.encode(sample))));
            if number % 10 == 5 {
                bank.keyframe_into(tick, &queue);
            }
            let (mut consumer, mut buffer) = (queue.consumer().unwrap(), [0; MAX_FRAME]);
            while let Some(mut bytes) = link.next_frame(&mut consumer, &mut buffer).unwrap() {
                let frame = reader.next_frame(&mut bytes).unwrap();
                let mut last = None;
                receiver.apply(&frame, |_, tick, value| last = Some((tick, value)));
                if let (Some((tick, value)), Some(_)) = (last, receiver.exact(0)) {
                    let near = |known: Tick| tick.since(known).unsigned_abs() <= SLOT / 2;
                    let truth = truth.iter().find(|(known, _)| near(*known));
                    assert_eq!(truth.map(|truth| truth.1), Some(value), "{session} {number}");
                    right += 1;
                }
            }
        }
        assert!(right > 200, "{session}: {right}");
    }
}
