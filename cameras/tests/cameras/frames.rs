//! Frames to events: pixels in their codes against the reference, by rows, by frames and interpolated.

use core::num::NonZeroU8;

use crate::cases;
use crate::reference::{
    FrameLaw, FrameOutcome, frame_events, frame_intensity, frame_interpolated, frame_log,
    frame_value, v2e_events,
};
use camera_frames::{FRAMES, Line, PERIOD, SIZE};
use proptest::collection::vec;
use proptest::prelude::*;
use spikewire::link::{Coding, MAX_FRAME, Reader, Session, Transmitter};
use spikewire::{ConfigError, Event, FromItems, Item, Keyframe, Polarity, Put, Tick};
use spikewire_cameras::frame::{
    DynamicFrameEncoder, FrameDecoder, FrameEncoder, FrameSize, Intensity, LogIntensity, PixelCode,
    PixelEvent, Refractory,
};

/// Odd, so that fours of pixels and what is left of a row are both there.
const W: usize = 11;
const H: usize = 3;

type Frame = [[u8; W]; H];

fn sign(polarity: Polarity) -> i64 {
    if polarity == Polarity::Up { 1 } else { -1 }
}

/// The events of a frame as a count for each pixel; they must come in raster order.
fn counts(events: &[PixelEvent]) -> Vec<i64> {
    let mut counts = vec![0; W * H];
    let place = |event: &PixelEvent| usize::from(event.y) * W + usize::from(event.x);
    assert!(events.is_sorted_by_key(place), "{events:?}");
    for event in events {
        counts[place(event)] += sign(event.polarity);
    }
    assert_eq!(
        counts.iter().map(|count| count.unsigned_abs() as usize).sum::<usize>(),
        events.len()
    );
    counts
}

fn bases<C: PixelCode>(encoder: &FrameEncoder<C, W, H>) -> Vec<i64> {
    let pixels = (0..H).flat_map(|y| (0..W).map(move |x| (x, y)));
    pixels.map(|(x, y)| i64::from(encoder.base(x, y).unwrap().into())).collect()
}

/// Rows, frames and slots, each against the reference, and the decoder after each event.
fn check<C: PixelCode>(code: C, law: &FrameLaw, frames: &[Frame]) {
    let flat: Vec<Vec<u8>> = frames.iter().map(|frame| frame.as_flattened().to_vec()).collect();
    let expected = frame_events(law, &flat);
    let new = || {
        let encoder = FrameEncoder::<C, W, H>::new(code);
        match law.budget {
            Some(budget) => encoder.try_with_budget(budget as u32).unwrap(),
            None => encoder,
        }
    };
    let (mut by_row, mut by_frame, mut by_slot) = (new(), new(), new());
    let mut of_any_size = DynamicFrameEncoder::try_new(code, W as u16, H as u16).unwrap();
    if let Some(budget) = law.budget {
        of_any_size = of_any_size.try_with_budget(budget as u32).unwrap();
    }
    let mut slots_of_any_size = of_any_size.clone();
    let mut decoder = FrameDecoder::<C, W, H>::new(code);
    decoder.start(&frames[0]);
    let mut kept_back = 0;
    let mut before = 0;
    for (index, (frame, outcome)) in (0_i64..).zip(frames.iter().zip(&expected)) {
        let now = 1000 * index + 7 * (index % 3);
        let tick = Tick::from_micros(now as u64);
        let mut rows = Vec::new();
        for (y, row) in frame.iter().enumerate() {
            by_row.encode_row(tick, y, row, |event| rows.push(event));
        }
        let mut whole = Vec::new();
        by_frame.encode_frame(tick, frame, |event| whole.push(event));
        let mut slots = Vec::new();
        by_slot.encode_interpolated(tick, frame, |event| slots.push(event));

        let (mut any_size, mut any_slots) = (Vec::new(), Vec::new());
        let flat = frame.as_flattened();
        of_any_size.encode_frame(tick, flat, |event| any_size.push(event)).unwrap();
        slots_of_any_size.encode_interpolated(tick, flat, |event| any_slots.push(event)).unwrap();

        assert_eq!((&any_size, &any_slots), (&rows, &slots));
        assert!(rows.iter().all(|event| event.tick == tick));
        assert_eq!(rows, whole);
        assert_eq!(counts(&rows), outcome.counts, "frame {index}");
        let timed = slots.iter().map(|event| {
            let pixel = usize::from(event.y) * W + usize::from(event.x);
            (i64::from(event.tick.micros()), pixel, sign(event.polarity))
        });
        let timed: Vec<_> = timed.collect();
        assert_eq!(timed, frame_interpolated(&outcome.counts, law.most, before, now));
        kept_back += outcome.kept_back;
        for encoder in [&by_row, &by_frame, &by_slot] {
            assert_eq!(bases(encoder), outcome.bases, "frame {index}");
            assert_eq!(i64::from(encoder.over_budget()), kept_back, "frame {index}");
        }
        for &event in &slots {
            decoder.decode(event);
        }
        let values: Vec<u8> = decoder.rows().collect::<Vec<_>>().concat();
        let wanted = outcome.bases.iter().map(|&base| frame_value(law, base));
        assert_eq!(values, wanted.collect::<Vec<_>>(), "frame {index}");
        assert!(of_any_size.picture().eq(values.iter().copied()));
        assert_eq!(i64::from(of_any_size.over_budget()), kept_back);
        before = now;
    }
    check_error(law, &flat, &expected);
}

