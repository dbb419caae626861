//! Lost frames and lost events: every loss is counted, and decoding is exact again after the next
//! keyframe.

use fixed::types::I8F8;
use host_tests::flight;
use rand_core::Rng;
use rand_pcg::Pcg32;
use spikewire::link::{Coding, MAX_FRAME, Raw, Reader, Receiver, Snapshot, Transmitter};
use spikewire::sink::{EventQueue, Overflow};
use spikewire::temporal::{StepDecoder, StepForward};
use spikewire::{Bank, Decoder, Event, Mark, Sample, Scheme};

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
fn fly<S: Raw>(scheme: StepForward<S>, convert: fn(f32) -> S, per_cent: u32) -> Tally {
    let mut random = Pcg32::new(4, u64::from(per_cent));
    let mut bank = Bank::<_, 6>::new(scheme);
    let mut transmitter = Transmitter::<S, 6>::new(Coding::for_channels(6, 5_038));
    let mut reader = Reader::<MAX_FRAME>::new();
    let mut receiver = Receiver::<S, 6>::new(scheme);
    let mut lossless: [StepDecoder<S>; 6] = [scheme.decoder(); 6];
    let mut tally = Tally { sent: 0, received: 0, lost: 0, exact: 0, checked: 0 };
    let mut events: Vec<Event> = Vec::new();
    let (mut next_frame, mut next_keyframe) = (20_000, 1_000_000);
    let mut unseen = 0; // lost at the end: no later frame tells

    for sample in flight::hexarotor() {
        bank.encode(sample.time_us, sample.channels().map(convert), |event| {
            lossless[usize::from(event.address)].decode(event.polarity.into());
            events.push(event);
        });
        if sample.time_us >= next_keyframe {
            next_keyframe += 1_000_000;
            transmitter.keyframe(bank.snapshot(sample.time_us, Mark::default()));
            for (decoder, encoder) in lossless.iter_mut().zip(bank.channels()) {
                decoder.resync(spikewire::Encoder::keyframe(encoder).unwrap());
            }
        }
        if sample.time_us < next_frame {
            continue;
        }
        next_frame = sample.time_us + 20_000;
        let mut source = events.drain(..);
        let mut buffer = [0; 200];
        while let Some(mut frame) = transmitter.next_frame(&mut source, &mut buffer).unwrap() {
            tally.sent += 1;
            if random.next_u32() % 100 < per_cent {
                tally.lost += 1;
                unseen += 1;
                if random.next_u32().is_multiple_of(2) {
                    // It arrives damaged, anywhere but in its length.
                    let mut damaged = frame.to_vec();
                    let at = random.next_u32() as usize % damaged.len();
                    damaged[if at == 11 { 12 } else { at }] ^= 1 << (random.next_u32() % 8);
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
                    assert_eq!(value.to_raw(), decoder.value().to_raw());
                }
            }
        }
    }
    let first_lost = tally.lost - u32::from(unseen) - reader.lost_frames();
    assert!(first_lost <= 1, "only frames before the first that arrived are not counted");
    assert_eq!(tally.received + tally.lost, tally.sent);
    tally
}

