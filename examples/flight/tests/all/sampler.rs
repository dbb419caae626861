//! What the far end is told of a sensor that dies.

use flight::{Counters, Plan, Sampler, Why};
use spikewire::{
    Bank, Item, Put, Tick,
    temporal::{SendOnDelta, StepForward},
};

static SCHEME: SendOnDelta<i16, 4> = SendOnDelta::new(10);

const PLAN: Plan = Plan {
    period: 1_000,
    settle: 2,
    keyframe_every: 5,
    patience: 4_500,
    burst: 1,
    most_alike: 3,
    most_spikes: 4,
};

#[derive(Default)]
struct Log(Vec<Item>);

impl Put for &mut Log {
    fn put(&mut self, item: Item) {
        self.0.push(item);
    }
}

fn at(sample: u32) -> Tick {
    Tick::from_micros(u64::from(sample) * 1_000)
}

type Two = Sampler<&'static SendOnDelta<i16, 4>, 2>;

fn sampler() -> Two {
    let mut sampler = Sampler::new(Bank::new(&SCHEME), PLAN);
    assert_eq!(sampler.look(at(0), &mut Log::default()), Some(Why::NotStarted));
    sampler.started(at(0));
    sampler
}

/// A sample that differs from the one before, as noise has it.
fn noise(sample: u32) -> Result<[i16; 2], ()> {
    Ok([(sample % 2) as i16; 2])
}

fn fly(sampler: &mut Two, samples: std::ops::Range<u32>, log: &mut Log) {
    for sample in samples {
        sampler.take(at(sample), noise(sample), &mut *log);
    }
}

fn breaks(log: &Log) -> usize {
    log.0.iter().filter(|item| matches!(item, Item::Break(_))).count()
}

fn keyframes(log: &Log) -> Vec<u32> {
    let of = |item: &Item| match item {
        Item::Keyframe(keyframe) => Some(keyframe.tick.micros() / 1_000),
        _ => None,
    };
    log.0.iter().filter_map(of).collect()
}

#[test]
fn a_living_sensor_settles_and_has_keyframes() {
    let (mut sampler, mut log) = (sampler(), Log::default());
    fly(&mut sampler, 1..14, &mut log);
    assert_eq!(sampler.look(at(14), &mut log), None);
    let counters = Counters { samples: 11, discarded: 2, starts: 1, ..Counters::default() };
    assert_eq!(sampler.counters(), counters);
    // Of both channels: with the first sample, then every five.
    assert_eq!(keyframes(&log), [3, 3, 8, 8, 13, 13]);
    assert_eq!(breaks(&log), 0);
}

#[test]
fn what_a_sensor_says_before_it_has_settled_is_no_baseline() {
    let (mut sampler, mut log) = (sampler(), Log::default());
    for (sample, value) in [(1, i16::MIN), (2, i16::MAX), (3, 7)] {
        sampler.take(at(sample), Ok::<_, ()>([value; 2]), &mut log);
    }
    assert_eq!(sampler.bank().keyframe(0), Some(7));
    assert!(log.0.iter().all(|item| !matches!(item, Item::Event(_))));
}

#[test]
fn silence_is_told_once_and_each_failed_start_again() {
    let (mut sampler, mut log) = (sampler(), Log::default());
    fly(&mut sampler, 1..11, &mut log);
    assert_eq!(sampler.look(at(14), &mut log), None, "within the plan's patience");
    assert_eq!(sampler.look(at(15), &mut log), Some(Why::Silent));
    assert_eq!(sampler.look(at(16), &mut log), Some(Why::Silent));
    assert_eq!(breaks(&log), 1);
    sampler.failed_to_start(at(17), &mut log);
    sampler.failed_to_start(at(18), &mut log);
    assert_eq!(breaks(&log), 3);

    // Back: it settles, and its first sample is a keyframe.
    sampler.started(at(20));
    let before = log.0.len();
    fly(&mut sampler, 21..24, &mut log);
    log.0.drain(..before);
    assert_eq!(keyframes(&log), [23, 23]);
    assert_eq!(sampler.look(at(24), &mut log), None);
    let Counters { deaths, starts, missed, .. } = sampler.counters();
    assert_eq!((deaths, starts, missed), (1, 2, 0), "a death is no row of missed samples");
}

#[test]
fn a_data_ready_that_never_comes_is_silence_too() {
    let (mut sampler, mut log) = (sampler(), Log::default());
    assert_eq!(sampler.look(at(4), &mut log), None);
    assert_eq!(sampler.look(at(5), &mut log), Some(Why::Silent));
    assert_eq!(breaks(&log), 1);
}

#[test]
fn a_sensor_that_says_the_same_is_stuck() {
    for value in [2, -1, 77] {
        let (mut sampler, mut log) = (sampler(), Log::default());
        fly(&mut sampler, 1..11, &mut log);
        for sample in 11..20 {
            assert_eq!(sampler.is_alive(), sample < 15, "{sample}");
            sampler.take(at(sample), Ok::<_, ()>([value; 2]), &mut log);
        }
        assert_eq!(sampler.look(at(20), &mut log), Some(Why::Stuck));
        assert_eq!(breaks(&log), 1);
    }
}

