//! The containers of `heapless` as ends of queues: what is put comes out in order, and what is lost is told.

use std::collections::VecDeque;
use std::thread;

use heapless::{Deque, Vec as Short, mpmc, spsc};
use proptest::prelude::*;
use spikewire::out::Batch;
use spikewire::{
    Bank, Container, Counted, Element, Event, FromItems, Item, Keyframe, Polarity, Put, Source,
    Taken, Tick, temporal::TemporalContrast,
};
use spikewire_cameras::format::{Edvs, EdvsTime, Formatted};

const ROOM: usize = 4;

fn event(number: u32) -> Event {
    Event { tick: Tick::from(number), address: number as u16, polarity: Polarity::Up }
}

/// An item of each kind in turn.
fn item(number: u32) -> Item {
    let tick = Tick::from(number);
    match number % 3 {
        0 => Item::Event(event(number)),
        1 => Item::Keyframe(Keyframe::new(tick, 7, number as i16)),
        _ => Item::Break(tick),
    }
}

/// What a container of this room does, by the words of its documentation.
#[derive(Default)]
struct Model {
    held: VecDeque<Taken>,
    pending: u32,
    lost: u32,
}

impl Model {
    fn put(&mut self, item: Item) {
        if self.held.len() < ROOM {
            self.held.push_back(Taken { lost: self.pending, item });
            self.pending = 0;
        } else {
            self.pending += 1;
            self.lost += 1;
        }
    }
}

/// The library warns of losses where operations overlap, which are counted here.
#[expect(deprecated)]
fn shared<const N: usize>() -> mpmc::Queue<Taken, N> {
    mpmc::Queue::new()
}

/// Puts and takes as the actions say, and compares each step with the model.
fn check<C: Container<Element = Taken>>(
    actions: &[bool],
    end: C,
    mut take: impl FnMut(&mut C) -> Option<Taken>,
) {
    let (mut model, mut ours) = (Model::default(), Counted::new(end));
    for (number, &puts) in (0..).zip(actions) {
        if puts {
            model.put(item(number));
            ours.put(item(number));
        } else {
            assert_eq!(take(ours.container()), model.held.pop_front());
        }
        assert_eq!((ours.lost(), ours.left_out()), (model.lost, 0));
    }
}

proptest! {
    #![proptest_config(crate::common::cases(256))]

    #[test]
    fn each_container_holds_what_fits_and_tells_the_rest(actions in proptest::collection::vec(prop::bool::weighted(0.6), 0..80)) {
        check(&actions, Deque::<Taken, ROOM>::new(), Source::take);
        let mut deque = Deque::<Taken, ROOM>::new();
        check(&actions, deque.as_mut_view(), Source::take);
        let mut queue = spsc::Queue::<Taken, { ROOM + 1 }>::new();
        let (producer, mut consumer) = queue.split();
        check(&actions, producer, |_| consumer.take());
        let queue = shared::<ROOM>();
        check(&actions, &queue, Source::take);
        check(&actions, Short::<Taken, ROOM>::new(), |vec| {
            let first = FromItems(vec.iter().copied()).take()?;
            vec.remove(0);
            Some(first)
        });
    }
}

/// Fills a container of three elements with nine items, and takes all.
fn nine_into_three<T: Element>() -> (Vec<Taken>, u32, u32) {
    let mut ours = Counted::new(Deque::<T, 3>::new());
    (0..9).for_each(|number| ours.put(item(number)));
    let taken = std::iter::from_fn(|| ours.container().take()).collect();
    (taken, ours.lost(), ours.left_out())
}

#[test]
fn items_and_events_leave_out_what_they_cannot_hold() {
    let items = [0, 1, 2].map(|number| Taken::whole(item(number)));
    assert_eq!(nine_into_three::<Taken>(), (items.to_vec(), 6, 0));
    assert_eq!(nine_into_three::<Item>(), (items.to_vec(), 6, 0));
    let events = [0, 3, 6].map(|number| Taken::whole(Item::Event(event(number))));
    assert_eq!(nine_into_three::<Event>(), (events.to_vec(), 0, 6));
}

/// A thread for each end: each item is taken or told as lost, and in order.
#[test]
fn ends_in_two_threads() {
    const ITEMS: u32 = 100_000;
    fn pump(end: impl Container<Element = Taken>) -> u32 {
        let mut ours = Counted::new(end);
        (0..ITEMS).for_each(|number| ours.put(Item::Event(event(number))));
        ours.lost()
    }
    fn drain(mut end: impl Source, producer: &thread::ScopedJoinHandle<u32>) -> [u32; 3] {
        let (mut next, mut taken, mut reported) = (0, 0, 0);
        loop {
            let is_over = producer.is_finished();
            while let Some(Taken { lost, item }) = end.take() {
                next += lost;
                assert_eq!(item.tick().micros(), next);
                (next, taken, reported) = (next + 1, taken + 1, reported + lost);
            }
            if is_over {
                return [next, taken, reported];
            }
        }
    }
    let assert_whole = |[next, taken, reported]: [u32; 3], lost| {
        assert_eq!(taken + lost, ITEMS);
        assert_eq!(reported + (ITEMS - next), lost);
    };
    let mut queue = spsc::Queue::<Taken, 8>::new();
    let (producer, consumer) = queue.split();
    thread::scope(|scope| {
        let producer = scope.spawn(|| pump(producer));
        let seen = drain(consumer, &producer);
        assert_whole(seen, producer.join().unwrap());
    });
    let queue = shared::<8>();
    thread::scope(|scope| {
        let producer = scope.spawn(|| pump(&queue));
        let seen = drain(&queue, &producer);
        assert_whole(seen, producer.join().unwrap());
    });
}

/// From a bank by way of a deque to the bytes of a transfer, in a vector.
#[test]
fn batches_in_vectors() {
    let mut events = Counted::new(Deque::<Event, 8>::new());
    let scheme = TemporalContrast::<i16>::new(9);
    let mut bank = Bank::<_, 2>::new(&scheme);
    for (micros, sample) in [0, 50, 100, 150].into_iter().enumerate() {
        bank.encode_into(Tick::from_micros(micros as u64), [sample; 2], &mut events);
    }
    assert_eq!((events.lost(), events.container().len()), (0, 6));
    let mut batch = Formatted::new(Edvs::new(EdvsTime::None).encoder());
    let mut bytes = Short::<u8, 7>::new();
    bytes.push(0xAA).unwrap();
    assert_eq!(batch.fill_vec(events.container(), &mut bytes), 6);
    assert_eq!((bytes.len(), bytes[0]), (7, 0xAA));
    bytes.clear();
    assert_eq!(batch.fill_vec(events.container(), &mut bytes), 6);
    bytes.clear();
    assert_eq!(batch.fill_vec(events.container(), &mut bytes), 0);
    assert!(bytes.is_empty());
}
