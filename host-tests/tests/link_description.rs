//! A sender and a receiver that have other schemes: no value is exact, for any code, from the first frame or from later on.

use crate::beside::{CHANNELS, Items, slot_ticks};
use catalogue::{Channel, Flight, Storable};
use fixed::types::I16F16;
use host_tests::flight;
use spikewire::filter::{Biquad, FirstOrder};
use spikewire::link::{
    Coding, FrameView, MAX_FRAME, Reader, Receiver, Session, Transmitter, Withheld,
};
use spikewire::population::Position;
use spikewire::temporal::{SendOnDelta, StepForward, TemporalContrast};
use spikewire::{
    Bank, ConfigError, Fingerprint, FromItems, Recovery, Sample, SampleKind, Scheme, Start, Tick,
};

const EVENTS: usize = 256;
const PERIOD: u32 = 2_500;
const SAMPLES: usize = 120;
const BEAT: usize = 8;
/// Equal channels in their order, and in the other one.
const LABELS: [&str; 2] = ["2500 us; gyro_x; gyro_y", "2500 us; gyro_y; gyro_x"];

/// What a sender with a description sent.
struct Sent {
    what: String,
    fingerprint: Fingerprint,
    frames: Vec<Vec<u8>>,
}

/// Sends samples, the first ones of a session, with a keyframe or a heartbeat every few.
fn frames<P: Scheme, const N: usize>(
    bank: &mut Bank<[&P; N], N>,
    mut link: Transmitter,
    samples: &[P::Sample],
) -> Vec<Vec<u8>> {
    let mut sent = Vec::new();
    for (number, near) in samples.windows(20).take(SAMPLES).enumerate() {
        let tick = Tick::from(5_000 + number as u32 * PERIOD);
        let mut items = Items::default();
        bank.encode_into(tick, std::array::from_fn(|channel| near[9 * channel]), &mut items);
        if number % BEAT == BEAT - 1 {
            bank.keyframe_into(tick, &mut items);
        }
        let (mut source, mut buffer) = (FromItems(items.0.into_iter()), [0; MAX_FRAME]);
        while let Some(frame) = link.next_frame(&mut source, &mut buffer).unwrap() {
            sent.push(frame.to_vec());
        }
    }
    sent
}

/// How many values a receiver called exact after each frame, and why it calls none so in the end.
fn heard<'a, P: Scheme, const N: usize>(
    mut receiver: Receiver<[&P; N], N, EVENTS>,
    frames: impl IntoIterator<Item = &'a Vec<u8>>,
) -> (usize, Option<Withheld>) {
    let (mut reader, mut exact) = (Reader::<MAX_FRAME>::new(), 0);
    for frame in frames {
        let mut bytes = &frame[..];
        while let Some(received) = reader.next_frame(&mut bytes) {
            receiver.apply(&received, |_, _, _| ());
            exact += (0..N as u16).filter(|&channel| receiver.exact(channel).is_some()).count();
        }
    }
    (exact, receiver.withheld(0))
}

/// Every code once as a sender; then as a receiver of all that was sent.
struct Pairs<'a, S> {
    samples: &'a [S],
    is_sending: bool,
    sent: &'a mut Vec<Sent>,
    mistaken: usize,
    own: usize,
}

