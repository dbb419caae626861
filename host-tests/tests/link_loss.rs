//! Lost frames and lost events: every loss is counted, and decoding is exact again after the next
//! keyframe.

use fixed::types::I8F8;
use host_tests::flight;
use rand_core::Rng;
use rand_pcg::Pcg32;
use spikewire::link::{Coding, FrameView, MAX_FRAME, Reader, Receiver, Session, Transmitter};
use spikewire::temporal::StepForward;
use spikewire::{
    Bank, Event, EventQueue, Item, Overflow, Polarity, Sample, Scheme, Source, Taken, Tick,
};

/// What arrives, and what should.
struct Tally {
    sent: u32,
    received: u32,
    lost: u32,
    exact: u32,
    checked: u32,
}

/// The flight log through a bank, frames of 20 ms, a keyframe a second; a frame is lost or
/// damaged with this chance. The receiver is compared, bit for bit, with decoders that lose nothing and are
/// resynchronised by the same keyframes.
fn fly<S: Sample>(scheme: &StepForward<S>, convert: fn(f32) -> S, per_cent: u32) -> Tally {
    let mut random = Pcg32::new(4, u64::from(per_cent));
    let mut bank = Bank::<_, 6>::new(scheme);
    let mut transmitter = Transmitter::new(Coding::for_channels(6, 5_038), Session::counted(1));
    let mut reader = Reader::<MAX_FRAME>::new();
    let mut receiver = Receiver::<_, 6, 0>::new(scheme);
    let queue = EventQueue::<1_024>::new(Overflow::Refuse);
    let mut consumer = queue.consumer().unwrap();
    let mut lossless = [scheme.decoder(); 6];
    let mut tally = Tally { sent: 0, received: 0, lost: 0, exact: 0, checked: 0 };
    let (mut next_frame, mut next_keyframe) = (20_000, 1_000_000);
    let mut unseen = 0; // lost at the end: no later frame tells

    for sample in flight::hexarotor() {
        let tick = Tick::from(sample.time_us);
        bank.encode(tick, sample.channels().map(convert), |event| {
            lossless[usize::from(event.address)].decode(event.polarity.into());
            queue.push(event).unwrap();
        });
        if sample.time_us >= next_keyframe {
            next_keyframe += 1_000_000;
            bank.keyframe_into(tick, &queue);
            for (channel, decoder) in lossless.iter_mut().enumerate() {
                decoder.resync(bank.keyframe(channel).unwrap());
            }
        }
        if sample.time_us < next_frame {
            continue;
        }
        next_frame = sample.time_us + 20_000;
        let mut buffer = [0; 200];
        while let Some(mut frame) = transmitter.next_frame(&mut consumer, &mut buffer).unwrap() {
            tally.sent += 1;
            if random.next_u32() % 100 < per_cent {
                tally.lost += 1;
                unseen += 1;
                if random.next_u32().is_multiple_of(2) {
                    // It arrives damaged, anywhere but in its length.
                    let mut damaged = frame.to_vec();
                    let at = random.next_u32() as usize % damaged.len();
                    damaged[if at == 17 { 18 } else { at }] ^= 1 << (random.next_u32() % 8);
                    assert!(reader.next_frame(&mut &damaged[..]).is_none());
                }
                continue;
            }
            while let Some(received) = reader.next_frame(&mut frame) {
                tally.received += 1;
                if tally.received > 1 {
                    assert_eq!(received.gap.map_or(0, |gap| gap.lost_frames), unseen);
                }
                unseen = 0;
                receiver.apply(&received, |_, _, _| ());
                if received.frame.keyframes().count() == 6 {
                    assert!((0..6).all(|channel| receiver.exact(channel).is_some()));
                }
            }
        }
        // What a frame told is known; one that is still missing is not, until the next arrives.
        if unseen == 0 {
            for (channel, decoder) in (0..).zip(&lossless) {
                tally.checked += 1;
                if let Some(value) = receiver.exact(channel) {
                    tally.exact += 1;
                    assert_eq!(Some(value.to_bits32()), decoder.held().map(Sample::to_bits32));
                }
            }
        }
    }
    let first_lost = tally.lost - unseen - reader.lost_frames();
    assert!(first_lost <= 1, "only frames before the first that arrived are not counted");
    assert_eq!(tally.received + tally.lost, tally.sent);
    tally
}

#[test]
fn every_lost_frame_is_counted_and_decoding_recovers() {
    const FLOAT: StepForward<f32> = StepForward::new(0.1);
    const FIXED: StepForward<I8F8> = StepForward::new(I8F8::lit("0.125"));
    for (per_cent, least_exact) in [(0, 0.94), (1, 0.7), (10, 0.2)] {
        for (name, tally) in [
            ("f32", fly(&FLOAT, |x| x, per_cent)),
            ("I8F8", fly(&FIXED, |x| I8F8::from_f64(x.into()), per_cent)),
        ] {
            let exact = f64::from(tally.exact) / f64::from(tally.checked);
            println!(
                "{name} {per_cent:2} % loss: {} frames sent, {} lost, exact {:.1} % of the time",
                tally.sent,
                tally.lost,
                100.0 * exact
            );
            assert_eq!(per_cent > 0, tally.lost > 0);
            assert!(exact > least_exact);
        }
    }
}

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
