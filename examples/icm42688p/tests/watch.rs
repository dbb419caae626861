//! The loop, with a sensor that dies and comes back: what is counted, and what the far end knows.

mod world;

use flight::{Alignment, CHANNELS, Counters, Fault, Imu as _, Rounds, Schemes, Sender, Watch};
use icm42688p::{Icm42688p, NEW_BUFFER};
use spikewire::{
    EventQueue, Overflow, Tick,
    link::{MAX_FRAME, Reader, Receiver, Session},
};
use world::{Bus, Fate, Handle, Line, Pause};

type Imu = Icm42688p<'static, Bus>;

/// The far end.
struct Far {
    sender: Sender,
    reader: Reader<MAX_FRAME>,
    receiver: Receiver<Schemes<Imu>, CHANNELS>,
    ticks: Vec<u32>,
}

impl Far {
    fn new() -> Self {
        let receiver = Receiver::per_channel(Imu::SCHEMES);
        Self {
            sender: Sender::new::<Imu>(Session::counted(7)),
            reader: Reader::new(),
            receiver,
            ticks: Vec::new(),
        }
    }

    fn take(&mut self, queue: &EventQueue<512>) {
        let mut events = queue.consumer().unwrap();
        while let Some(mut bytes) = self.sender.next_frame(&mut events) {
            while let Some(received) = self.reader.next_frame(&mut bytes) {
                let ticks = &mut self.ticks;
                self.receiver.apply(&received, |_, tick, _| ticks.push(tick.micros()));
            }
        }
    }

    fn is_exact(&self) -> bool {
        (0..CHANNELS as u16).all(|channel| self.receiver.exact(channel).is_some())
    }
}

/// What one run showed.
struct Run {
    world: Handle,
    counters: Counters,
    /// The longest time in µs without a sign of life.
    longest: u64,
    ticks: Vec<u32>,
    /// Times in ms at which the far end's values became exact, or ceased to be.
    exact: Vec<(u64, bool)>,
    is_right: bool,
}

/// Runs for so many ms.
fn run(world: Handle, until: u64) -> Run {
    let rounds: &'static Rounds = Box::leak(Box::default());
    let queue = EventQueue::<512>::new(Overflow::DropOldest);
    let bytes = Box::leak(Box::new(NEW_BUFFER));
    let imu = Icm42688p::new(Bus(world.clone()), bytes);
    let (line, pause) = (Line(world.clone()), Pause(world.clone()));
    let now = || Tick::from_micros(world::micros());
    let mut watch = Watch::new(imu, line, pause, now, Alignment::Cw0, |_, _| (), rounds);
    let (mut seen, mut last, mut longest) = (0, 0, 0);
    let (mut far, mut exact) = (Far::new(), vec![(0, false)]);
    world.run(watch.run(&queue), until, |micros| {
        far.take(&queue);
        if rounds.went_on(&mut seen) {
            last = micros;
        }
        longest = longest.max(micros - last);
        if exact.last().unwrap().1 != far.is_exact() {
            exact.push((micros / 1000, far.is_exact()));
        }
    });
    far.take(&queue);
    assert_eq!(queue.lost(), 0);
    let values = (0..CHANNELS as u16).map(|channel| far.receiver.exact(channel));
    let is_right = values.eq((0..CHANNELS).map(|channel| watch.sampler().bank().keyframe(channel)));
    let counters = watch.sampler().counters();
    Run { world, counters, longest, ticks: far.ticks, exact, is_right }
}

fn fated(fates: &[(u64, Fate)], until: u64) -> Run {
    let world = Handle::new();
    world.0.borrow_mut().fates = fates.to_vec();
    run(world, until)
}

#[test]
fn a_second_of_samples_arrives_whole() {
    for period in [123_750, 125_000, 126_250] {
        let world = Handle::new();
        world.0.borrow_mut().period = period;
        let Run { world, counters, exact, is_right, ticks, .. } = run(world, 1_060);
        let sampled = world.0.borrow().sampled;
        // The first 50 ms are left out while the sensor settles; the last burst is in the FIFO.
        let expected = sampled - 50_000_000 / period as u32;
        assert!(expected.abs_diff(counters.samples) <= 16, "{expected} {counters:?}");
        assert_eq!((counters.missed, counters.failed, counters.deaths), (0, 0, 0));
        assert_eq!(exact.iter().map(|at| at.1).collect::<Vec<_>>(), [false, true]);
        assert!(is_right);
        assert!(ticks.is_sorted(), "time goes on");
    }
}

#[test]
fn every_failed_transfer_is_made_up_for() {
    // 29 transfers start the sensor; then one a millisecond.
    for failing in 1..60 {
        let world = Handle::new();
        world.0.borrow_mut().failing = vec![failing];
        let Run { counters, is_right, .. } = run(world, 400);
        let (failed, missed) = (counters.failed, counters.missed);
        assert_eq!(failed, if failing <= 29 { 0 } else { 8 }, "{failing}");
        assert_eq!((missed, counters.deaths), (0, 0), "{failing}: the FIFO kept what was not read");
        assert!(counters.samples > 1_200 && is_right, "{failing}: {counters:?}");
    }
}

