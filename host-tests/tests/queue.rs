//! The queues from interrupts to main: their policies against a model, their losses item by item, and both
//! under real threads.

use std::collections::VecDeque;
use std::future::Future;
use std::pin::pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::task::{Context, Poll, Wake, Waker};
use std::thread;

use proptest::prelude::*;
use spikewire::{
    Event, EventQueue, Item, Keyframe, Overflow, Polarity, Put, Refused, Source, SpscQueue, Taken,
    Tick,
};

const POLICIES: [Overflow; 3] = [Overflow::DropOldest, Overflow::DropNewest, Overflow::Refuse];

/// An item of any kind, by its number.
fn item(number: u32) -> Item {
    let tick = Tick::from(number);
    let address = number as u16;
    match number % 5 {
        0 => Item::Break(tick),
        1 => Item::Keyframe(Keyframe::new(tick, address, number as f32)),
        2 => Item::Keyframe(Keyframe::new(tick, address, -(number as i16))),
        3 => Item::Event(Event { tick, address, polarity: Polarity::Up }),
        _ => Item::Event(Event { tick, address, polarity: Polarity::Down }),
    }
}

/// What a queue of this room should do.
struct Model {
    overflow: Overflow,
    room: usize,
    /// Numbers, with what was lost before each.
    items: VecDeque<(u32, u32)>,
    behind: u32,
    last: u32,
    lost: u32,
    refused: u32,
    peak: usize,
}

impl Model {
    fn new(overflow: Overflow, room: usize) -> Self {
        let items = VecDeque::new();
        Self { overflow, room, items, behind: 0, last: 0, lost: 0, refused: 0, peak: 0 }
    }

    /// Whether the item comes back.
    fn push(&mut self, number: u32, comes_back: bool) -> bool {
        let is_full = self.items.len() == self.room;
        if is_full && self.overflow == Overflow::DropOldest {
            let (_, before) = self.items.pop_front().unwrap();
            self.items.push_back((number, 0));
            self.items[0].1 += before + 1;
            self.lost += 1;
            return false;
        }
        if is_full {
            self.refused += u32::from(self.overflow == Overflow::Refuse);
            if self.overflow == Overflow::Refuse && comes_back {
                return true;
            }
            (self.lost, self.behind, self.last) = (self.lost + 1, self.behind + 1, number);
            return false;
        }
        self.items.push_back((number, std::mem::take(&mut self.behind)));
        self.peak = self.peak.max(self.items.len());
        false
    }

    fn take(&mut self) -> Option<Taken> {
        if let Some((number, lost)) = self.items.pop_front() {
            return Some(Taken { lost, item: item(number) });
        }
        let lost = std::mem::take(&mut self.behind);
        (lost > 0).then(|| Taken { lost, item: Item::Break(Tick::from(self.last)) })
    }
}

proptest! {
    #![proptest_config(crate::common::cases(256))]

    #[test]
    fn every_policy_does_what_it_says(
        overflow in prop::sample::select(&POLICIES[..]),
        actions in prop::collection::vec(0..5_u8, 0..400),
    ) {
        const ROOM: usize = 5;
        let queue = EventQueue::<ROOM>::new(overflow);
        let mut consumer = queue.consumer().unwrap();
        let mut model = Model::new(overflow, ROOM);
        for (number, action) in (1..).zip(actions) {
            match action {
                0 | 1 => {
                    let expected = if model.push(number, true) { Err(Refused(item(number))) } else { Ok(()) };
                    prop_assert_eq!(queue.push(item(number)), expected);
                }
                2 => {
                    model.push(number, false);
                    (&queue).put(item(number));
                }
                _ => prop_assert_eq!(consumer.take(), model.take()),
            }
            prop_assert_eq!(queue.len(), model.items.len());
        }
        prop_assert_eq!((queue.lost(), queue.refused(), queue.peak()), (model.lost, model.refused, model.peak));
        while let Some(taken) = model.take() {
            prop_assert_eq!(consumer.take(), Some(taken));
        }
        prop_assert_eq!(consumer.take(), None);
    }

    #[test]
    fn the_queue_without_locks_drops_the_newest(actions in prop::collection::vec(any::<bool>(), 0..400)) {
        let queue = SpscQueue::<4>::new();
        let (mut producer, mut consumer) = queue.split().unwrap();
        prop_assert!(queue.split().is_none());
        let mut model = Model::new(Overflow::DropNewest, 3);
        for (number, is_push) in (1..).zip(actions) {
            if is_push {
                model.push(number, false);
                producer.push(item(number));
            } else {
                prop_assert_eq!(consumer.take(), model.take());
            }
            prop_assert_eq!((consumer.len(), consumer.lost()), (model.items.len(), model.lost));
        }
    }
}

