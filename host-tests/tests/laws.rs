//! Laws that users rely on, each where its scheme's documentation states it. Some have stood in other files for long:
//!
//! | law | test |
//! |---|---|
//! | SF and send-on-delta stay within the threshold of a slow signal, adaptive SF within two | here |
//! | adaptive SF never overshoots | here |
//! | to adaptive SF a sample that is not finite is a silent one, and counted | here |
//! | strict HSA never exceeds the signal | here, in reals of eighths |
//! | step codes are silent on a constant that the past does not hide | here |
//! | population codes decode to within half a cell | here; `rank_order`, timing codes in their files |
//! | slots decode to within the mean distance of their levels | here; fields of any width in `nonlinear` |
//! | where a recording is cut never matters | here, for every scheme; `compare::run` in every comparison |
//! | a state that is written and read changes nothing | `states`, for every scheme |
//! | after a keyframe a decoder holds the encoder's base | here; with losses `link_outage` and `faults` |
//! | scaling by powers of two scales, and changes no spike | here |
//! | a larger threshold gives no more spikes: TBR and MW, not SF | here |
//! | step codes go on from the last value of a past | here; the moving window's in `moving_window` |

use crate::common::{cases, in_every_type};
use catalogue::{Channel, Flight, State, Storable};
use fixed::types::I16F16;
use host_tests::compare::{Wire, decode, encode};
use host_tests::flight;
use proptest::collection::vec;
use proptest::prelude::*;
use spikewire::population::{Position, Slots};
use spikewire::rate::{Hough, Taps};
use spikewire::temporal::{
    AdaptiveContrast, AdaptiveStepForward, MovingWindow, SendOnDelta, StepForward, TemporalContrast,
};
use spikewire::{
    Code, ConfigError, NeuronSpike, Output, Polarity, Recovery, Sample, Scheme, Spike, Start,
};

/// What a decoder beside the encoder holds after each sample, from the first sample on.
fn followed<P: Start>(scheme: &P, x: &[P::Sample]) -> Vec<P::Sample> {
    let (mut encoder, mut decoder) = (scheme.encoder(), scheme.decoder());
    let Some(&first) = x.first() else {
        return Vec::new();
    };
    decoder.resync(first);
    let codes = x.iter().map(|&x| encoder.encode(x).code().unwrap());
    codes.map(|code| decoder.decode(code)).collect()
}

/// A walk whose steps are at most this many eighths, which every real type here holds exactly.
fn walk(step: i16) -> impl Strategy<Value = Vec<i16>> {
    vec(-step..=step, 1..200).prop_map(|moves| {
        let mut at = 0;
        moves
            .into_iter()
            .map(|step| {
                at += step;
                at
            })
            .collect()
    })
}

fn eighths(x: &[i16]) -> Vec<f32> {
    x.iter().map(|&x| f32::from(x) / 8.0).collect()
}

#[test]
fn a_slow_signal_is_followed() {
    fn within<P: Start<Sample = f32>>(scheme: &P, x: &[f32], most: f32) {
        for (x, value) in x.iter().zip(followed(scheme, x)) {
            assert!((x - value).abs() <= most, "{value} for {x}");
        }
    }
    proptest!(cases(256), |(moves in walk(20), threshold in 20..40_i16)| {
        let (x, threshold) = (eighths(&moves), f32::from(threshold) / 8.0);
        within(&StepForward::new(threshold), &x, threshold);
        within(&AdaptiveStepForward::new(threshold, 5), &x, 2.0 * threshold);
        let quarter = threshold / 4.0;
        within(&SendOnDelta::<_, 4>::new(quarter), &x, quarter);
    });
}

