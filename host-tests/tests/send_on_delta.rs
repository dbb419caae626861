//! Send-on-delta, by hand and beside step forward.

use spikewire::Scheme;
use spikewire::temporal::{SendOnDelta, StepForward};

const FOUR: SendOnDelta<i16, 4> = SendOnDelta::new(10);

#[test]
fn check_values() {
    let mut encoder = FOUR.encoder();
    let steps = [0, 9, 35, 95, 90, 10].map(|x| encoder.encode(x).count());
    assert_eq!(steps, [0, 0, 3, 4, 1, -4]);
    assert!(FOUR.try_with_most(5).is_err() && FOUR.try_with_most(0).is_err());
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
