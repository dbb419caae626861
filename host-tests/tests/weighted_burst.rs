//! Weighted bursts against their transcription, and their error.

use crate::common::{rate::spikes_of, refused};
use proptest::prelude::*;
use spikewire::Scheme;
use spikewire::rate::{Average, SigmaDelta, WeightedBurst, Window};

use crate::sigma_delta::{Check, drawn, in_every_type, values_of};
use catalogue::plain::{self, Plain};
use catalogue::schemes::burst_weighted::transcribed;

const BYTE: WeightedBurst<i16, Window> = WeightedBurst::new(0..=255, 40, 3, Window::new(0));

#[test]
fn check_values() {
    let spikes = spikes_of(&BYTE, &[100; 12]);
    // The window of one sample gives what each spike means.
    let values = [40, 80, 160, 0, 40, 80, 160, 0, 40, 80, 160, 320];
    assert_eq!(values_of(&BYTE, &spikes), values);
}

#[test]
fn ties_fire() {
    assert_eq!(spikes_of(&BYTE, &[39, 1, 80, 159, 1]), [0, 1, 1, 0, 1]);
}

#[test]
fn what_is_not_finite_is_counted_and_ignored() {
    let scheme = WeightedBurst::<f32, _>::new(0.0..=1.0, 1.0, 0, Average::new(3));
    let mut encoder = scheme.encoder();
    let x = [0.75, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.25];
    assert_eq!(x.map(|x| encoder.encode(x).sign()), [0, 0, 0, 0, 1]);
    assert_eq!(encoder.rejected(), 3);
    encoder.reset();
    assert_eq!((encoder.rejected(), encoder.encode(0.75).sign()), (0, 0));
}

/// The decoder sees no spike, so that the burst ends for both: of 10 that are left the next spikes tell 2 and 4.
#[test]
fn what_is_not_finite_ends_a_burst() {
    let scheme = WeightedBurst::<f32, _>::new(0.0..=8.0, 2.0, 2, Average::new(3));
    let mut encoder = scheme.encoder();
    let x = [8.0, 8.0, f32::NAN, 0.0, 0.0];
    assert_eq!(x.map(|x| encoder.encode(x).sign()), [1, 1, 0, 1, 1]);
}

#[test]
fn what_makes_no_sense_is_refused_by_name() {
    let parameter = |min, max, unit, doublings| {
        refused(WeightedBurst::<f32, _>::try_new(min..=max, unit, doublings, Average::new(1)))
    };
    assert_eq!(parameter(1.0, 0.0, 1.0, 0), "min and max");
    assert_eq!(parameter(0.0, 1.0, 0.0, 0), "weight");
    assert_eq!(parameter(0.0, 1.0, f32::NAN, 0), "weight");
    assert_eq!(parameter(0.0, 1.0, 1.0, 15), "doublings");
    assert_eq!(parameter(0.0, 1.0, 0.49, 1), "largest weight");
    assert_eq!(parameter(0.0, 1.0, 1e31, 1), "largest weight");
    assert!(WeightedBurst::try_new(0.0..=1.0, 0.5, 1, Average::new(1)).is_ok());
    let whole = i16::MIN..=i16::MAX;
    assert!(WeightedBurst::try_new(whole.clone(), 32_767, 1, Average::new(1)).is_err());
    assert!(WeightedBurst::try_new(whole, 16_384, 2, Average::new(1)).is_ok());
}

struct Agrees(u8, u8);

impl Check for Agrees {
    fn check<S: Plain>(&mut self, x: &[S], of: impl Fn(i16) -> S) {
        let (min, max, unit) = (of(-1000), of(3000), of(4000 >> self.1));
        let scheme = WeightedBurst::new(min..=max, unit, self.1, Average::new(self.0));
        let mut spikes = vec![0; x.len()];
        transcribed(x, min, max, unit, self.1, &mut spikes);
        assert_eq!(spikes_of(&scheme, x), spikes);
        let mut values = vec![S::default(); x.len()];
        let weight = (unit.into(), self.1);
        plain::average_decode(&spikes, min, max, weight, self.0, &mut values);
        assert_eq!(values_of(&scheme, &spikes), values);
    }
}

proptest! {
    #[test]
    fn as_transcribed(x in drawn(), power in 1_u8..8, doublings in 0_u8..6) {
        in_every_type(&x, Agrees(power, doublings));
    }

    /// What is not told yet stays below one largest weight more than there are doublings; a window sums what its
    /// spikes mean.
    #[test]
    fn what_is_not_told_is_bounded(x in drawn(), doublings in 0_u8..6, power in 0_u8..6) {
        let unit = 4000_i16.div_euclid(1 << doublings) + 1;
        let one = WeightedBurst::new(-1000_i16..=3000, unit, doublings, Window::<1>::new(0));
        let spikes = spikes_of(&one, &x);
        let mut gain = 0;
        let meant: Vec<i64> = spikes.iter().map(|&spike| {
            let weight = (i64::from(spike) * i64::from(unit)) << gain;
            gain = if spike == 1 { doublings.min(gain + 1) } else { 0 };
            weight
        }).collect();
        let most = (i64::from(doublings + 1) * i64::from(unit)) << doublings;
        let mut left = 0;
        for (meant, x) in meant.iter().zip(x) {
            left += i64::from(x.clamp(-1000, 3000)) + 1000 - meant;
            prop_assert!((0..most).contains(&left), "{} of {}", left, most);
        }
        let window = WeightedBurst::new(-1000_i16..=3000, unit, doublings, Window::<1>::new(power));
        let values = values_of(&window, &spikes);
        for (i, value) in values.into_iter().enumerate() {
            let first = (i + 1).saturating_sub(1 << power);
            let sum: i64 = meant[first..=i].iter().sum();
            let half = (1_i64 << power) / 2;
            prop_assert_eq!(i64::from(value), ((sum + half) >> power) - 1000);
        }
    }

    /// Without doublings, with the range as the unit, it is sigma-delta.
    #[test]
    fn without_doublings_it_is_sigma_delta(x in drawn()) {
        let burst = WeightedBurst::new(-1000_i16..=3000, 4000, 0, Average::new(1));
        let regular = SigmaDelta::new(-1000_i16..=3000, Average::new(1));
        prop_assert_eq!(spikes_of(&burst, &x), spikes_of(&regular, &x));
    }
}
