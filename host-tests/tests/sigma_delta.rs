//! Sigma-delta against its transcription, and its means.

use crate::common::{rate::spikes_of, refused};
use fixed::types::{I8F8, I16F16};
use host_tests::compare;
use proptest::prelude::*;
use spikewire::rate::{Average, Averaging, SigmaDelta, Window};
use spikewire::{Sample, Scheme, Spike};

use catalogue::plain::{self, Plain};
use catalogue::schemes::sigma_delta::transcribed;

/// Recordings that leave the range from -1000 to 3000 counts.
pub(crate) fn drawn() -> impl Strategy<Value = Vec<i16>> {
    proptest::collection::vec(-1200_i16..=3200, 1..300)
}

/// Samples of every type: counts as they are, and 256 of them a 1.
pub(crate) fn in_every_type(x: &[i16], mut check: impl Check) {
    check.check(x, |x| x);
    let of = |x: i16| f32::from(x) / 256.0;
    check.check(&x.iter().map(|&x| of(x)).collect::<Vec<_>>(), of);
    let of = I8F8::from_bits;
    check.check(&x.iter().map(|&x| of(x)).collect::<Vec<_>>(), of);
    let of = |x: i16| I16F16::from_bits(i32::from(x) << 8);
    check.check(&x.iter().map(|&x| of(x)).collect::<Vec<_>>(), of);
}

/// What is checked in every sample type, with what a count becomes.
pub(crate) trait Check {
    fn check<S: Plain>(&mut self, x: &[S], of: impl Fn(i16) -> S);
}

pub(crate) fn values_of<P: Scheme<Code = Spike>>(scheme: &P, spikes: &[i8]) -> Vec<P::Sample> {
    let mut decoder = scheme.decoder();
    compare::spikes_of(spikes).into_iter().map(|spike| decoder.decode(spike)).collect()
}

/// Against the transcriptions.
struct Agrees(u8);

impl Check for Agrees {
    fn check<S: Plain>(&mut self, x: &[S], of: impl Fn(i16) -> S) {
        let (min, max) = (of(-1000), of(3000));
        let scheme = SigmaDelta::new(min..=max, Average::new(self.0));
        let mut spikes = vec![0; x.len()];
        transcribed(x, min, max, &mut spikes);
        assert_eq!(spikes_of(&scheme, x), spikes);
        let mut values = vec![S::default(); x.len()];
        let range = max.into() - min.into();
        plain::average_decode(&spikes, min, max, (range, 0), self.0, &mut values);
        assert_eq!(values_of(&scheme, &spikes), values);
        let scheme = SigmaDelta::new(min..=max, Window::<8>::new(self.0));
        assert_eq!(spikes_of(&scheme, x), spikes);
        plain::window_decode(&spikes, min, max, self.0, &mut values);
        assert_eq!(values_of(&scheme, &spikes), values);
    }
}

const BYTE: SigmaDelta<i16, Window> = SigmaDelta::new(0..=255, Window::new(4));

#[test]
fn check_values() {
    let spikes = spikes_of(&BYTE, &[100; 16]);
    assert_eq!(spikes, [0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1]);
    // Six of sixteen, to the nearest.
    assert_eq!(values_of(&BYTE, &spikes)[15], 96);
}

/// At the ends and beyond: always and never. A sum of a whole range fires.
#[test]
fn ends_and_ties() {
    assert_eq!(spikes_of(&BYTE, &[255, 300, i16::MAX]), [1, 1, 1]);
    assert_eq!(spikes_of(&BYTE, &[0, -1, i16::MIN]), [0, 0, 0]);
    let half = SigmaDelta::<f32, _>::new(-1.0..=1.0, Average::new(1));
    assert_eq!(spikes_of(&half, &[0.0; 4]), [0, 1, 0, 1]);
}

/// The widest ranges there are.
#[test]
fn integers_do_not_wrap() {
    let x = [i16::MAX, i16::MIN, 0, 0, i16::MAX, i16::MAX];
    let scheme = SigmaDelta::new(i16::MIN..=i16::MAX, Average::new(15));
    assert_eq!(spikes_of(&scheme, &x), [1, 0, 0, 1, 1, 1]);
    assert_eq!(values_of(&scheme, &vec![1; 500_000]).last(), Some(&i16::MAX));
    let scheme = SigmaDelta::new(I16F16::MIN..=I16F16::MAX, Average::new(15));
    let [min, max] = [I16F16::MIN, I16F16::MAX];
    let x = [max, min, I16F16::ZERO, I16F16::ZERO, max, max];
    assert_eq!(spikes_of(&scheme, &x), [1, 0, 0, 1, 1, 1]);
    assert_eq!(values_of(&scheme, &vec![1; 1_000_000]).last(), Some(&I16F16::MAX));
}