/// The step shrinks with a sample that is not finite, as it does in the decoder, which sees no spike; and every form of
/// encoding counts the sample.
#[test]
fn samples_that_are_not_finite_are_silent_to_adaptive_steps() {
    let scheme = AdaptiveStepForward::new(1.0_f32, 4);
    let x = [0.0, 99.0, 99.0, f32::NAN, 99.0, 99.0, 99.0, 6.0, 6.0, 6.0];
    let values = followed(&scheme, &x);
    assert_eq!(values, [0.0, 1.0, 2.0, 2.0, 3.0, 4.0, 6.0, 6.0, 6.0, 6.0]);
    assert_eq!(encode(&scheme, &x).rejected, 1);

    proptest!(cases(256), |(moves in walk(20), gaps in vec(0..200_usize, 0..20), run in 1..=8_u8)| {
        let scheme = AdaptiveStepForward::new(0.5, 4).with_run(run);
        let mut x = eighths(&moves);
        let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
        for (gap, &bad) in gaps.into_iter().zip(bad.iter().cycle()) {
            if let Some(x) = x.get_mut(1 + gap) {
                *x = bad;
            }
        }
        let rejected = x.iter().filter(|x| !x.is_finite()).count();
        assert_eq!(encode(&scheme, &x).rejected as usize, rejected);

        // With silence until the step is the smallest, the encoder's baseline is what the decoder holds.
        let held = *followed(&scheme, &x).last().unwrap();
        let mut encoder = scheme.encoder();
        x.extend([held; 5]);
        for x in x {
            encoder.encode(x);
        }
        assert_eq!(encoder.keyframe(), Some(held));
    });
}

/// The baseline moves towards a sample, and not past it.
#[test]
fn step_codes_never_overshoot() {
    fn check<P: Start<Sample = i16>>(scheme: &P, x: &[i16]) {
        let values = followed(scheme, x);
        for (pair, &x) in values.windows(2).zip(&x[1..]) {
            let (before, after) = (pair[0], pair[1]);
            assert!((before.min(x)..=before.max(x)).contains(&after), "{before} {after} {x}");
        }
    }
    proptest!(cases(256), |(x in vec(-2_000..2_000_i16, 2..200), threshold in 1..300_i16)| {
        check(&StepForward::new(threshold), &x);
        check(&SendOnDelta::<_, 5>::new(threshold), &x);
        check(&AdaptiveStepForward::new(threshold, 6), &x);
        check(&AdaptiveStepForward::new(threshold, 3).with_run(4), &x);
    });
}

#[test]
fn hough_never_exceeds_the_signal() {
    proptest!(cases(256), |(x in vec(0..400_i16, 0..100), taps in prop::array::uniform5(0..60_i16))| {
        prop_assume!(taps.iter().any(|&tap| tap > 0));
        let taps = taps.map(|tap| f32::from(tap) / 8.0);
        let (scheme, x) = (Hough::new(Taps::try_new(taps).unwrap()), eighths(&x));
        let values = decode(&scheme.decoder(), &encode(&scheme, &x).codes());
        prop_assert!(values.iter().zip(&x).all(|(value, x)| value <= x));
    });
}

/// Of a past only the last value counts; an empty one changes nothing, and one whose last value is not finite is counted.
#[test]
fn step_codes_go_on_from_the_last_value_of_a_past() {
    fn check<P: Start<Sample = f32>>(scheme: &P) {
        let mut encoder = scheme.encoder();
        for (past, rejected, keyframe) in [
            (&[][..], 0, None),
            (&[9.0, f32::NAN], 1, None),
            (&[f32::NAN, 9.0, 2.0], 1, Some(2.0)),
            (&[], 1, Some(2.0)),
            (&[f32::NEG_INFINITY], 2, Some(2.0)),
        ] {
            encoder.prime(past);
            assert_eq!((encoder.rejected(), encoder.keyframe()), (rejected, keyframe), "{past:?}");
        }
        let code = encoder.encode(3.5).code().unwrap();
        assert!(code.firings().map(|firing| firing.polarity).eq([Polarity::Up]));
    }
    check(&TemporalContrast::new(1.0));
    check(&AdaptiveContrast::new(1.0, 4));
    check(&StepForward::new(1.0));
    check(&AdaptiveStepForward::new(1.0, 4));
    check(&SendOnDelta::<_, 4>::new(1.0));
}