impl<S: Sample> Flight for Pairs<'_, S> {
    type Sample = S;
    type Error = ConfigError;

    fn visit<P: Storable<Sample = S>>(
        &mut self,
        name: &'static str,
        _: &'static str,
        scheme: &P,
        start: P::EncoderState,
    ) -> Result<(), ConfigError> {
        let slot_ticks = slot_ticks(scheme, PERIOD);
        let start = postcard::to_allocvec(&start).unwrap();
        let states = [(); CHANNELS].map(|()| (scheme, postcard::from_bytes(&start).unwrap()));
        let mut bank = Bank::per_channel_with_states(states).with_slot_ticks(slot_ticks);
        if self.is_sending {
            let link = Transmitter::for_bank(&bank, PERIOD, Session::counted(7));
            let link = link.with_label(LABELS[0]);
            let fingerprint = bank.fingerprint().labelled(LABELS[0]);
            let frames = frames(&mut bank, link, self.samples);
            self.sent.push(Sent { what: format!("{name} {:?}", S::KIND), fingerprint, frames });
            return Ok(());
        }
        let labelled = |label| {
            Receiver::per_channel([scheme; CHANNELS])
                .with_slot_ticks(slot_ticks)
                .with_clock_tolerance(0)
                .with_label(label)
        };
        let receiver = || labelled(LABELS[0]);
        let own = receiver().fingerprint();
        assert_eq!(own, bank.fingerprint().labelled(LABELS[0]), "{name}");
        for (number, sent) in self.sent.iter().enumerate() {
            // From the first frame, or from one within the flight on.
            let frames = if sent.fingerprint == own { usize::MAX } else { 12 };
            let (exact, why) = heard(receiver(), sent.frames.iter().take(frames).skip(number % 3));
            if sent.fingerprint == own {
                let needs_more = match scheme.recovery() {
                    Recovery::Samples(samples) => samples > SAMPLES / 2,
                    recovery => matches!(recovery, Recovery::Fading(_)),
                };
                let is_exact = exact > 0 || needs_more;
                assert!(is_exact, "{name} and its own {}: {why:?}", sent.what);
                let (swapped, _) = heard(labelled(LABELS[1]), &sent.frames);
                assert_eq!(swapped, 0, "{name} and its own {}, swapped", sent.what);
                self.own += 1;
            } else {
                assert_eq!(exact, 0, "{name} {:?} and {}", S::KIND, sent.what);
                let other = Withheld::Description { own, sender: sent.fingerprint };
                assert_eq!(why, Some(other), "{name} and {}", sent.what);
                self.mistaken += 1;
            }
        }
        Ok(())
    }
}

fn visit<S: Sample>(sent: &mut Vec<Sent>, is_sending: bool, units: &[f64]) -> [usize; 2] {
    let mut counts = [0, 0];
    for &unit in units {
        let samples = flight::flown::<S>(0, unit);
        let channel = Channel::new(0, flight::calibrated(&samples));
        let (samples, mistaken, own) = (&samples[..200], 0, 0);
        let mut pairs = Pairs { samples, is_sending, sent, mistaken, own };
        catalogue::fly(&channel, &mut pairs).unwrap();
        counts = [counts[0] + pairs.mistaken, counts[1] + pairs.own];
    }
    counts
}

/// Every code, in three sample types, with the parameters of a signal and of a larger one.
#[test]
fn no_code_believes_another() {
    let (floats, counts) = ([1.0, 1.5], [1_000.0, 1_500.0]);
    let mut sent = Vec::new();
    visit::<f32>(&mut sent, true, &floats);
    visit::<i16>(&mut sent, true, &counts);
    visit::<I16F16>(&mut sent, true, &floats);
    let codes = sent.len();
    let by_type = [
        visit::<f32>(&mut sent, false, &floats),
        visit::<i16>(&mut sent, false, &counts),
        visit::<I16F16>(&mut sent, false, &floats),
    ];
    let [mistaken, own] = by_type.into_iter().fold([0, 0], |[a, b], [c, d]| [a + c, b + d]);
    println!("{mistaken} pairs of {codes} senders");
    assert_eq!(mistaken + own, codes * codes);
    // Some codes do not depend on how large the signal is.
    assert!(own >= codes && own < codes * codes / 20, "{own} of {codes}");
}

fn far<P: Scheme, const N: usize>(schemes: [&P; N]) -> Receiver<[&P; N], N, EVENTS> {
    Receiver::per_channel(schemes)
}

/// Sends by one bank, and hears by a receiver with other schemes: what it calls exact is 0.
fn never<P: Start<Sample = f32>, const N: usize, const M: usize>(
    what: &str,
    sender: [&P; N],
    receiver: Receiver<[&P; M], M, EVENTS>,
    label: Option<&str>,
) {
    let samples = flight::flown::<f32>(0, 1.0);
    let mut bank = Bank::per_channel(sender);
    let mut link = Transmitter::for_bank(&bank, PERIOD, Session::counted(7));
    if let Some(label) = label {
        link = link.with_label(label);
    }
    let frames = frames(&mut bank, link, &samples);
    let (exact, why) = heard(receiver, &frames);
    assert_eq!(exact, 0, "{what}");
    assert!(matches!(why, Some(Withheld::Description { .. })), "{what}: {why:?}");
}