#[test]
fn what_is_not_finite_is_counted_and_ignored() {
    let scheme = SigmaDelta::<f32, _>::new(0.0..=1.0, Average::new(3));
    let mut encoder = scheme.encoder();
    let x = [0.75, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.25];
    assert_eq!(x.map(|x| encoder.encode(x).sign()), [0, 0, 0, 0, 1]);
    assert_eq!(encoder.rejected(), 3);
    encoder.reset();
    assert_eq!((encoder.rejected(), encoder.encode(0.75)), (0, Spike::None));
}

#[test]
fn what_makes_no_sense_is_refused_by_name() {
    fn parameter<S: Sample>(min: S, max: S) -> &'static str {
        refused(SigmaDelta::try_new(min..=max, Average::new(1)))
    }
    assert_eq!(parameter(f32::NAN, 1.0), "min");
    assert_eq!(parameter(0.0, f32::INFINITY), "max");
    assert_eq!(parameter(0.0, 1e32), "max");
    assert_eq!(parameter(-1e32, 0.0), "min");
    assert_eq!(parameter(5_i16, 5), "min and max");
    for power in [0, 16] {
        let error = Average::try_new(power).unwrap_err().to_string();
        assert_eq!(error, format!("power of the average {power} must lie in 1..=15"));
    }
    let error = Window::<1>::try_new(6).unwrap_err().to_string();
    assert_eq!(error, "power of the window 6 must lie in 0..=5");
    assert_eq!(Window::<2>::new(6).samples(), 64);
}

/// An average goes on from a value, a window forgets its spikes.
#[test]
fn decoders_are_resynchronised() {
    fn resync<A: Averaging>(averaging: A, value: i16) -> i16 {
        let scheme = SigmaDelta::new(0_i16..=256, averaging);
        let mut decoder = scheme.decoder();
        for _ in 0..9 {
            decoder.decode(Spike::Up);
        }
        decoder.resync(value);
        decoder.decode(Spike::None)
    }
    assert_eq!(resync(Average::new(4), 160), 150);
    assert_eq!(resync(Window::<1>::new(4), 160), 0);
}

proptest! {
    #[test]
    fn as_transcribed(x in drawn(), power in 1_u8..8) {
        in_every_type(&x, Agrees(power));
    }

    /// Any stretch of samples is told by its spikes to less than one.
    #[test]
    fn any_stretch_is_told_to_less_than_a_spike(x in drawn(), from in 0_usize..300, to in 0_usize..300) {
        let scheme = SigmaDelta::new(-1000_i16..=3000, Average::new(1));
        let spikes = spikes_of(&scheme, &x);
        let (from, to) = (from.min(x.len()), to.min(x.len()).max(from.min(x.len())));
        let coded: i32 = spikes[from..to].iter().map(|&spike| i32::from(spike) * 4000).sum();
        let sum: i32 = x[from..to].iter().map(|&x| i32::from(x).clamp(-1000, 3000) + 1000).sum();
        prop_assert!((coded - sum).abs() < 4000);
    }

    #[test]
    fn values_are_near_the_means(x in drawn(), power in 1_u8..8) {
        let count = 1_usize << power;
        let held: Vec<f64> = x.iter().map(|&x| f64::from(x.clamp(-1000, 3000))).collect();
        let (average, window) = (Average::new(power), Window::<4>::new(power));
        let scheme = SigmaDelta::new(-1000_i16..=3000, window);
        let values = values_of(&scheme, &spikes_of(&scheme, &x));
        for i in count - 1..x.len() {
            let mean = held[i + 1 - count..=i].iter().sum::<f64>() / count as f64;
            prop_assert!((f64::from(values[i]) - mean).abs() < 4000.0 / count as f64 + 0.5);
        }
        let scheme = SigmaDelta::new(-1000_i16..=3000, average);
        let values = values_of(&scheme, &spikes_of(&scheme, &x));
        // The same average, of the samples.
        let mut sum = 4000_i64 << (power - 1);
        for (value, x) in values.into_iter().zip(held) {
            sum += x as i64 + 1000 - (sum >> power);
            let mean = sum as f64 / count as f64 - 1000.0;
            prop_assert!((f64::from(value) - mean).abs() < 4000.0 / count as f64 + 1.0);
        }
    }

    /// A window is right again, to the bit, after as many samples as its recovery says.
    #[test]
    fn a_window_recovers(x in drawn(), lost in 0_usize..100) {
        let scheme = SigmaDelta::new(-1000_i16..=3000, Window::<1>::new(5));
        let spikes = spikes_of(&scheme, &x);
        let mut lossy = spikes.clone();
        let end = (lost + 7).min(lossy.len());
        lossy[lost.min(end)..end].fill(0);
        let spikewire::Recovery::Samples(recovery) = SigmaDelta::<i16, Window>::RECOVERY else { panic!() };
        let (whole, lossy) = (values_of(&scheme, &spikes), values_of(&scheme, &lossy));
        let from = (end + recovery - 1).min(x.len());
        prop_assert_eq!(&whole[from..], &lossy[from..]);
    }
}