/// While no sample changes by more than K thresholds, and nothing is silent or kept back, a base stays within a threshold.
fn check_error(law: &FrameLaw, frames: &[Vec<u8>], outcomes: &[FrameOutcome]) {
    if law.refractory > 0 || law.budget.is_some() {
        return;
    }
    let level = |sample: u8| law.bases[usize::from(sample)];
    // The first frame follows itself.
    let pairs = frames.iter().take(1).chain(frames).zip(frames);
    for pixel in 0..frames[0].len() {
        for ((before, now), outcome) in pairs.clone().zip(outcomes) {
            let now = level(now[pixel]);
            let change = now - level(before[pixel]);
            if change > law.most * law.on || -change > law.most * law.off {
                break;
            }
            let off = now - outcome.bases[pixel];
            assert!(off <= law.on && -off <= law.off, "{law:?}: {off}");
        }
    }
}

/// Frames at rest, drifting, flickering and jumping.
fn video() -> impl Strategy<Value = Vec<Frame>> {
    let pixel = prop_oneof![Just(0_u8), Just(255), any::<u8>()];
    let start = vec(pixel, W * H);
    let changes = vec(
        vec(
            prop_oneof![4 => Just(0_i16), 3 => -3_i16..=3, 2 => -25_i16..=25, 1 => -255_i16..=255],
            W * H,
        ),
        1..8,
    );
    (start, changes).prop_map(|(start, changes)| {
        let mut frames = vec![start];
        for change in changes {
            let last = frames.last().unwrap();
            let next = last
                .iter()
                .zip(change)
                .map(|(&sample, by)| (i16::from(sample) + by).clamp(0, 255) as u8);
            frames.push(next.collect());
        }
        let frame =
            |flat: Vec<u8>| std::array::from_fn(|y| std::array::from_fn(|x| flat[y * W + x]));
        frames.into_iter().map(frame).collect()
    })
}

fn budget() -> impl Strategy<Value = Option<i64>> {
    prop_oneof![Just(None), (1_i64..60).prop_map(Some)]
}