/// From the start, and after any past as soon as the past is forgotten: at once, in a window's length, or where the
/// baseline has come near.
#[test]
fn step_codes_are_silent_on_a_constant() {
    fn check<S: Wire>() {
        fn spikes<P: Start<Code: PartialEq>>(scheme: &P, x: &[P::Sample], from: usize) -> usize {
            let mut encoder = scheme.encoder();
            let codes: Vec<_> = x.iter().map(|&x| encoder.encode(x).code().unwrap()).collect();
            codes[from..].iter().filter(|code| code.firings().next().is_some()).count()
        }
        let values = [S::from_f64(-0.9), S::default(), S::from_f64(0.3), S::from_bits32(0x7D)];
        // Of a window in floats rounding leaves something in the sum.
        let least = if S::KIND == f32::KIND { S::from_f64(1e-5) } else { S::from_bits32(1) };
        for constant in values {
            for before in values {
                let x: Vec<_> = std::iter::repeat_n(before, 9).chain([constant; 60]).collect();
                assert_eq!(spikes(&TemporalContrast::new(least), &x, 10), 0);
                assert_eq!(spikes(&MovingWindow::<_, 7>::new(least), &x, 9 + 7), 0);
                assert_eq!(spikes(&AdaptiveContrast::new(least, 2), &x, 10), 0);
                for from_start in [&x[9..], &x[..9]] {
                    assert_eq!(spikes(&StepForward::new(least), from_start, 0), 0);
                    assert_eq!(spikes(&SendOnDelta::<_, 3>::new(least), from_start, 0), 0);
                    assert_eq!(spikes(&AdaptiveStepForward::new(least, 2), from_start, 0), 0);
                    assert_eq!(spikes(&MovingWindow::<_, 7>::new(least), from_start, 0), 0);
                }
            }
        }
    }
    in_every_type!(check);
}

#[test]
fn population_codes_decode_to_within_half_a_cell() {
    let numbers = (-30_000..30_000_i16, 20..2_000_i16, vec(0.0..=1.0_f64, 50));
    proptest!(cases(256), |((min, width, parts) in numbers)| {
        let max = min.saturating_add(width);
        let scheme = Position::<i16, 9>::try_linear(min..=max).unwrap();
        let cell = f64::from(max - min) / 7.0;
        for part in parts {
            let x = min + (f64::from(max - min) * part) as i16;
            let value = scheme.decoder().decode(scheme.encoder().encode(x));
            // Half a unit more, by which a centre is rounded.
            prop_assert!((f64::from(x) - f64::from(value)).abs() <= cell / 2.0 + 0.5);
        }
    });
}

/// Each neuron that fires says that its centre is no farther than its level reaches.
#[test]
fn slots_decode_to_within_the_distances_of_their_levels() {
    let numbers = (-50.0..50.0_f32, 0.1..50.0_f32, 0.5..4.0_f32, vec(-0.3..1.3_f32, 30));
    proptest!(cases(128), |((min, width, beta, parts) in numbers)| {
        let range = min..=min + width;
        let scheme = Slots::<f32, 8, 50>::try_new(range.clone(), beta).unwrap();
        let spacing = f64::from(range.end() - range.start()) / 6.0;
        let sigma = spacing / f64::from(beta);
        for part in parts {
            let x = min + part * width;
            let spikes = scheme.encoder().encode(x);
            let reach = |level: f64| sigma * (2.0 * (50.0 / (level - 0.5)).ln()).sqrt();
            let levels = || spikes.iter().map(|(_, slot)| 50.0 - f64::from(slot));
            let total: f64 = levels().sum();
            if total > 0.0 {
                let most = levels().map(|level| level * reach(level)).sum::<f64>() / total;
                let value = scheme.decoder().decode(spikes);
                let off = (f64::from(value) - f64::from(x)).abs();
                prop_assert!(off <= most + 1e-5 * f64::from(width + min.abs()), "{off} {most}");
            }
        }
    });
}

