//! Keyframes find their place among the events, whatever their ticks, and no loss is passed over: what
//! a receiver calls exact is what the encoder holds.

use spikewire::link::{Coding, MAX_FRAME, Reader, Receiver, Transmitter};
use spikewire::population::{ReceptiveFields, Slots};
use spikewire::sink::{EventQueue, Overflow};
use spikewire::temporal::{StepForward, StepForwardEncoder};
use spikewire::{Bank, Encoder, Event, EventSource, Mark, Polarity};

const ROLL: StepForward<i16> = StepForward::<i16>::checked(10);

/// An encoder of one channel and both ends of its link.
struct Link {
    bank: Bank<StepForwardEncoder<i16>, 1>,
    transmitter: Transmitter<i16, 1>,
    reader: Reader<MAX_FRAME>,
    receiver: Receiver<i16, 1>,
}

impl Link {
    fn new() -> Self {
        Self {
            bank: Bank::new(ROLL),
            transmitter: Transmitter::new(Coding::for_channels(1, 1_000)),
            reader: Reader::new(),
            receiver: Receiver::new(ROLL),
        }
    }

    /// A sample far from the one before, so that it spikes.
    fn sample(&mut self, tick: u32, queue: &EventQueue<8>) {
        self.bank.encode_into(tick, [(tick / 1_000) as i16 * 11], queue);
    }

    /// Hands over what the encoder holds now.
    fn keyframe(&mut self, tick: u32, queue: &EventQueue<8>) {
        self.transmitter.keyframe(self.bank.snapshot(tick, queue.mark()));
    }

    fn receive(&mut self, mut bytes: &[u8]) {
        while let Some(received) = self.reader.next_frame(&mut bytes) {
            self.receiver.apply(&received, |_, _, _| ());
        }
    }

    fn held(&self) -> Option<i16> {
        self.bank.channels()[0].keyframe()
    }
}

/// Sends frames until there is nothing to send.
macro_rules! send {
    ($link:expr, $events:expr) => {{
        let mut buffer = [0; MAX_FRAME];
        while let Some(bytes) = $link.transmitter.next_frame($events, &mut buffer).unwrap() {
            $link.receive(bytes);
        }
    }};
}

/// Events of other channels, pushed before this one's with later ticks, or behind it with earlier ones.
#[test]
fn ticks_out_of_order_do_not_move_a_keyframe() {
    for others in [[7, 0], [0, 7], [-7, 0], [0, -7], [7, -7]] {
        let queue = EventQueue::<8>::new(Overflow::DropOldest);
        let mut link = Link::new();
        for tick in (1_000..60_000_u32).step_by(1_000) {
            let push = |away: i32| {
                let event = Event {
                    tick: tick.wrapping_add_signed(away),
                    address: 9,
                    polarity: Polarity::Up,
                };
                if away != 0 {
                    queue.push(event).unwrap();
                }
            };
            push(others[0]);
            link.sample(tick, &queue);
            let snapshot = link.bank.snapshot(tick, queue.mark());
            push(others[1]);
            link.transmitter.keyframe(snapshot);
            if tick % 3_000 == 0 {
                link.sample(tick + 500, &queue);
            }
            send!(link, &queue);
            assert_eq!(link.receiver.exact(0), link.held(), "{others:?} at {tick}");
        }
        assert_eq!((queue.lost(), link.transmitter.dropped_keyframes()), (0, 0));
    }
}

/// A receptive field's spikes lie up to a whole sample ahead of the step code's of the same tick.
#[test]
fn sub_timesteps_share_a_link_with_a_step_code() {
    let fields = ReceptiveFields::<f32, 4, 10>::new(-1.0, 1.0, 1.5).unwrap();
    let queue = EventQueue::<8>::new(Overflow::DropOldest);
    let mut link = Link::new();
    let slots = Bank::<_, 1>::new(Slots::new(&fields)).with_slot_ticks(99);
    let mut slots = slots.with_first_address(1).unwrap();
    for tick in (1_000..100_000_u32).step_by(1_000) {
        slots.encode_into(tick, [(tick as f32).sin()], &queue);
        link.sample(tick, &queue);
        link.keyframe(tick, &queue);
        send!(link, &queue);
        assert_eq!(link.receiver.exact(0), link.held());
    }
    assert_eq!((queue.lost(), link.transmitter.dropped_keyframes()), (0, 0));
}

/// As many as were in when it was asked for, and none of the losses hidden.
#[test]
fn a_drain_tells_what_the_queue_lost() {
    let queue = EventQueue::<8>::new(Overflow::DropOldest);
    let mut link = Link::new();
    link.sample(1_000, &queue);
    link.keyframe(1_000, &queue);
    let mut drain = queue.drain();
    send!(link, &mut drain);
    assert_eq!(link.receiver.exact(0), link.held());

    (2..20).for_each(|i| link.sample(1_000 * i, &queue));
    let mut drain = queue.drain();
    send!(link, &mut drain);
    assert!(queue.lost() > 0);
    assert_eq!(link.receiver.exact(0), None);
}

#[test]
fn a_snapshot_from_before_a_loss_is_dropped_after_it_was_told() {
    let queue = EventQueue::<8>::new(Overflow::DropNewest);
    let mut link = Link::new();
    (1..=9).for_each(|i| link.sample(1_000 * i, &queue)); // the first sample is the baseline
    let snapshot = link.bank.snapshot(9_000, queue.mark());
    (10..20).for_each(|i| link.sample(1_000 * i, &queue));
    send!(link, &queue);
    link.transmitter.keyframe(snapshot);
    send!(link, &queue);
    assert_eq!((link.receiver.exact(0), link.transmitter.dropped_keyframes()), (None, 1));
}

#[test]
fn a_break_is_told() {
    let queue = EventQueue::<8>::new(Overflow::DropOldest);
    let mut link = Link::new();
    link.sample(1_000, &queue);
    link.keyframe(1_000, &queue);
    send!(link, &queue);
    assert!(link.receiver.exact(0).is_some());
    link.bank.reset();
    link.transmitter.mark_break();
    send!(link, &queue);
    assert_eq!(link.receiver.exact(0), None);
}

/// A queue that overflows between any two looks at it, as long as events come.
struct Overflowing {
    left: u32,
    lost: std::cell::Cell<u32>,
}

impl EventSource for &mut Overflowing {
    fn next_event(&mut self) -> Option<Event> {
        self.left = self.left.checked_sub(1)?;
        Some(Event { tick: 1_000, address: 0, polarity: Polarity::Up })
    }

    fn lost(&self) -> u32 {
        self.lost.replace(self.lost.get() + u32::from(self.left > 0))
    }
}

#[test]
fn losses_at_any_moment_are_no_reason_to_stop() {
    let mut link = Link::new();
    link.transmitter.keyframe(link.bank.snapshot(0, Mark::default()));
    let mut source = Overflowing { left: 20, lost: 0.into() };
    send!(link, &mut source);
    assert_eq!(source.left, 0);
    assert_eq!(link.receiver.estimate(0), 200);
}
