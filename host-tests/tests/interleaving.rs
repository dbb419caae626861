//! Every order in which interrupts, main and the line can act, from samples to values: what a receiver calls
//! exact is what the encoder held.
//!
//! Small cases are searched exhaustively, and large ones at random. An interrupt may come before every call of
//! main's to the queue, and one of higher priority before every push of the other's. Frames may be lost, sent
//! twice or overtaken; encoders are reset, senders reboot, and readers are replaced.
//!
//! Four faults of an earlier design can be put back; the search finds each of them.

use crate::interleaving_world::{Case, Chooser, Fault, World};
use spikewire::{EventQueue, Overflow};

const POLICIES: [Overflow; 3] = [Overflow::DropOldest, Overflow::DropNewest, Overflow::Refuse];

/// Runs every schedule of a case, and says how many there are and how often a value was called exact.
fn search<const N: usize>(case: Case) -> Result<(u64, u64), String> {
    let (mut schedules, mut claims) = (0, 0);
    let mut chooser = Chooser::every();
    loop {
        let queues = [(); 3].map(|()| EventQueue::<N>::new(case.overflow));
        let views = queues.each_ref().map(|queue| &**queue);
        let world = World::new(case, views, chooser);
        claims += world.run()?;
        schedules += 1;
        chooser = world.into_chooser();
        if !chooser.advance() {
            return Ok((schedules, claims));
        }
    }
}

/// Runs schedules drawn at random.
fn draw<const N: usize>(case: Case, seeds: std::ops::Range<u64>) -> Result<(u64, u64), String> {
    let (mut schedules, mut claims) = (0, 0);
    for seed in seeds {
        let queues = [(); 3].map(|()| EventQueue::<N>::new(case.overflow));
        let views = queues.each_ref().map(|queue| &**queue);
        let world = World::new(case, views, Chooser::random(seed));
        claims += world.run()?;
        schedules += 1;
    }
    Ok((schedules, claims))
}

/// The same case under each policy, with queues of 2, 3 and 4.
fn search_all(case: Case) -> (u64, u64) {
    let start = std::time::Instant::now();
    let mut total = (0, 0);
    for overflow in POLICIES {
        let case = Case { overflow, ..case };
        for found in [search::<2>(case), search::<3>(case), search::<4>(case)] {
            let (schedules, claims) = found.unwrap();
            total = (total.0 + schedules, total.1 + claims);
        }
    }
    println!("{total:?} schedules and claims in {:.1?}: {case:?}", start.elapsed());
    total
}

const SMALL: Case = Case {
    overflow: Overflow::DropOldest,
    interrupts: 0,
    nested: 0,
    line_faults: 0,
    reboots: 0,
    readers: 0,
    resets: 0,
    frames: 2,
    room: 64,
    fault: None,
};

/// Some 400 000 schedules.
#[test]
fn no_order_of_events_makes_a_receiver_wrong() {
    let cases = [
        // Interrupts alone.
        Case { interrupts: 3, frames: 1, ..SMALL },
        Case { interrupts: 2, nested: 3, frames: 1, ..SMALL },
        Case { interrupts: 2, resets: 2, frames: 1, ..SMALL },
        // The line.
        Case { interrupts: 2, line_faults: 2, frames: 3, ..SMALL },
        Case { interrupts: 2, line_faults: 2, frames: 3, room: 38, ..SMALL },
        Case { interrupts: 1, line_faults: 1, resets: 1, readers: 1, ..SMALL },
        // Reboots.
        Case { interrupts: 2, line_faults: 2, reboots: 1, ..SMALL },
        Case { interrupts: 1, line_faults: 3, reboots: 2, frames: 4, ..SMALL },
    ];
    let totals = cases.map(search_all);
    let schedules: u64 = totals.iter().map(|total| total.0).sum();
    let claims: u64 = totals.iter().map(|total| total.1).sum();
    println!("{schedules} schedules, {claims} times exact");
    assert!(schedules > 350_000 && claims > schedules);
}

const LARGE: Case = Case {
    interrupts: 60,
    nested: 30,
    line_faults: 12,
    reboots: 2,
    readers: 2,
    resets: 3,
    frames: 30,
    ..SMALL
};

fn draw_all(seeds: std::ops::Range<u64>) {
    for overflow in POLICIES {
        for room in [38, 64] {
            let case = Case { overflow, room, ..LARGE };
            let calm = Case { line_faults: 2, reboots: 1, resets: 1, ..case };
            for case in [case, calm] {
                draw::<2>(case, seeds.clone()).unwrap();
                draw::<4>(case, seeds.clone()).unwrap();
                draw::<64>(case, seeds.clone()).unwrap();
            }
        }
    }
}

#[test]
fn nor_does_a_long_one() {
    draw_all(0..300);
}

#[test]
#[ignore = "takes many minutes"]
fn the_long_search() {
    for case in [
        Case { interrupts: 2, line_faults: 1, resets: 1, readers: 1, ..SMALL },
        Case { interrupts: 6, ..SMALL },
        Case { interrupts: 5, nested: 3, ..SMALL },
        Case { interrupts: 4, nested: 2, resets: 1, line_faults: 1, ..SMALL },
        Case { interrupts: 4, line_faults: 3, frames: 4, room: 38, ..SMALL },
        Case { interrupts: 4, line_faults: 2, reboots: 1, readers: 1, frames: 3, ..SMALL },
        Case { interrupts: 3, line_faults: 4, reboots: 2, frames: 4, ..SMALL },
    ] {
        search_all(case);
    }
    draw_all(0..30_000);
}

/// The search finds each of the faults when it is put back, and nothing without it.
#[test]
fn the_faults_put_back_are_found() {
    finds::<2>(Fault::LossReadApart, Case { interrupts: 4, frames: 1, ..SMALL });
    // With room for all, so that nothing is lost.
    finds::<16>(Fault::KeyframesBeside, Case { interrupts: 2, frames: 1, ..SMALL });
    finds::<16>(
        Fault::KeyframeKeptOverReset,
        Case { interrupts: 2, resets: 1, frames: 1, ..SMALL },
    );
    finds::<16>(Fault::SessionsAlike, Case { interrupts: 2, line_faults: 2, reboots: 1, ..SMALL });
}

fn finds<const N: usize>(fault: Fault, case: Case) {
    let found = search::<N>(Case { fault: Some(fault), ..case });
    println!("{fault:?}: {found:?}");
    assert!(found.is_err(), "{fault:?} was not found");
    let without = search::<N>(case);
    assert!(without.is_ok(), "{fault:?}: {without:?}");
}