/// An accelerometer of its own die, whose rates go on.
#[test]
fn one_frozen_half_of_the_channels_is_stuck() {
    for half in [0, 1] {
        let (mut sampler, mut log) = (sampler(), Log::default());
        fly(&mut sampler, 1..11, &mut log);
        for sample in 11..15 {
            let mut values = noise(sample).unwrap();
            values[half] = 1;
            sampler.take(at(sample), Ok::<_, ()>(values), &mut log);
        }
        assert_eq!(sampler.look(at(15), &mut log), Some(Why::Stuck), "{half}");
    }
}

#[test]
fn reads_that_go_on_failing_end_it_and_single_ones_do_not() {
    let (mut sampler, mut log) = (sampler(), Log::default());
    fly(&mut sampler, 1..11, &mut log);
    for sample in 11..40 {
        let read = if sample % 4 == 3 { noise(sample / 4) } else { Err(()) };
        sampler.take(at(sample), read, &mut log);
    }
    assert!(sampler.is_alive(), "three of four");
    for sample in 40..44 {
        sampler.take(at(sample), Err(()), &mut log);
    }
    assert_eq!(sampler.look(at(44), &mut log), Some(Why::Failing));
    assert_eq!(breaks(&log), 1);
}

/// A bus that is held hangs in each read for some samples, until it is given up: the limit is one of time.
#[test]
fn reads_that_hang_end_it_no_later() {
    for hangs in 1..5 {
        let (mut sampler, mut log) = (sampler(), Log::default());
        fly(&mut sampler, 1..11, &mut log);
        let edges = (10 + hangs..).step_by(hangs as usize);
        let last = edges.take_while(|&edge| {
            sampler.take(at(edge), Err(()), &mut log);
            sampler.is_alive()
        });
        let last = last.last().unwrap_or(10);
        // Three may fail; the first read's own time is not known.
        assert!(last <= 10 + hangs + 3, "{hangs}: {last}");
    }
}

#[test]
fn edges_that_nobody_saw_are_counted() {
    let (mut sampler, mut log) = (sampler(), Log::default());
    for (sample, missed) in [(1, 0), (2, 0), (4, 1), (5, 1), (8, 3), (9, 3)] {
        sampler.take(at(sample), noise(sample), &mut log);
        assert_eq!(sampler.counters().missed, missed, "{sample}");
    }
    // A clock that is two in a hundred off is no missed sample; neither is an edge that comes twice.
    let (mut sampler, mut log) = (self::sampler(), Log::default());
    for sample in 1..1_000 {
        let tick = Tick::from_micros(sample * 1_020);
        sampler.take(tick, noise(sample as u32), &mut log);
        sampler.take(tick, noise(sample as u32), &mut log);
    }
    assert_eq!(sampler.counters().missed, 0);
}

#[test]
fn ticks_that_wrap_are_no_silence() {
    let (mut sampler, mut log) = (sampler(), Log::default());
    let near_the_end = |sample: u32| Tick::from((u32::MAX - 4_999).wrapping_add(sample * 1_000));
    sampler.started(near_the_end(0));
    for sample in 1..20 {
        sampler.take(near_the_end(sample), noise(sample), &mut log);
        assert_eq!(sampler.look(near_the_end(sample), &mut log), None);
    }
    assert_eq!(sampler.counters().missed, 0);
    assert_eq!(sampler.look(near_the_end(24), &mut log), Some(Why::Silent));
}

#[test]
fn a_channel_at_its_codes_limit_is_counted() {
    let (mut sampler, mut log) = (sampler(), Log::default());
    fly(&mut sampler, 1..4, &mut log);
    for (sample, values, at_limit) in
        [(4, [31, 0], 0), (5, [52, 0], 0), (6, [200, 90], 2), (7, [200, 91], 4), (8, [200, 92], 5)]
    {
        sampler.take(at(sample), Ok::<_, ()>(values), &mut log);
        assert_eq!(sampler.counters().at_limit, at_limit, "{sample}");
    }
}

/// Of a code of one spike a sample a spike says nothing; one in the next sample, too, does.
#[test]
fn a_code_of_one_spike_is_at_its_limit_in_two_samples_in_a_row() {
    static STEP: StepForward<i16> = StepForward::new(10);
    let plan = Plan { most_spikes: 1, settle: 0, ..PLAN };
    let (mut sampler, mut log) = (Sampler::<_, 2>::new(Bank::new(&STEP), plan), Log::default());
    sampler.started(at(0));
    for (sample, values, at_limit) in
        [(1, [0, 0], 0), (2, [11, 0], 0), (3, [12, 11], 0), (4, [40, 50], 1), (5, [50, 51], 3)]
    {
        sampler.take(at(sample), Ok::<_, ()>(values), &mut log);
        assert_eq!(sampler.counters().at_limit, at_limit, "{sample}");
    }
}