#[test]
fn every_lost_frame_is_counted_and_decoding_recovers() {
    const FLOAT: StepForward<f32> = StepForward::<f32>::checked(0.1);
    const FIXED: StepForward<I8F8> = StepForward::<I8F8>::checked(I8F8::lit("0.125"));
    for (per_cent, least_exact) in [(0, 0.94), (1, 0.7), (10, 0.2)] {
        for (name, tally) in [
            ("f32", fly(FLOAT, |x| x, per_cent)),
            ("I8F8", fly(FIXED, |x| I8F8::from_f64(x.into()), per_cent)),
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

#[test]
fn events_lost_in_the_queue_make_the_receiver_stale_until_the_next_keyframe() {
    const ROLL: StepForward<i16> = StepForward::<i16>::checked(10);
    for overflow in [Overflow::DropOldest, Overflow::DropNewest] {
        let queue = EventQueue::<4>::new(overflow);
        let mut bank = Bank::<_, 1>::new(ROLL);
        let mut transmitter = Transmitter::<i16, 1>::new(Coding::for_channels(1, 1));
        let mut reader = Reader::<MAX_FRAME>::new();
        let mut receiver = Receiver::<i16, 1>::new(ROLL);
        let mut tick = 0;
        let mut encode = |bank: &mut Bank<_, 1>, samples: i16| {
            for _ in 0..samples {
                tick += 1;
                let sample = (tick as i16) * 11;
                bank.encode(tick, [sample], |event| queue.push(event).unwrap());
            }
            tick
        };
        let mut flush = |transmitter: &mut Transmitter<i16, 1>, receiver: &mut Receiver<i16, 1>| {
            let mut buffer = [0; 64];
            while let Some(mut bytes) = transmitter.next_frame(&queue, &mut buffer).unwrap() {
                while let Some(received) = reader.next_frame(&mut bytes) {
                    receiver.apply(&received, |_, _, _| ());
                }
            }
        };
        let base = |bank: &Bank<spikewire::temporal::StepForwardEncoder<i16>, 1>| {
            spikewire::Encoder::keyframe(&bank.channels()[0])
        };

        let now = encode(&mut bank, 3);
        transmitter.keyframe(bank.snapshot(now, queue.mark()));
        flush(&mut transmitter, &mut receiver);
        assert_eq!(receiver.exact(0), base(&bank));

        // A keyframe that may lie before a loss must not hide it.
        let now = encode(&mut bank, 2);
        transmitter.keyframe(bank.snapshot(now, queue.mark()));
        encode(&mut bank, 5);
        assert_eq!(queue.lost(), 3);
        flush(&mut transmitter, &mut receiver);
        assert_eq!((receiver.exact(0), transmitter.dropped_keyframes()), (None, 1));

        // One that was taken after it makes up for it.
        let now = encode(&mut bank, 2);
        transmitter.keyframe(bank.snapshot(now, queue.mark()));
        encode(&mut bank, 1);
        flush(&mut transmitter, &mut receiver);
        assert_eq!(receiver.exact(0), base(&bank));
    }
}

/// The interrupt went on while main was on its way with the keyframe.
#[test]
fn a_keyframe_that_comes_late_does_not_take_the_receiver_back() {
    const ROLL: StepForward<i16> = StepForward::<i16>::checked(10);
    let mut transmitter = Transmitter::<i16, 1>::new(Coding::for_channels(1, 1));
    let mut reader = Reader::<MAX_FRAME>::new();
    let mut receiver = Receiver::<i16, 1>::new(ROLL);
    let mut send = |transmitter: &mut Transmitter<i16, 1>, tick| {
        let event = Event { tick, address: 0, polarity: spikewire::Polarity::Up };
        let mut buffer = [0; 64];
        let mut bytes = transmitter.next_frame([event].into_iter(), &mut buffer).unwrap().unwrap();
        receiver.apply(&reader.next_frame(&mut bytes).unwrap(), |_, _, _| ());
        receiver.exact(0)
    };
    transmitter.keyframe(Snapshot { tick: 1, mark: Mark::default(), values: [Some(100)] });
    assert_eq!(send(&mut transmitter, 2), Some(110));
    transmitter.keyframe(Snapshot { tick: 1, mark: Mark::default(), values: [Some(100)] });
    assert_eq!((send(&mut transmitter, 3), transmitter.dropped_keyframes()), (Some(120), 1));
    transmitter.keyframe(Snapshot { tick: 3, mark: Mark::default(), values: [Some(121)] }); // as late as can be
    assert_eq!((send(&mut transmitter, 4), transmitter.dropped_keyframes()), (Some(131), 1));
}

/// As of a moving window whose first window is not full.
#[test]
fn a_snapshot_before_any_value_sends_nothing() {
    let mut transmitter = Transmitter::<i16, 2>::new(Coding::for_channels(2, 1));
    transmitter.keyframe(Snapshot { tick: 1, mark: Mark::default(), values: [None; 2] });
    assert_eq!(transmitter.next_frame(std::iter::empty(), &mut [0; 64]), Ok(None));
    assert_eq!(transmitter.dropped_keyframes(), 0);
}

#[test]
fn a_loss_is_told_although_no_event_follows() {
    let queue = EventQueue::<1>::new(Overflow::DropNewest);
    let event = Event { tick: 1, address: 0, polarity: spikewire::Polarity::Up };
    let mut transmitter = Transmitter::<i16, 1>::new(Coding::for_channels(1, 1));
    let mut buffer = [0; 64];
    queue.push(event).unwrap();
    assert!(transmitter.next_frame(&queue, &mut buffer).unwrap().is_some());
    queue.push(event).unwrap();
    queue.push(event).unwrap();
    queue.pop();
    let bytes = transmitter.next_frame(&queue, &mut buffer).unwrap().unwrap();
    assert!(spikewire::link::FrameView::new(bytes).unwrap().0.is_after_loss());
    assert_eq!(transmitter.next_frame(&queue, &mut buffer), Ok(None));
}