/// Powers of two scale a float without rounding: the same spikes, and values scaled.
#[test]
fn scaling_by_powers_of_two_scales() {
    fn check<P, Q>(one: &P, other: &Q, x: &[f32], scale: f32)
    where
        P: Start<Sample = f32>,
        Q: Start<Sample = f32, Code = P::Code>,
    {
        let (mut encoder, mut scaled) = (one.encoder(), other.encoder());
        let (mut decoder, mut decoder_scaled) = (one.decoder(), other.decoder());
        for &x in x {
            let (code, twin) = (encoder.encode(x).code(), scaled.encode(scale * x).code());
            let firings = |code: P::Code| code.firings().collect::<Vec<_>>();
            assert_eq!(code.map(firings), twin.map(firings), "{x} times {scale}");
            if let (Some(code), Some(twin)) = (code, twin) {
                let value = (scale * decoder.decode(code)).to_bits();
                assert_eq!(value, decoder_scaled.decode(twin).to_bits());
            }
        }
    }
    let numbers = (vec(-4.0..4.0_f32, 1..60), 0.01..2.0_f32, -30..30_i32);
    proptest!(cases(128), |((x, step, power) in numbers)| {
        let scale = 2.0_f32.powi(power);
        let by = scale * step;
        check(&TemporalContrast::new(step), &TemporalContrast::new(by), &x, scale);
        check(&AdaptiveContrast::new(step, 3), &AdaptiveContrast::new(by, 3), &x, scale);
        check(&StepForward::new(step), &StepForward::new(by), &x, scale);
        check(&AdaptiveStepForward::new(step, 3), &AdaptiveStepForward::new(by, 3), &x, scale);
        check(&SendOnDelta::<_, 4>::new(step), &SendOnDelta::<_, 4>::new(by), &x, scale);
        check(&MovingWindow::<_, 5>::new(step), &MovingWindow::<_, 5>::new(by), &x, scale);
        let taps = [0.25, 1.0, 0.5].map(|tap| tap * step);
        let [one, other] = [taps, taps.map(|tap| tap * scale)].map(|taps| Taps::try_new(taps).unwrap());
        check(&Hough::new(one), &Hough::new(other), &x, scale);
        let range = |scale: f32| -2.0 * step * scale..=3.0 * step * scale;
        let [one, other] = [1.0, scale].map(|scale| Position::<f32, 7>::try_linear(range(scale)).unwrap());
        check(&one, &other, &x, scale);
    });
}

/// TBR and MW compare a sample with other samples alone. SF compares it with what its own spikes have made of the past: a
/// larger step may lead the baseline to where the signal leaves the band more often.
#[test]
fn a_larger_threshold_gives_no_more_spikes_where_none_changes_what_is_compared() {
    fn count<P: Start<Sample = i16, Code = Spike>>(scheme: &P, x: &[i16]) -> usize {
        let mut encoder = scheme.encoder();
        x.iter().filter(|&&x| encoder.encode(x).code().is_some_and(Spike::is_fired)).count()
    }
    let numbers = (vec(-500..500_i16, 1..80), 1..300_i16, 1..300_i16);
    proptest!(cases(256), |((x, threshold, more) in numbers)| {
        let [low, high] = [threshold, threshold + more].map(TemporalContrast::new);
        prop_assert!(count(&low, &x) >= count(&high, &x));
        let [low, high] = [threshold, threshold + more].map(MovingWindow::<_, 4>::new);
        prop_assert!(count(&low, &x) >= count(&high, &x));
    });
    let x = [0, 3, 5, 1];
    let [low, high] = [1, 2].map(|threshold| count(&StepForward::new(threshold), &x));
    assert_eq!((low, high), (2, 3), "of step forward, with a threshold of 1 and of 2");
}

/// Takes every scheme through pieces and keyframes.
struct Laws<S> {
    samples: Vec<S>,
    lengths: Vec<usize>,
    schemes: usize,
}