proptest! {
    #![proptest_config(cases(400))]

    #[test]
    fn intensities(
        frames in video(),
        threshold in prop_oneof![1_u8..=254, Just(1_u8), Just(10)],
        most in prop_oneof![Just(1_u8), 1_u8..9, Just(255)],
        refractory in 0_u8..4,
        budget in budget(),
    ) {
        let code = Intensity::try_new(threshold).unwrap().try_with_most(most).unwrap();
        let law = FrameLaw {
            refractory: refractory.into(),
            budget,
            ..frame_intensity(threshold.into(), most.into())
        };
        match refractory {
            0 => check(code, &law, &frames),
            _ => check(Refractory::try_new(code, refractory).unwrap(), &law, &frames),
        }
    }

    #[test]
    fn fine_levels(
        frames in video(),
        (on, off) in prop_oneof![(1_u16..=5673, 1_u16..=5673), (100_u16..400, 100_u16..400)],
        most in prop_oneof![Just(1_u8), 1_u8..9, Just(255)],
        refractory in 0_u8..3,
        budget in budget(),
    ) {
        let code = LogIntensity::try_new(on, off).unwrap().try_with_most(most).unwrap();
        let law = FrameLaw {
            refractory: refractory.into(),
            budget,
            ..frame_log(1024, on.into(), off.into(), most.into())
        };
        match refractory {
            0 => check(code, &law, &frames),
            _ => check(Refractory::try_new(code, refractory).unwrap(), &law, &frames),
        }
    }

    #[test]
    fn coarse_levels(
        frames in video(),
        (on, off) in prop_oneof![(1_u8..=254, 1_u8..=254), (5_u8..20, 5_u8..20)],
        most in prop_oneof![Just(1_u8), 1_u8..9],
    ) {
        let code = LogIntensity::try_new(on, off).unwrap().try_with_most(most).unwrap();
        check(code, &frame_log(46, on.into(), off.into(), most.into()), &frames);
    }
}

/// Every base, sample and threshold of 8 bits, in rows of which fours are looked at together.
#[test]
fn every_base_sample_and_threshold() {
    let row: [u8; 256] = std::array::from_fn(|sample| sample as u8);
    for threshold in 1..=254_u8 {
        for base in 0..=255_u8 {
            let most = [1, 2, 7, 255][usize::from(threshold ^ base) % 4];
            let code = Intensity::new(threshold).with_most(most);
            let mut encoder = FrameEncoder::<_, 256, 1>::new(code);
            encoder.encode_row(Tick::from(0), 0, &[base; 256], |_| unreachable!());
            let mut counts = [0_i32; 256];
            encoder.encode_row(Tick::from(1), 0, &row, |event| {
                counts[usize::from(event.x)] += sign(event.polarity) as i32;
            });
            for (sample, &count) in (0_i32..).zip(&counts) {
                let away = sample - i32::from(base);
                let due = ((away.abs() - 1).max(0) / i32::from(threshold)).min(most.into());
                assert_eq!(count, due * away.signum(), "{base} {sample} {threshold} {most}");
            }
        }
    }
}

/// Every base, sample and threshold of the levels in 8 bits.
#[test]
fn every_level_sample_and_threshold() {
    let levels = frame_log(46, 1, 1, 1).bases;
    for threshold in 1..=254_u8 {
        let code = LogIntensity::<u8>::new(threshold, 255 - threshold).with_most(3);
        for base in 0..=255_u8 {
            for sample in 0..=255_u8 {
                let away = levels[usize::from(sample)] - i64::from(base);
                let threshold = i64::from(if away > 0 { threshold } else { 255 - threshold });
                let due = ((away.abs() - 1).max(0) / threshold).min(3) * away.signum();
                assert_eq!(i64::from(code.steps(base, sample)), due, "{base} {sample} {threshold}");
            }
        }
    }
}

#[test]
fn tables_and_values_of_every_level() {
    let (fine, coarse) = (LogIntensity::<u16>::new(1, 1), LogIntensity::<u8>::new(1, 1));
    let (fine_law, coarse_law) = (frame_log(1024, 1, 1, 1), frame_log(46, 1, 1, 1));
    let samples = || 0..=255_u8;
    assert_eq!(samples().map(|v| u32::from(fine.base(v))).sum::<u32>(), 1_178_453);
    assert_eq!(samples().map(|v| u32::from(coarse.base(v))).sum::<u32>(), 52_936);
    for sample in samples() {
        assert_eq!(i64::from(fine.base(sample)), fine_law.bases[usize::from(sample)]);
        assert_eq!(i64::from(coarse.base(sample)), coarse_law.bases[usize::from(sample)]);
        assert_eq!(fine.value(fine.base(sample)), sample);
    }
    for base in 0..=5674_u16 {
        assert_eq!(fine.value(base), frame_value(&fine_law, base.into()));
    }
    for base in samples() {
        assert_eq!(coarse.value(base), frame_value(&coarse_law, base.into()));
    }
}