/// A slot of 12 bytes says up to 254 losses; more are kept apart, and none is forgotten.
#[test]
fn any_number_of_losses_is_said() {
    for overflow in POLICIES {
        for lost in [1, 254, 255, 256, 300, 70_000] {
            let queue = EventQueue::<2>::new(overflow);
            let mut consumer = queue.consumer().unwrap();
            for number in 0..2 + lost {
                (&queue).put(item(number));
            }
            let mut said = Vec::new();
            said.extend(consumer.take());
            (&queue).put(item(9));
            said.extend(std::iter::from_fn(|| consumer.take()));
            let losses: Vec<u32> = said.iter().map(|taken| taken.lost).collect();
            let expected =
                if overflow == Overflow::DropOldest { [lost, 0, 0] } else { [0, 0, lost] };
            assert_eq!(losses, expected, "{overflow:?}");
            assert_eq!(queue.lost(), lost);
        }
    }
}

/// Two runs of more than 254 losses in the queue at once: both are told at their places.
#[test]
fn long_losses_at_several_places() {
    let queue = EventQueue::<3>::new(Overflow::DropNewest);
    let mut consumer = queue.consumer().unwrap();
    let mut number = 0..;
    let mut put =
        |count: usize| number.by_ref().take(count).for_each(|number| (&queue).put(item(number)));
    put(3 + 300);
    consumer.take();
    put(1 + 400);
    consumer.take();
    put(1 + 500);
    let losses: Vec<_> = std::iter::from_fn(|| consumer.take()).map(|taken| taken.lost).collect();
    assert_eq!(losses.len(), 4);
    assert_eq!(losses.iter().sum::<u32>(), queue.lost());
    assert!(losses[0] == 0 && losses[1..].iter().all(|&lost| lost >= 255), "{losses:?}");
}

#[test]
fn there_is_one_consumer_at_a_time() {
    let queue = EventQueue::<4>::new(Overflow::DropOldest);
    let consumer = queue.consumer().unwrap();
    assert!(queue.consumer().is_none());
    drop(consumer);
    assert!(queue.consumer().is_some());
}

#[test]
fn what_waits_ends_although_items_keep_coming() {
    let queue = EventQueue::<4>::new(Overflow::DropOldest);
    let mut consumer = queue.consumer().unwrap();
    queue.push(item(0)).unwrap();
    queue.push(item(1)).unwrap();
    let mut waiting = consumer.waiting();
    let mut taken = Vec::new();
    while let Some(next) = waiting.take() {
        queue.push(item(9)).unwrap();
        taken.push(next.item);
    }
    assert_eq!(taken, [item(0), item(1)]);
    assert_eq!(queue.len(), 2);
}

#[test]
fn queues_of_any_room_go_behind_one_reference() {
    let (small, large) =
        (EventQueue::<1>::new(Overflow::Refuse), EventQueue::<9>::new(Overflow::Refuse));
    let rooms = [&*small, &*large].map(spikewire::QueueView::capacity);
    assert_eq!(rooms, [1, 9]);
}

/// As a bank puts an item.
fn put(mut to: impl Put, item: Item) {
    to.put(item);
}

/// Keyframes, breaks and heartbeats are passed over by who needs events alone.
#[test]
fn events_alone_come_in_their_order() {
    let queue = EventQueue::<16>::new(Overflow::Refuse);
    let without_locks = SpscQueue::<16>::new();
    let (mut producer, mut events) = without_locks.split().unwrap();
    for number in 0..15 {
        queue.push(item(number)).unwrap();
        put(&mut producer, item(number));
    }
    let expected = || {
        (0..15)
            .map(item)
            .filter_map(|item| if let Item::Event(event) = item { Some(event) } else { None })
    };
    let mut consumer = queue.consumer().unwrap();
    assert!(std::iter::from_fn(|| consumer.take_event()).eq(expected()));
    assert!(std::iter::from_fn(|| events.take_event()).eq(expected()));
    assert_eq!((consumer.take(), events.take()), (None, None), "all are taken");
}