/// The firings and values of a recording that is cut into pieces of these lengths, over and over; a piece of one sample
/// is no slice.
fn in_pieces<P: Scheme<EncoderState: State>>(
    scheme: &P,
    start: &[u8],
    samples: &[P::Sample],
    lengths: &[usize],
) -> (Vec<Option<Vec<NeuronSpike>>>, Vec<u32>) {
    let again = || postcard::from_bytes::<P::EncoderState>(start).unwrap();
    let filler = scheme.encode(&mut again(), samples[0]);
    let (mut state, mut decoder) = (again(), scheme.decoder_state());
    let (mut firings, mut values) = (Vec::new(), Vec::new());
    let (mut rest, mut lengths) = (samples, lengths.iter().cycle());
    while !rest.is_empty() {
        let (piece, after) = rest.split_at(rest.len().min(*lengths.next().unwrap()));
        rest = after;
        let mut outputs = vec![filler; piece.len()];
        match piece {
            [sample] => outputs[0] = scheme.encode(&mut state, *sample),
            _ => _ = scheme.encode_slice(&mut state, piece, &mut outputs),
        }
        let codes: Vec<_> = outputs.into_iter().filter_map(Output::code).collect();
        let silent = piece.len() - codes.len();
        firings.extend(std::iter::repeat_n(None, silent));
        firings.extend(codes.iter().map(|code| Some(code.firings().collect())));
        let mut pieces = vec![P::Sample::default(); codes.len()];
        match codes[..] {
            [code] => pieces[0] = scheme.decode(&mut decoder, code),
            _ => _ = scheme.decode_slice(&mut decoder, &codes, &mut pieces),
        }
        values.extend(pieces.into_iter().map(Sample::to_bits32));
    }
    (firings, values)
}

/// Of two decoders, one that got no code before a keyframe and one that got all: after it they are the same.
fn after_keyframes<P: Scheme<EncoderState: State>>(
    scheme: &P,
    start: &[u8],
    samples: &[P::Sample],
) -> usize {
    let mut state: P::EncoderState = postcard::from_bytes(start).unwrap();
    let (mut whole, mut late) = (scheme.decoder_state(), None);
    let mut keyframes = 0;
    for (number, &sample) in samples.iter().enumerate() {
        let Some(code) = scheme.encode(&mut state, sample).code() else {
            continue;
        };
        let value = scheme.decode(&mut whole, code).to_bits32();
        if let Some(late) = &mut late {
            assert_eq!(scheme.decode(late, code).to_bits32(), value);
        }
        if number % 40 == 39
            && let Some(base) = scheme.keyframe(&state)
        {
            let mut fresh = scheme.decoder_state();
            for decoder in [&mut fresh, &mut whole] {
                scheme.resync(decoder, base);
                assert_eq!(scheme.held(decoder).map(Sample::to_bits32), Some(base.to_bits32()));
            }
            late = Some(fresh);
            keyframes += 1;
        }
    }
    keyframes
}

impl<S: Sample> Flight for Laws<S> {
    type Sample = S;
    type Error = ConfigError;

    fn visit<P: Storable<Sample = S>>(
        &mut self,
        name: &'static str,
        _: &'static str,
        scheme: &P,
        start: P::EncoderState,
    ) -> Result<(), ConfigError> {
        let start = postcard::to_allocvec(&start).unwrap();
        let whole = in_pieces(scheme, &start, &self.samples, &[1]);
        let pieces = in_pieces(scheme, &start, &self.samples, &self.lengths);
        assert!(whole == pieces, "{name} in pieces of {:?}", self.lengths);
        let keyframes = after_keyframes(scheme, &start, &self.samples);
        let has_keyframes = matches!(P::RECOVERY, Recovery::Keyframe | Recovery::TimedKeyframe(_));
        assert_eq!(keyframes > 0, has_keyframes, "{name}");
        self.schemes += 1;
        Ok(())
    }
}

#[test]
fn cuts_never_matter_and_keyframes_mend_in_every_scheme() {
    fn check<S: Sample>(unit: f64, lengths: Vec<usize>) {
        let samples: Vec<S> = flight::flown(1, unit).into_iter().step_by(3).collect();
        let channel = Channel::new(1, flight::calibrated(&samples));
        let mut visitor = Laws { samples, lengths, schemes: 0 };
        catalogue::fly(&channel, &mut visitor).unwrap();
        assert!(visitor.schemes >= catalogue::INFO.len());
    }
    proptest!(cases(2), |(lengths in vec(1..70_usize, 1..9))| {
        check::<f32>(1.0, lengths.clone());
        check::<i16>(1000.0, lengths.clone());
        check::<I16F16>(1.0, lengths);
    });
}