#[test]
fn thresholds_and_numbers_that_make_no_sense() {
    let said = |result: Result<(), ConfigError>| result.unwrap_err().to_string();
    let threshold = |value| said(Intensity::try_new(value).map(drop));
    assert_eq!(threshold(0), "threshold 0 must lie in 1..=254");
    assert_eq!(Intensity::new(7).threshold(), 7);
    assert_eq!(threshold(255), "threshold 255 must lie in 1..=254");
    let fine = |on, off| said(LogIntensity::<u16>::try_new(on, off).map(drop));
    assert_eq!(fine(0, 1), "ON threshold 0 must lie in 1..=5673");
    assert_eq!(fine(1, 5674), "OFF threshold 5674 must lie in 1..=5673");
    let coarse = |on, off| said(LogIntensity::<u8>::try_new(on, off).map(drop));
    assert_eq!(coarse(255, 1), "ON threshold 255 must lie in 1..=254");
    assert_eq!(coarse(1, 0), "OFF threshold 0 must lie in 1..=254");
    let code = Intensity::new(10);
    let most = "most events a pixel and frame 0 must lie in 1..=255";
    assert_eq!(said(code.try_with_most(0).map(drop)), most);
    assert_eq!(said(LogIntensity::<u8>::new(1, 1).try_with_most(0).map(drop)), most);
    let silence = Refractory::try_new(code, 0).map(drop);
    assert_eq!(said(silence), "refractory frames 0 must lie in 1..=255");
    let size = |width, height| said(DynamicFrameEncoder::try_new(code, width, height).map(drop));
    assert_eq!(size(0, 1), "width 0 must lie in 1..=65535");
    assert_eq!(size(1, 0), "height 0 must lie in 1..=65535");
    let mut other = DynamicFrameEncoder::try_new(code, 3, 2).unwrap();
    let refused = other.encode_frame(Tick::from(0), &[0; 5], |_| ());
    assert_eq!(refused, Err(FrameSize { pixels: 5, expected: 6 }));
    let camera = FrameEncoder::<_, W, H>::new(code);
    let budget = camera.clone().try_with_budget(0).map(drop);
    assert!(said(budget).starts_with("event budget a frame 0 must lie in 1..="));
    let address = camera.try_with_first_address(65_504).map(drop);
    assert_eq!(said(address), "first address 65504 must lie in 0..=65503");
}

#[test]
fn rows_that_are_lost_too_many_or_twice() {
    let mut camera = FrameEncoder::<_, 4, 3>::new(Intensity::new(10)).with_budget(2);
    let mut encode = |y, row: [u8; 4]| {
        let mut events = Vec::new();
        camera.encode_row(Tick::from(y as u32), y, &row, |event| events.push((event.y, event.x)));
        events
    };
    // Row 1 of the first frame is lost, and sets its bases in the second.
    assert!(encode(0, [0; 4]).is_empty() && encode(2, [0; 4]).is_empty());
    assert_eq!(encode(0, [0, 50, 0, 0]), [(0, 1)]);
    assert!(encode(1, [9; 4]).is_empty());
    assert_eq!(encode(2, [50, 50, 50, 0]), [(2, 0)]); // of three, for a budget of two a frame
    // A row that is not above the last begins a frame, with a new budget.
    assert_eq!(encode(2, [0, 50, 50, 0]), [(2, 1), (2, 2)]);
    assert!(encode(3, [0; 4]).is_empty());
    assert_eq!((camera.over_budget(), camera.outside()), (2, 1));
    assert_eq!((camera.base(0, 3), camera.base(4, 0), camera.base(1, 0)), (None, None, Some(10)));
    camera.reset();
    assert_eq!(camera.base(1, 0), None);
}

/// A camera may not be interpolated back in time: its events then have its own tick.
#[test]
fn time_that_stands_or_goes_back() {
    let mut camera = FrameEncoder::<_, 1, 1>::new(Intensity::new(10).with_most(3));
    let mut ticks = Vec::new();
    for (tick, sample) in [(100, 0), (100, 25), (40, 200), (70, 225), (u32::MAX, 225), (8, 190)] {
        camera.encode_interpolated(Tick::from(tick), &[[sample]], |event| {
            ticks.push(event.tick.micros());
        });
    }
    // The last, over the wrap of the ticks, in 9 µs from 2³²-1.
    assert_eq!(ticks[..5], [100, 100, 40, 40, 40]);
    assert!(ticks[5..].iter().rev().take(1).eq([&8]));
}

