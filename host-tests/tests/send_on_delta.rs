//! Send-on-delta, by hand and beside step forward.

use spikewire::temporal::{SendOnDelta, StepForward};
use spikewire::{Code, Scheme};

const FOUR: SendOnDelta<i16, 4> = SendOnDelta::new(10);

#[test]
fn check_values() {
    let mut encoder = FOUR.encoder();
    let steps = [0, 9, 35, 95, 90, 10].map(|x| encoder.encode(x).count());
    assert_eq!(steps, [0, 0, 3, 4, 1, -4]);
    assert!(FOUR.try_with_most(5).is_err() && FOUR.try_with_most(0).is_err());
}

/// All pairs of a baseline and a sample within 8 bits: the spikes are those that bring the value within a threshold
/// of the signal, as far as there are enough of them.
#[test]
fn all_pairs_of_8_bits() {
    for (base, sample) in (-128..128).flat_map(|a| (-128..128).map(move |b| (a, b))) {
        let (mut encoder, mut decoder) = (FOUR.encoder(), FOUR.decoder());
        encoder.encode(base);
        decoder.resync(base);
        let steps = encoder.encode(sample);
        assert!(
            steps.firings().map(|firing| firing.slot).eq(0..steps.count().unsigned_abs().into())
        );
        let value = decoder.decode(steps);
        assert_eq!(Some(value), encoder.keyframe());
        let away = (sample - base).unsigned_abs();
        assert_eq!(
            i16::from(steps.count().unsigned_abs()),
            (away.saturating_sub(1) / 10).min(4).cast_signed()
        );
        assert!(away > 50 || (sample - value).abs() <= 10, "{base} {sample}");
    }
}

/// With one spike a sample it is step forward.
#[test]
fn one_spike_is_step_forward() {
    let (sod, sf) = (SendOnDelta::<f32, 1>::new(0.3), StepForward::<f32>::new(0.3));
    let (mut sod, mut sf) = (sod.encoder(), sf.encoder());
    for i in 0..1000 {
        let x = (i as f32 * 0.37).sin() * 2.0;
        assert_eq!(sod.encode(x).count(), sf.encode(x).sign());
    }
}
