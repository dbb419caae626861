//! Adaptive step forward: values by hand, its bounds, and keyframes.

use crate::common::refused;
use std::collections::HashSet;

use proptest::prelude::*;
use spikewire::temporal::{AdaptiveStepForward, StepForward};
use spikewire::{Encoder, Scheme, Spike, Start};

type Asf = AdaptiveStepForward<i16>;

#[test]
fn check_values() {
    let scheme = Asf::new(1, 4);
    let (mut encoder, mut decoder) = (scheme.encoder(), scheme.decoder());
    let mut signal = [40; 15];
    signal[0] = 0;
    let values = signal.map(|x| decoder.decode(encoder.encode(x)));
    assert_eq!(values, [0, 1, 2, 4, 8, 16, 32, 32, 32, 36, 38, 38, 38, 39, 39]);
}

#[test]
fn what_makes_no_sense_is_refused_by_name() {
    assert_eq!(refused(Asf::try_new(0, 4)), "threshold");
    assert_eq!(refused(Asf::try_new(1, 31)), "doublings");
    assert_eq!(refused(Asf::try_new(1, 15)), "largest step");
    assert_eq!(refused(Asf::new(1, 4).try_with_run(0)), "run");
    assert_eq!(refused(Asf::new(1, 4).try_with_run(9)), "run");
    assert!(Asf::try_new(1, 14).is_ok() && Asf::try_new(16_383, 1).is_ok());
    assert!(Asf::try_new(16_384, 1).is_err());
    assert!(AdaptiveStepForward::<f32>::try_new(1e31, 1).is_err());
    assert!(AdaptiveStepForward::<f32>::try_new(f32::NAN, 1).is_err());
}

/// All states that a signal reaches which moves by a threshold at most: it is never more than two thresholds away.
#[test]
fn a_slow_signal_is_followed_within_two_thresholds() {
    for (threshold, doublings, run) in (1..=4)
        .flat_map(|a| [1, 3, 6].into_iter().flat_map(move |b| (1..=8).map(move |c| (a, b, c))))
    {
        let scheme = Asf::new(threshold, doublings).with_run(run);
        let mut encoder = scheme.encoder();
        encoder.prime(&[0]);
        // A state is how far the sample is from the value, and the rest of the encoder's state as it prints.
        let mut seen = HashSet::new();
        let mut open = vec![(0_i16, *encoder.state())];
        while let Some((x, state)) = open.pop() {
            for x in x - threshold..=x + threshold {
                let mut encoder = Encoder::with_state(&scheme, state);
                let spike = encoder.encode(x);
                let text = format!("{:?}", encoder.state());
                let base = base_in(&text);
                let away = x - base;
                assert!(
                    away.abs() <= 2 * threshold,
                    "{threshold} {doublings} {run}: {away} {spike:?}"
                );
                let rest = text.split_once("pace").map(|(_, rest)| rest.to_owned());
                // Near 0, so that the search ends.
                if base.abs() <= 300 && seen.insert((away, rest)) {
                    open.push((x, *encoder.state()));
                }
            }
        }
        assert!(seen.len() > 4, "{}", seen.len());
    }
}

fn base_in(state: &str) -> i16 {
    let (_, rest) = state.split_once("base: ").unwrap();
    rest.split_once(',').unwrap().0.parse().unwrap()
}

/// A jump from rest is followed as fast as said, and never overshot.
#[test]
fn jumps_are_caught_up_with() {
    for (doublings, run) in (1..=6).flat_map(|a| (2..=4).map(move |b| (a, b))) {
        for jump in (0_i16..3000).step_by(7) {
            let scheme = Asf::new(3, doublings).with_run(run);
            let (mut encoder, mut decoder) = (scheme.encoder(), scheme.decoder());
            decoder.decode(encoder.encode(0));
            let steps = (jump as u16).div_ceil(3 << doublings) + 3 * u16::from(doublings);
            let value = (0..steps).fold(0, |_, _| decoder.decode(encoder.encode(jump)));
            assert!((0..=3).contains(&(jump - value)), "{doublings} {run} {jump}: {value}");
        }
    }
}

proptest! {
    /// Without doublings it is step forward.
    #[test]
    fn without_doublings_it_is_step_forward(x in proptest::collection::vec(any::<i16>(), 1..100), threshold in 1_i16..) {
        let (asf, sf) = (Asf::new(threshold, 0), StepForward::new(threshold));
        let (mut asf, mut sf) = (asf.encoder(), sf.encoder());
        for x in x {
            prop_assert_eq!(asf.encode(x), sf.encode(x));
        }
    }

    /// A sample that is not finite counts as a silent one at both ends.
    #[test]
    fn lost_samples_leave_both_ends_alike(
        x in proptest::collection::vec(prop_oneof![4 => -40.0_f32..40.0, 1 => Just(f32::NAN)], 1..100),
    ) {
        let scheme = AdaptiveStepForward::<f32>::new(0.5, 5);
        let (mut encoder, mut decoder) = (scheme.encoder(), scheme.decoder());
        encoder.encode(0.0);
        for x in x {
            let value = decoder.decode(encoder.encode(x));
            prop_assert!(encoder.keyframe().is_none_or(|keyframe| keyframe == value));
        }
    }

    /// A decoder that lost spikes is right again, to the bit, from the next keyframe on, and there is one within
    /// as many samples of rest as there are doublings, and one.
    #[test]
    fn keyframes_make_up_for_lost_spikes(x in proptest::collection::vec(-200.0_f32..200.0, 1..100), lost in 0..100_usize) {
        let scheme = AdaptiveStepForward::<f32>::new(0.7, 5);
        let (mut encoder, mut whole, mut lossy) = (scheme.encoder(), scheme.decoder(), scheme.decoder());
        whole.resync(x[0]);
        lossy.resync(x[0]);
        let mut is_right = true;
        for (i, x) in x.into_iter().enumerate() {
            let spike = encoder.encode(x);
            let value = whole.decode(spike);
            let is_lost = i == lost && spike.is_fired();
            is_right &= !is_lost;
            lossy.decode(if is_lost { Spike::None } else { spike });
            if let Some(keyframe) = encoder.keyframe() {
                prop_assert_eq!(keyframe.to_bits(), value.to_bits());
                lossy.resync(keyframe);
                is_right = true;
            }
            prop_assert!(!is_right || lossy.held() == Some(value));
        }
        let rest = whole.held().unwrap();
        for _ in 0..6 {
            encoder.encode(rest);
        }
        prop_assert_eq!(encoder.keyframe(), Some(rest));
    }
}

#[test]
fn an_empty_state_is_12_bytes() {
    assert_eq!(size_of_val(&AdaptiveStepForward::<f32>::START), 12);
}