/// What puts items into a vector.
struct Items<'a>(&'a mut Vec<Item>);

impl Put for Items<'_> {
    fn put(&mut self, item: Item) {
        self.0.push(item);
    }
}

/// From pixels by queue and link to a picture: bit for bit the encoder's, keyframes where the decoder began late.
#[test]
fn through_a_link_to_a_picture() {
    const FIRST: u16 = 6;
    let code = LogIntensity::<u16>::new(150, 170).with_most(5);
    let mut camera = FrameEncoder::<_, 35, 35>::new(code).with_first_address(FIRST);
    let mut picture = FrameDecoder::<_, 35, 35>::new(code).with_first_address(FIRST);
    let mut link =
        Transmitter::new(Coding::for_channels(FIRST + 35 * 35, 10_000), Session::counted(1));
    let mut reader = Reader::<MAX_FRAME>::new();
    for index in 0..40_usize {
        let tick = Tick::from_micros(10_000 * index as u64);
        let frame: [[u8; 35]; 35] = std::array::from_fn(|y| {
            std::array::from_fn(|x| {
                (128.0 + 90.0 * ((x + index) as f64 / 5.0 + y as f64 / 9.0).sin()) as u8
            })
        });
        let mut items = Vec::new();
        for (y, row) in frame.iter().enumerate() {
            camera.encode_row_into(tick, y, row, Items(&mut items));
        }
        camera.keyframe_row_into(tick, index % 35, Items(&mut items));
        let mut source = FromItems(items.into_iter());
        let mut buffer = [0; MAX_FRAME];
        while let Some(mut bytes) = link.next_frame(&mut source, &mut buffer).unwrap() {
            while let Some(received) = reader.next_frame(&mut bytes) {
                received.frame.keyframes().for_each(|keyframe| picture.keyframe(keyframe));
                received.frame.events().for_each(|event| picture.event(event));
            }
        }
        // All rows have had a keyframe.
        if index >= 34 {
            for (y, x) in (0..35).flat_map(|y| (0..35).map(move |x| (y, x))) {
                assert_eq!(picture.base(x, y), camera.base(x, y), "{x} {y}");
            }
        }
    }
    assert_eq!((picture.outside(), reader.lost_frames()), (0, 0));
}

#[test]
fn what_is_of_no_pixel_is_counted() {
    let mut picture = FrameDecoder::<_, 4, 2>::new(Intensity::new(10)).with_first_address(3);
    let up = Polarity::Up;
    for address in [2, 3, 10, 11] {
        picture.event(Event { tick: Tick::from(0), address, polarity: up });
    }
    assert_eq!(picture.outside(), 2);
    assert_eq!(
        (picture.base(0, 0), picture.base(3, 1), picture.row(2)),
        (Some(10), Some(10), None)
    );
    picture.keyframe(Keyframe::new(Tick::from(0), 4, 77_i16));
    assert_eq!((picture.base(1, 0), picture.outside()), (Some(77), 2));
    for keyframe in [
        Keyframe::new(Tick::from(0), 4, 256_i16),
        Keyframe::new(Tick::from(0), 4, -1_i16),
        Keyframe::new(Tick::from(0), 4, 7.0_f32),
        Keyframe::new(Tick::from(0), 11, 7_i16),
        Keyframe::new(Tick::from(0), 2, 7_i16),
    ] {
        picture.keyframe(keyframe);
    }
    assert_eq!((picture.base(1, 0), picture.outside()), (Some(77), 7));
    assert_eq!(picture.row(0), Some([10, 77, 0, 0]));
}

/// A code of the user's own, without a quick way to find quiet pixels.
#[derive(Clone, Copy)]
struct Own(Intensity);

impl PixelCode for Own {
    type Base = u8;
    type Pixel = u8;
    const START: u8 = Intensity::START;

