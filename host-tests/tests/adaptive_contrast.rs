//! Adaptive contrast, by hand and beside plain contrast.

use crate::common::refused;
use proptest::prelude::*;
use spikewire::temporal::{AdaptiveContrast, TemporalContrast};
use spikewire::{Scheme, Spike, Start};

type Atbr = AdaptiveContrast<i16>;

/// Thresholds of 2, 4, 8 and 16, at 0, 4, 8 and 12 spikes of 16 samples.
#[test]
fn the_threshold_follows_the_spikes() {
    let scheme = Atbr::new(2, 3);
    let (mut encoder, mut decoder) = (scheme.encoder(), scheme.decoder());
    // Changes of 3 until four of them spiked; then 4 is no spike, 5 is one.
    let changes = [0, 3, -3, 3, -3, 4, 5, -8, 9, 8];
    let fired = [0, 1, -1, 1, -1, 0, 1, -1, 1, 1];
    let values = [0, 2, 0, 2, 0, 0, 4, 0, 4, 8];
    let mut x = 0;
    for ((change, fired), value) in changes.into_iter().zip(fired).zip(values) {
        x += change;
        let spike = encoder.encode(x);
        assert_eq!((spike.sign(), decoder.decode(spike)), (fired, value), "{change}");
    }
    // Eight spikes: the threshold is 8, until the oldest is 17 samples old.
    assert!(!encoder.encode(x + 8).is_fired());
}

#[test]
fn what_makes_no_sense_is_refused_by_name() {
    assert_eq!(refused(Atbr::try_new(0, 4)), "threshold");
    assert_eq!(refused(Atbr::try_new(1, 16)), "doublings");
    assert_eq!(refused(Atbr::try_new(1, 15)), "largest threshold");
    assert!(Atbr::try_new(1, 14).is_ok() && Atbr::try_new(16_384, 1).is_err());
    assert!(AdaptiveContrast::<f32>::try_new(1e31, 1).is_err());
    assert!(AdaptiveContrast::<f32>::try_new(f32::NAN, 1).is_err());
}

proptest! {
    #[test]
    fn without_doublings_it_is_temporal_contrast(x in proptest::collection::vec(any::<i16>(), 1..100), threshold in 1_i16..) {
        let (atbr, tbr) = (Atbr::new(threshold, 0), TemporalContrast::new(threshold));
        let (mut atbr, mut tbr) = (atbr.encoder(), tbr.encoder());
        for x in x {
            prop_assert_eq!(atbr.encode(x), tbr.encode(x));
        }
    }

    /// No spike is of a change within the smallest threshold, and every change beyond the largest has one.
    #[test]
    fn thresholds_stay_within_their_bounds(x in proptest::collection::vec(-300..300_i16, 2..200), threshold in 1..40_i16, doublings in 0..=8_u8) {
        let scheme = Atbr::try_new(threshold, doublings).unwrap();
        let mut encoder = scheme.encoder();
        encoder.encode(x[0]);
        for pair in x.windows(2) {
            let change = i32::from(pair[1] - pair[0]).abs();
            let is_fired = encoder.encode(pair[1]).is_fired();
            prop_assert!(!is_fired || change > i32::from(threshold));
            prop_assert!(is_fired || change <= i32::from(threshold) << doublings);
        }
    }

    /// In slices, with samples that are not finite between, spikes are those of the sample form, and the decoder
    /// steps by the encoder's thresholds: it is told nothing but the spikes.
    #[test]
    fn slices_and_lost_samples(
        x in proptest::collection::vec(prop_oneof![9 => -8.0_f32..8.0, 1 => Just(f32::NAN)], 1..200),
    ) {
        let scheme = AdaptiveContrast::<f32>::new(0.5, 4);
        let run = host_tests::compare::encode(&scheme, &x);
        prop_assert_eq!(run.rejected as usize, x.iter().filter(|x| x.is_nan()).count());
        let mut decoder = scheme.decoder();
        let mut recent = [false; 16];
        let mut value = 0.0;
        for (i, spike) in run.outputs.into_iter().enumerate() {
            let fired = recent.iter().filter(|&&fired| fired).count();
            value += f32::from(spike.sign()) * 0.5 * f32::from(1_u8 << (fired * 5 / 16).min(4));
            recent[i % 16] = spike.is_fired();
            prop_assert_eq!(decoder.decode(spike), value);
        }
    }

    /// A decoder that lost a spike is right again, to the bit, from the next keyframe on, and there is one after 16
    /// samples of rest.
    #[test]
    fn keyframes_make_up_for_lost_spikes(x in proptest::collection::vec(-20.0_f32..20.0, 1..60)) {
        let scheme = AdaptiveContrast::<f32>::new(0.7, 5);
        let (mut encoder, mut decoder) = (scheme.encoder(), scheme.decoder());
        for &x in &x {
            encoder.encode(x);
        }
        let rest = x[x.len() - 1];
        for _ in 0..16 {
            prop_assert_eq!(encoder.encode(rest), Spike::None);
        }
        prop_assert_eq!(encoder.keyframe(), Some(rest));
        decoder.resync(rest);
        let next = encoder.encode(rest + 1.0);
        prop_assert_eq!(decoder.decode(next), rest + 0.7);
    }
}

#[test]
fn an_empty_state_is_12_bytes() {
    assert_eq!(size_of_val(&AdaptiveContrast::<f32>::START), 12);
}