/// Thirty and more of each kind of mistake in the description of two channels.
#[test]
fn no_mistake_in_a_description_goes_unnoticed() {
    let thresholds: Vec<f32> = (1..=8).map(|step| step as f32 * 0.02).collect();
    let schemes: Vec<_> = thresholds.iter().map(|&step| StepForward::new(step)).collect();
    let send: Vec<_> = thresholds.iter().map(|&step| SendOnDelta::<f32, 16>::new(step)).collect();
    let mut pairs = 0;
    for (at, one) in schemes.iter().enumerate() {
        for (other_at, other) in schemes.iter().enumerate().filter(|(place, _)| *place != at) {
            never("another threshold", [one; 2], far([other; 2]), None);
            never("one threshold", [one; 2], far([one, other]), None);
            never("swapped channels", [one, other], far([other, one]), None);
            never("fewer channels", [one; 3], far([one; 2]), None);
            let (a, b) = (&send[at], &send[other_at]);
            never("swapped channels", [a, b], far([b, a]), None);
            let label = format!("period {PERIOD}\ngyro.x rad/s {at}\ngyro.y rad/s {other_at}");
            let period = label.replace("2500", "1250");
            let order = format!("period {PERIOD}\ngyro.y rad/s {other_at}\ngyro.x rad/s {at}");
            for other in [&period, &order, &label.replace("rad", "deg")] {
                let labelled = far([one; 2]).with_label(other);
                never("another period, order or unit", [one; 2], labelled, Some(&label));
            }
            let first = far([one; 2]).with_first_address(2 + other_at as u16);
            never("another first address", [one; 2], first, None);
            let corner = |at: usize| Biquad::low_pass(20.0 + at as f32, 400.0).before(*one);
            never("another filter", [&corner(at); 2], far([&corner(other_at); 2]), None);
            pairs += 1;
        }
    }
    assert!(pairs >= 30);
}

/// Another number of channels, or a code or a filter of another type, is another description, too.
#[test]
fn descriptions_of_other_types_differ() {
    let step = StepForward::<f32>::new(0.1);
    let bank = |schemes: &[Fingerprint]| Fingerprint::of_bank(SampleKind::F32, 0, 0, schemes);
    let all = [
        bank(&[step.fingerprint()]),
        bank(&[step.fingerprint(); 2]),
        bank(&[step.fingerprint(); 3]),
        bank(&[SendOnDelta::<f32, 16>::new(0.1).fingerprint()]),
        bank(&[SendOnDelta::<f32, 15>::new(0.1).fingerprint()]),
        bank(&[TemporalContrast::<f32>::new(0.1).fingerprint()]),
        bank(&[FirstOrder::low_pass(40.0, 400.0).before(step).fingerprint()]),
        bank(&[Biquad::low_pass(40.0, 400.0).before(step).fingerprint()]),
        bank(&[Biquad::notch(40.0, 400.0, 2.0).before(step).fingerprint()]),
        // Of the same gain and damping, but of another tap.
        bank(&[Biquad::low_pass_with_q(40.0, 400.0, 2.0).before(step).fingerprint()]),
        Fingerprint::of_bank(SampleKind::F32, 0, 20, &[step.fingerprint()]),
        Fingerprint::of_bank(SampleKind::F32, 1, 0, &[step.fingerprint()]),
        Fingerprint::of_bank(SampleKind::Fixed32 { fraction: 0 }, 0, 0, &[step.fingerprint()]),
    ];
    for (at, one) in all.iter().enumerate() {
        assert!(all.iter().skip(at + 1).all(|other| one != other), "{at}");
    }
}

/// The bytes of the specification, written by hand, and their checksum by another program:
/// `python3 -c "import zlib; print(hex(zlib.crc32(bytes.fromhex('0b000000' + b'StepForward'.hex() + '78000000'))))"`.
#[test]
fn a_fingerprint_is_the_checksum_of_the_bytes_specified() {
    let scheme = StepForward::<i16>::new(120).fingerprint();
    assert_eq!(scheme, Fingerprint::from_bits(0xE48D_4501));
    let bank = Bank::<_, 2>::new(&StepForward::<i16>::new(120)).with_first_address(4).fingerprint();
    assert_eq!((bank.bits(), bank.to_string()), (0x2B78_1B18, "2b781b18".into()));
    assert_eq!(bank.labelled("x").bits(), 0xF654_92BC);
}