    fn most(&self) -> NonZeroU8 {
        self.0.most()
    }
    fn base(&self, sample: u8) -> u8 {
        self.0.base(sample)
    }
    fn begin(&self, sample: u8) -> u8 {
        self.0.begin(sample)
    }
    fn base_of(&self, pixel: u8) -> u8 {
        self.0.base_of(pixel)
    }
    fn steps(&self, pixel: u8, sample: u8) -> i16 {
        self.0.steps(pixel, sample)
    }
    fn follow(&self, pixel: &mut u8, steps: i16) {
        self.0.follow(pixel, steps);
    }
    fn moved(&self, base: u8, steps: i16) -> u8 {
        self.0.moved(base, steps)
    }
    fn value(&self, base: u8) -> u8 {
        self.0.value(base)
    }
}

#[test]
fn a_pixel_is_quiet_where_no_event_is_due() {
    let own = Own(Intensity::new(10));
    for sample in 0..=255 {
        assert_eq!(own.is_quiet(100, sample), (90..=110).contains(&sample), "{sample}");
    }
}

#[test]
fn pixels_and_addresses() {
    let event = PixelEvent { tick: Tick::from(9), x: 319, y: 204, polarity: Polarity::Down };
    assert_eq!(event.to_event(320, 0), None); // 65 599
    let address = event.to_event(320, 0).map(|event| event.address);
    assert_eq!(address, None);
    let last = PixelEvent { x: 255, ..event }.to_event(320, 0);
    assert_eq!(last.map(|event| event.address), Some(65_535));
    let event = PixelEvent { y: 203, ..event };
    let at = event.to_event(320, 100).unwrap();
    assert_eq!(at.address, 65_379);
    assert_eq!(PixelEvent::from_event(at, 320, 100), Some(event));
    assert_eq!(PixelEvent::from_event(at, 0, 0), None);
    assert_eq!(PixelEvent::from_event(Event { address: 99, ..at }, 320, 100), None);
}

/// Whole numbers stand in for v2e's logarithms: over a video both send the events of the same contrast, and no pixel is
/// ever more than two of them ahead of the other.
#[test]
fn v2e_sends_the_same_contrast() {
    let frames: Vec<Vec<u8>> = (0..100_usize)
        .map(|time| {
            let pixel = |place: usize| {
                let (x, y) = ((place % 64) as f64, (place / 64) as f64);
                let phase = (x + 0.7 * time as f64) / 6.0;
                let noise = (place * 7919 + time * 104_729) % 5;
                (110.0 + 100.0 * phase.sin() * (y / 17.0).cos()) as u8 + noise as u8
            };
            (0..64 * 48).map(pixel).collect()
        })
        .collect();
    let (on, off) = (205, 184);
    let theirs = v2e_events(&frames, on as f32 / 1024.0, off as f32 / 1024.0);
    let code = LogIntensity::<u16>::new(on as u16, off as u16).with_most(255);
    let mut camera = FrameEncoder::<_, 64, 48>::new(code);
    let mut ahead = vec![[0_i64; 2]; 64 * 48];
    let (mut same, mut other, mut fired) = (0_u64, 0_u64, 0_u64);
    for (time, (frame, theirs)) in frames.iter().zip(&theirs).enumerate() {
        let frame: [[u8; 64]; 48] =
            std::array::from_fn(|y| std::array::from_fn(|x| frame[y * 64 + x]));
        let mut ours = vec![0_i64; 64 * 48];
        camera.encode_frame(Tick::from(time as u32), &frame, |event| {
            ours[usize::from(event.y) * 64 + usize::from(event.x)] += sign(event.polarity);
        });
        for ((&ours, &theirs), ahead) in ours.iter().zip(theirs).zip(&mut ahead) {
            if ours != 0 || theirs != 0 {
                fired += ours.unsigned_abs();
                *(if ours == theirs { &mut same } else { &mut other }) += 1;
            }
            // ON and OFF have thresholds of their own, so that contrast is what is compared.
            ahead[0] += if ours > 0 { ours * on } else { ours * off };
            ahead[1] += if theirs > 0 { theirs * on } else { theirs * off };
            assert!((ahead[0] - ahead[1]).abs() <= on + off + 8, "{ahead:?}");
        }
    }
    let share = 100.0 * same as f64 / (same + other) as f64;
    println!("{fired} events; {share:.2} % of the pixels and frames with any have as many in v2e");
    assert!(fired > 10_000 && share > 97.0, "{fired} events, {share:.2} %");
}