#[test]
fn queues_say_how_full_they_are() {
    let queue = EventQueue::<2>::new(Overflow::Refuse);
    assert!(queue.is_empty());
    queue.push(item(0)).unwrap();
    assert!(!queue.is_empty());
    assert_eq!(
        format!("{queue:?}"),
        "EventQueue { overflow: Refuse, capacity: 2, len: 1, lost: 0, .. }"
    );
    queue.push(item(1)).unwrap();
    let refused = queue.push(item(7)).unwrap_err();
    assert_eq!(refused.to_string(), "the queue is full and refused the item of tick 7");

    let without_locks = SpscQueue::<2>::new();
    let (mut producer, consumer) = without_locks.split().unwrap();
    assert!(consumer.is_empty());
    for number in 0..4 {
        put(&mut producer, item(number));
    }
    assert!(!consumer.is_empty());
    assert_eq!((producer.lost(), consumer.lost()), (3, 3), "there is room for one");
    put(producer, item(5));
    assert_eq!(consumer.lost(), 4);
}

struct Woken(AtomicU32);

impl Wake for Woken {
    fn wake(self: Arc<Self>) {
        self.0.fetch_add(1, Ordering::SeqCst);
    }
}

#[test]
fn a_push_wakes_who_waits() {
    let queue = EventQueue::<4>::new(Overflow::DropOldest);
    let mut consumer = queue.consumer().unwrap();
    let woken = Arc::new(Woken(AtomicU32::new(0)));
    let waker = Waker::from(woken.clone());
    let mut context = Context::from_waker(&waker);
    {
        let mut wait = pin!(consumer.wait());
        assert_eq!(wait.as_mut().poll(&mut context), Poll::Pending);
        assert_eq!(woken.0.load(Ordering::SeqCst), 0);
        queue.push(item(3)).unwrap();
        assert_eq!(woken.0.load(Ordering::SeqCst), 1);
        assert_eq!(wait.as_mut().poll(&mut context), Poll::Ready(()));
    }
    queue.push(item(4)).unwrap();
    assert_eq!(woken.0.load(Ordering::SeqCst), 1, "nobody waits");
    assert_eq!(pin!(consumer.wait()).poll(&mut context), Poll::Ready(()));
}

const STORM: u32 = 50_000;

/// Takes all of a storm, item by item in order, with every loss at its place.
fn outlast(mut source: impl Source, is_over: impl Fn() -> bool) {
    let mut next = 0;
    loop {
        let ends = is_over();
        while let Some(Taken { lost, item: found }) = source.take() {
            next += lost;
            match found {
                Item::Break(tick) if lost > 0 && tick.micros() == next - 1 => {}
                found => {
                    assert_eq!(found, item(next));
                    next += 1;
                }
            }
        }
        if ends {
            break;
        }
    }
    assert_eq!(next, STORM);
}

#[test]
fn a_storm_loses_nothing_unsaid() {
    static OLDEST: EventQueue<16> = EventQueue::new(Overflow::DropOldest);
    static NEWEST: EventQueue<16> = EventQueue::new(Overflow::DropNewest);
    for queue in [&OLDEST, &NEWEST] {
        let storm =
            thread::spawn(|| (0..STORM).for_each(|number| queue.push(item(number)).unwrap()));
        outlast(queue.consumer().unwrap(), || storm.is_finished());
        storm.join().unwrap();
        assert!(queue.peak() <= 16);
    }
}

#[test]
fn a_storm_without_locks_loses_nothing_unsaid() {
    let queue = SpscQueue::<16>::new();
    let (mut producer, consumer) = queue.split().unwrap();
    thread::scope(|scope| {
        let storm = scope.spawn(move || (0..STORM).for_each(|number| producer.push(item(number))));
        outlast(consumer, || storm.is_finished());
    });
}