/// The fingerprint comes in the first frame and about every half second, with keyframes where there are some.
#[test]
fn the_fingerprint_comes_every_half_second() {
    static STEP: StepForward<f32> = StepForward::new(0.05);
    for (pause, beat) in [(2_500_u32, 20_u32), (2_500, 1), (50_000, 1), (600_000, 1), (100_000, 7)]
    {
        let mut bank = Bank::<_, 1>::new(&STEP);
        let mut link = Transmitter::for_bank(&bank, 2_500, Session::counted(7));
        let (mut full, mut silent) = (0, 0);
        let mut before = Tick::from(0);
        for number in 0..2_000 {
            let tick = Tick::from(number * pause);
            let mut items = Items::default();
            bank.encode_into(tick, [number as f32 * 0.1], &mut items);
            if number.is_multiple_of(beat) {
                bank.keyframe_into(tick, &mut items);
            }
            let (mut source, mut buffer) = (FromItems(items.0.into_iter()), [0; MAX_FRAME]);
            while let Some(frame) = link.next_frame(&mut source, &mut buffer).unwrap() {
                if let Ok((view, _)) = FrameView::new(frame) {
                    assert_eq!(view.fingerprint(), Some(bank.fingerprint()));
                    full += 1;
                    before = tick;
                }
                silent = silent.max(tick.since(before));
            }
        }
        let most = 1 << 19;
        assert!(silent < most + pause.cast_signed(), "{pause}: {silent} µs without a fingerprint");
        let seconds = u64::from(pause) * 2_000 / 1_000_000;
        assert!(full <= 4 * seconds.max(1) + 4, "{pause}: {full} full frames in {seconds} s");
    }
}

/// A wave in counts.
fn wave() -> Vec<i16> {
    (0..200).map(|at| ((f64::from(at) * 0.1).sin() * 100.0) as i16).collect()
}

/// A sender without a fingerprint is believed until a keyframe contradicts it, and after its next start.
#[test]
fn a_keyframe_that_contradicts_withholds_every_value() {
    static COARSE: StepForward<i16> = StepForward::new(4);
    static FINE: StepForward<i16> = StepForward::new(2);
    let samples = wave();
    let coding = Coding::for_channels(2, PERIOD);
    let send = |session| {
        let link = Transmitter::new(coding, Session::counted(session));
        frames(&mut Bank::per_channel([&COARSE; 2]), link, &samples)
    };
    let (first, second) = (send(1), send(2));
    let (exact, why) = heard(Receiver::per_channel([&COARSE; 2]), &first);
    assert!(exact > 100 && why.is_none(), "{exact} {why:?}");
    let (exact, why) = heard(Receiver::per_channel([&FINE; 2]), &first);
    assert_eq!(why, Some(Withheld::Contradicted));
    assert!(exact < 40, "until the second keyframe: {exact}");
    let (_, why) = heard(Receiver::per_channel([&FINE; 2]), first.iter().chain(&second[..1]));
    assert_eq!(why, Some(Withheld::Keyframe), "a start is believed anew");
}

/// While no full frame came, which has the fingerprint, nothing is read.
#[test]
fn a_sender_is_not_believed_before_its_fingerprint() {
    static POSITION: Position<i16, 9> = Position::linear(-100..=100);
    let samples = wave();
    let mut bank = Bank::per_channel([&POSITION; 2]);
    let link = Transmitter::for_bank(&bank, PERIOD, Session::counted(7));
    let frames = frames(&mut bank, link, &samples);
    let is_short = |frame: &&Vec<u8>| FrameView::new(frame).is_err();
    let short: Vec<_> = frames.iter().filter(is_short).cloned().collect();
    assert!(short.len() > 50);
    let receiver = || Receiver::per_channel([&POSITION; 2]);
    assert_eq!(heard(receiver(), &short), (0, Some(Withheld::Spike)));
    assert!(heard(receiver(), &frames).0 > 100);
    let fingerprint = receiver().with_fingerprint(Fingerprint::from_bits(9)).fingerprint();
    assert_eq!(fingerprint.bits(), 9);
}
