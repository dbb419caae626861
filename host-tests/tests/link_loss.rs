//! Lost events: every loss is told at its place, and decoding is exact again after the next keyframe. Lost frames are
//! among the `faults`.

use spikewire::link::{Coding, FrameView, MAX_FRAME, Reader, Receiver, Session, Transmitter};
use spikewire::temporal::StepForward;
use spikewire::{Bank, Event, EventQueue, Item, Overflow, Polarity, Source, Taken, Tick};

/// One channel and both ends of its link.
struct Link<'a> {
    bank: Bank<&'static StepForward<i16>, 1>,
    queue: &'a EventQueue<4>,
    transmitter: Transmitter,
    reader: Reader<MAX_FRAME>,
    receiver: Receiver<&'static StepForward<i16>, 1, 0>,
    now: Tick,
}

static ROLL: StepForward<i16> = StepForward::new(10);

impl<'a> Link<'a> {
    fn new(queue: &'a EventQueue<4>) -> Self {
        Self {
            bank: Bank::new(&ROLL),
            queue,
            transmitter: Transmitter::new(Coding::for_channels(1, 1), Session::counted(1)),
            reader: Reader::new(),
            receiver: Receiver::new(&ROLL),
            now: Tick::from(0),
        }
    }

    /// Samples that spike each, but for the first.
    fn encode(&mut self, samples: u32) {
        for _ in 0..samples {
            self.now += 1;
            self.bank.encode_into(self.now, [self.now.micros() as i16 * 11], self.queue);
        }
    }

    fn keyframe(&mut self) {
        self.bank.keyframe_into(self.now, self.queue);
    }

    /// All that is in the queue, and what the receiver then calls exact.
    fn send(&mut self) -> Option<i16> {
        let mut consumer = self.queue.consumer().unwrap();
        let mut buffer = [0; 64];
        while let Some(mut bytes) = self.transmitter.next_frame(&mut consumer, &mut buffer).unwrap()
        {
            while let Some(received) = self.reader.next_frame(&mut bytes) {
                self.receiver.apply(&received, |_, _, _| ());
            }
        }
        self.receiver.exact(0)
    }
}

#[test]
fn events_lost_in_the_queue_make_the_receiver_stale_until_the_next_keyframe() {
    for overflow in [Overflow::DropOldest, Overflow::DropNewest, Overflow::Refuse] {
        let queue = EventQueue::new(overflow);
        let mut link = Link::new(&queue);
        link.encode(2);
        link.keyframe();
        assert!(link.send().is_some());
        assert_eq!(link.send(), link.bank.keyframe(0));

        // Before the loss it was exact; of what followed nothing is known.
        link.encode(1);
        link.keyframe();
        link.encode(6);
        assert_eq!(queue.lost(), 4);
        assert_eq!(link.send(), None, "{overflow:?}");

        link.encode(2);
        link.keyframe();
        link.encode(1);
        assert_eq!(link.send(), link.bank.keyframe(0));
    }
}

#[test]
fn a_reset_is_heard_at_its_place() {
    let queue = EventQueue::new(Overflow::DropOldest);
    let mut link = Link::new(&queue);
    link.encode(2);
    link.keyframe();
    link.bank.reset_into(link.now, &queue);
    assert_eq!(link.send(), None);
    link.encode(1);
    assert_eq!(link.send(), None, "the new baseline is not known");
    link.keyframe();
    assert_eq!(link.send(), link.bank.keyframe(0));
}

/// As of a moving window whose first window is not full.
#[test]
fn before_any_value_there_is_a_heartbeat_and_no_keyframe() {
    let queue = EventQueue::new(Overflow::DropOldest);
    let mut link = Link::new(&queue);
    link.keyframe();
    let taken = queue.consumer().unwrap().take();
    assert!(matches!(taken, Some(Taken { lost: 0, item: Item::Heartbeat { address: 0, .. } })));
    link.keyframe();
    assert_eq!(link.send(), None);
}

#[test]
fn a_loss_is_told_although_no_event_follows() {
    let queue = EventQueue::<1>::new(Overflow::DropNewest);
    let mut consumer = queue.consumer().unwrap();
    let item =
        |tick: u32| Item::Event(Event { tick: tick.into(), address: 0, polarity: Polarity::Up });
    let mut transmitter = Transmitter::new(Coding::for_channels(1, 1), Session::counted(1));
    let mut buffer = [0; 64];
    queue.push(item(1)).unwrap();
    queue.push(item(2)).unwrap();
    for (is_after_loss, events) in [(false, 1), (true, 0)] {
        let bytes = transmitter.next_frame(&mut consumer, &mut buffer).unwrap().unwrap();
        let (frame, _) = FrameView::new(bytes).unwrap();
        assert_eq!((frame.is_after_loss(), frame.events().count()), (is_after_loss, events));
    }
    assert_eq!(transmitter.next_frame(&mut consumer, &mut buffer), Ok(None));
}

/// What comes from the queue goes into frames in its order, whatever the ticks say.
#[test]
fn ticks_out_of_order_do_not_move_a_keyframe() {
    let queue = EventQueue::new(Overflow::DropOldest);
    let mut link = Link::new(&queue);
    for away in [0, 7, -7, 1_000, -1_000] {
        for _ in 0..50 {
            let other = Event { tick: link.now.shifted(away), address: 9, polarity: Polarity::Up };
            queue.push(other).unwrap();
            link.encode(1);
            link.keyframe();
            queue.push(other).unwrap();
            assert_eq!(link.send(), link.bank.keyframe(0), "{away}");
        }
    }
}