/// What the firmware prints on every board is what the reference makes of its frames.
#[test]
fn the_firmware_prints_what_the_reference_makes() {
    let intensity = |threshold, most| frame_intensity(threshold, most);
    let table = [
        ("intensity-1", intensity(1, 1), false),
        ("intensity-10", intensity(10, 1), false),
        ("intensity-10x4", intensity(10, 4), false),
        ("intensity-10x4-slots", intensity(10, 4), true),
        ("intensity-10x4-budget", FrameLaw { budget: Some(300), ..intensity(10, 4) }, false),
        ("intensity-10x4-refractory", FrameLaw { refractory: 2, ..intensity(10, 4) }, true),
        ("log-u8-9", frame_log(46, 9, 9, 1), false),
        ("log-u16-205", frame_log(1024, 205, 205, 1), false),
        (
            "log-u16-205-184x6-slots",
            FrameLaw { budget: Some(2000), ..frame_log(1024, 205, 184, 6) },
            true,
        ),
    ];
    let frames: Vec<Vec<u8>> =
        (0..FRAMES).map(|index| camera_frames::frame(index).as_flattened().to_vec()).collect();
    let mut expected = String::new();
    for (name, law, is_interpolated) in table {
        let mut line = Line::default();
        for (index, outcome) in (0..).zip(frame_events(&law, &frames)) {
            let now = index * i64::from(PERIOD);
            let before = now - i64::from(PERIOD);
            let events = if is_interpolated {
                frame_interpolated(&outcome.counts, law.most, before, now)
            } else {
                let pixels = outcome.counts.iter().enumerate();
                let each = pixels.flat_map(|(pixel, &count)| {
                    (0..count.abs()).map(move |_| (now, pixel, count.signum()))
                });
                each.collect()
            };
            for (time, pixel, sign) in events {
                line.event(time as u32, (pixel % SIZE) as u16, (pixel / SIZE) as u16, sign > 0);
            }
            let values = outcome.bases.iter().map(|&base| frame_value(&law, base));
            line.bytes(&values.collect::<Vec<_>>());
            line.over_budget += outcome.kept_back as u32;
        }
        line.write(&mut expected, name).unwrap();
    }
    let mut printed = String::new();
    camera_frames::run(&mut printed).unwrap();
    assert_eq!(printed, expected);
}

/// A row beyond the height is counted, and leaves the frame's budget as it is.
#[test]
fn a_row_beyond_the_height_renews_no_budget() {
    let mut camera = FrameEncoder::<_, 4, 2>::new(Intensity::new(10)).with_budget(3);
    let mut sent = 0;
    for (tick, sample) in [(1, 0), (2, 100)] {
        sent = 0;
        for y in [0, 7, 1] {
            camera.encode_row(Tick::from(tick), y, &[sample; 4], |_| sent += 1);
        }
    }
    assert_eq!((sent, camera.outside()), (3, 2));
}

#[test]
fn a_camera_takes_addresses_of_its_own_at_run_time() {
    let code = Intensity::new(10);
    let mut camera = FrameEncoder::<_, 2, 1>::new(code).try_with_first_address(100).unwrap();
    let mut decoder = FrameDecoder::<_, 2, 1>::new(code).try_with_first_address(100).unwrap();
    let mut items = Vec::new();
    camera.encode_frame_into(Tick::from(1), &[[50, 50]], Items(&mut items));
    camera.encode_frame_into(Tick::from(2), &[[50, 61]], Items(&mut items));
    let [Item::Event(event)] = items[..] else { panic!("not one event, but {items:?}") };
    assert_eq!(event, Event { tick: Tick::from(2), address: 101, polarity: Polarity::Up });
    decoder.start(&[[50, 50]]);
    decoder.event(event);
    assert_eq!(decoder.base(1, 0), Some(60));
}
