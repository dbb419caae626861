//! The queue from an interrupt to main: its policies against a model, and under real threads.

use std::collections::VecDeque;
use std::thread;

use proptest::prelude::*;
use spikewire::sink::{EventQueue, Overflow, Refused};
use spikewire::{Event, EventSource, Polarity};

fn event(tick: u32) -> Event {
    Event { tick, address: tick as u16, polarity: Polarity::Down }
}

fn policy() -> impl Strategy<Value = Overflow> {
    prop_oneof![Just(Overflow::DropOldest), Just(Overflow::DropNewest), Just(Overflow::Refuse)]
}

proptest! {
    #[test]
    fn every_policy_does_what_it_says(
        overflow in policy(),
        actions in prop::collection::vec(any::<bool>(), 0..200),
    ) {
        const ROOM: usize = 7;
        let queue = EventQueue::<ROOM>::new(overflow);
        let mut model = VecDeque::new();
        let (mut lost, mut refused, mut peak) = (0, 0, 0);
        for (tick, &is_push) in actions.iter().enumerate() {
            if is_push {
                let event = event(tick as u32);
                let mut expected = Ok(());
                match overflow {
                    _ if model.len() < ROOM => model.push_back(event),
                    Overflow::DropOldest => {
                        model.pop_front();
                        model.push_back(event);
                        lost += 1;
                    }
                    Overflow::DropNewest => lost += 1,
                    Overflow::Refuse => {
                        refused += 1;
                        expected = Err(Refused(event));
                    }
                }
                prop_assert_eq!(queue.push(event), expected);
            } else {
                prop_assert_eq!(queue.pop(), model.pop_front());
            }
            peak = peak.max(model.len());
            prop_assert_eq!(queue.len(), model.len());
        }
        prop_assert_eq!((queue.lost(), queue.refused(), queue.peak()), (lost, refused, peak));
        prop_assert!(queue.drain().into_iter().eq(model));
        prop_assert!(queue.is_empty());
    }
}

#[test]
fn a_drain_ends_although_events_keep_coming() {
    let queue = EventQueue::<4>::new(Overflow::DropOldest);
    queue.push(event(0)).unwrap();
    queue.push(event(1)).unwrap();
    let drained: Vec<_> =
        queue.drain().into_iter().inspect(|_| queue.push(event(9)).unwrap()).collect();
    assert_eq!(drained, [event(0), event(1)]);
    assert_eq!(queue.len(), 2);
}

#[test]
fn a_storm_loses_nothing_uncounted() {
    static EVENTS: EventQueue<16> = EventQueue::new(Overflow::DropOldest);
    const STORM: u32 = 50_000;

    let storm = thread::spawn(|| (0..STORM).for_each(|tick| EVENTS.push(event(tick)).unwrap()));
    let (mut taken, mut last) = (0, None);
    loop {
        let is_over = storm.is_finished();
        while let Some(event) = (&EVENTS).next_event() {
            assert!(last < Some(event.tick), "events stay in order");
            last = Some(event.tick);
            taken += 1;
        }
        if is_over {
            break;
        }
    }
    storm.join().unwrap();
    assert_eq!(taken + EVENTS.lost(), STORM);
    assert_eq!(last, Some(STORM - 1));
    assert!(EVENTS.peak() <= 16);
}