#[test]
fn a_sensor_that_dies_and_comes_back() {
    for floats_to in [0x00, 0xFF, 0x47] {
        let fates = [(500, Fate::Dies(floats_to)), (1_500, Fate::Revives)];
        let Run { counters, exact, is_right, .. } = fated(&fates, 2_000);
        assert_eq!((counters.deaths, counters.starts), (1, 2), "{floats_to:#x}");
        let times: Vec<u64> = exact.iter().map(|at| at.0).collect();
        let [_, first, gone, back] = times[..] else { panic!("{exact:?}") };
        assert!(first < 60 && (500..=512).contains(&gone), "{exact:?}");
        assert!((1_500..=1_660).contains(&back), "{exact:?}");
        assert!(is_right);
    }
}

#[test]
fn a_short_dip_of_the_supply_is_no_rest() {
    // The sensor is there again, as after a reset: it samples nothing, and its identity is right.
    let fates = [(500, Fate::Dies(0)), (501, Fate::Revives)];
    let Run { counters, exact, .. } = fated(&fates, 1_000);
    assert_eq!((counters.deaths, counters.starts), (1, 2));
    assert_eq!(exact.len(), 4, "{exact:?}");
}

#[test]
fn no_sensor_at_all_is_tried_for_ever() {
    let Run { counters, longest, exact, .. } = fated(&[(0, Fate::Dies(0xFF))], 3_000);
    assert_eq!((counters.starts, counters.samples), (0, 0));
    assert!(longest < 200_000, "{longest} µs: each try feeds a watchdog");
    assert_eq!(exact, [(0, false)]);
}

#[test]
fn a_broken_interrupt_line_is_silence() {
    let fates = [(500, Fate::Line(false)), (900, Fate::Line(true))];
    let Run { counters, exact, is_right, .. } = fated(&fates, 1_500);
    assert!(counters.deaths >= 1, "{counters:?}");
    assert!(!exact.iter().any(|&(at, is_exact)| is_exact && (512..900).contains(&at)), "{exact:?}");
    assert!(is_right);
}

#[test]
fn a_late_task_loses_nothing_and_a_very_late_one_counts_it() {
    // The FIFO holds 16 ms.
    for (stall, is_lost) in [(1, false), (5, false), (8, false), (20, true), (200, true)] {
        let Run { counters, is_right, ticks, .. } = fated(&[(500, Fate::Stall(stall))], 1_000);
        assert_eq!(counters.missed > 0, is_lost, "{stall} ms: {counters:?}");
        assert!(is_right && ticks.is_sorted(), "{stall} ms");
        if is_lost {
            let all = counters.samples + counters.missed;
            assert!(all.abs_diff(948 * 8) <= 24, "{stall} ms: {counters:?}");
        }
    }
}

/// The clock of a board that never started: its ticks are all alike.
#[test]
fn a_clock_that_stands_still_is_a_fault() {
    use std::cell::Cell;
    thread_local!(static FAULT: Cell<Option<Fault>> = const { Cell::new(None) });

    let world = Handle::new();
    let (rounds, queue) = (Box::leak(Box::default()), EventQueue::<512>::new(Overflow::DropOldest));
    let imu = Icm42688p::new(Bus(world.clone()), Box::leak(Box::new(NEW_BUFFER)));
    let (line, pause) = (Line(world.clone()), Pause(world.clone()));
    let report = |_, fault| FAULT.set(fault);
    let mut watch = Watch::new(imu, line, pause, || Tick::from(7), Alignment::Cw0, report, rounds);
    world.run(watch.run(&queue), 1_000, |_| ());
    assert_eq!((FAULT.get(), watch.sampler().counters().samples), (Some(Fault::Clock), 0));
}

#[test]
fn the_fault_names_what_is_wrong() {
    let world = Handle::new();
    world.0.borrow_mut().is_alive = false;
    let mut imu = Icm42688p::new(Bus(world.clone()), Box::leak(Box::new(NEW_BUFFER)));
    let mut found = None;
    world.run(async { found = imu.start(&mut Pause(world.clone())).await.err() }, 100, |_| ());
    assert_eq!(found, Some(Fault::Identity(0)));
}

/// A stuck or floating line is noticed within the plan's patience, whatever it says.
#[test]
fn every_level_of_a_dead_line_is_noticed_in_time() {
    for level in [0x00, 0xFF] {
        let world = Handle::new();
        world.0.borrow_mut().fates = vec![(500, Fate::Stuck(level))];
        let Run { exact, .. } = run(world, 700);
        let gone = exact.get(2).unwrap().0;
        assert!((500..=512).contains(&gone), "{level:#x}: {exact:?}");
    }
}
