//! Bernoulli against its transcription, and its means.

use fixed::types::I16F16;
use proptest::prelude::*;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::{Rng, TryRng};
use spikewire::Sample;
use spikewire::rate::{Average, Bernoulli};

use crate::sigma_delta::{Check, drawn, in_every_type, values_of};
use catalogue::{plain::Plain, schemes::bernoulli::transcribed};

/// A draw, and what the next is made of it by.
struct Draws(u32, fn(u32) -> u32);

impl TryRng for Draws {
    type Error = core::convert::Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Self::Error> {
        self.0 = (self.1)(self.0);
        Ok(self.0)
    }

    fn try_next_u64(&mut self) -> Result<u64, Self::Error> {
        panic!("32 bits a sample")
    }

    fn try_fill_bytes(&mut self, _: &mut [u8]) -> Result<(), Self::Error> {
        panic!("32 bits a sample")
    }
}

/// `u = 1664525 u + 1013904223`, of 32 bits, from 1 on.
fn congruential() -> Draws {
    Draws(1, |last| last.wrapping_mul(1_664_525).wrapping_add(1_013_904_223))
}

#[test]
fn check_values() {
    let scheme = Bernoulli::<i16, Draws, _>::new(0..=255, Average::new(4));
    let mut encoder = scheme.encoder(congruential());
    let spikes = [100; 16].map(|x| encoder.encode(x).sign());
    assert_eq!(spikes, [1, 1, 0, 0, 1, 1, 0, 0, 1, 0, 1, 0, 0, 0, 1, 0]);
}

/// The number of draws that fire, of all 65 536, is the probability to the nearest: unbiased.
#[test]
fn all_draws() {
    fn fired<S: Sample>(min: S, max: S, x: S) -> u32 {
        let scheme = Bernoulli::<S, Draws, _>::new(min..=max, Average::new(1));
        // The draws that fire are the lowest: a search finds how many.
        let (mut low, mut high) = (0_u32, 1 << 16);
        while low < high {
            let middle = low.midpoint(high);
            let draw = middle << 16 | 0xffff;
            if scheme.encoder(Draws(draw, |same| same)).encode(x).is_fired() {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        low
    }
    for x in 0..=255 {
        let exact = (2 * 65_536 * x as u32 + 255) / (2 * 255);
        assert_eq!(fired(0_i16, 255, x), exact, "{x}");
        assert_eq!(
            fired(
                I16F16::MIN,
                I16F16::MIN + I16F16::from_bits(255),
                I16F16::MIN + I16F16::from_bits(x.into())
            ),
            exact
        );
        assert_eq!(fired(0.0_f32, 255.0, f32::from(x)), exact);
    }
    assert_eq!(fired(i16::MIN, i16::MAX, i16::MAX), 65_536);
    assert_eq!(fired(i16::MIN, i16::MAX, i16::MIN), 0);
    assert_eq!(fired(i16::MIN, i16::MAX, i16::MAX - 1), 65_535);
    assert_eq!(fired(I16F16::MIN, I16F16::MAX, I16F16::MAX), 65_536);
    assert_eq!(fired(I16F16::MIN, I16F16::MAX, I16F16::MIN), 0);
    assert_eq!(fired(I16F16::MIN, I16F16::MAX, I16F16::ZERO), 32_768);
    assert_eq!(fired(-1e31_f32, 1e31, f32::MAX), 65_536);
    assert_eq!(fired(-1e31_f32, 1e31, f32::MIN), 0);
}

/// A sample that is not finite is counted, and draws no number.
#[test]
fn what_is_not_finite_draws_nothing() {
    let scheme = Bernoulli::<f32, Draws, _>::new(0.0..=255.0, Average::new(4));
    let mut encoder = scheme.encoder(congruential());
    let mut beside = scheme.encoder(congruential());
    for i in 0..100 {
        assert_eq!(encoder.encode([f32::NAN, f32::INFINITY][i % 2]).sign(), 0);
        assert_eq!(encoder.encode(100.0), beside.encode(100.0));
    }
    assert_eq!((encoder.rejected(), beside.rejected()), (100, 0));
    encoder.restart();
    assert_eq!((encoder.rejected(), encoder.encode(100.0)), (0, beside.encode(100.0)));
}

/// The mean over a window of 1024 is as near as said: within four deviations.
#[test]
fn the_mean_is_unbiased() {
    let scheme = Bernoulli::<f32, Pcg32, _>::new(0.0..=1.0, spikewire::rate::Window::<32>::new(10));
    for tenth in 0..=10 {
        let x = tenth as f32 / 10.0;
        let mut encoder = scheme.encoder(Pcg32::new(3, tenth));
        let spikes: Vec<i8> = (0..1024).map(|_| encoder.encode(x).sign()).collect();
        let value = values_of(&scheme, &spikes)[1023];
        assert!((value - x).abs() <= 4.0 / (2.0 * 32.0), "{x}: {value}");
    }
}

struct Agrees;

impl Check for Agrees {
    fn check<S: Plain>(&mut self, x: &[S], of: impl Fn(i16) -> S) {
        let (min, max) = (of(-1000), of(3000));
        let scheme = Bernoulli::<S, Pcg32, _>::new(min..=max, Average::new(3));
        let mut random = Pcg32::new(7, 9);
        let mut encoder = scheme.encoder(random.clone());
        let mut spikes = vec![0; x.len()];
        transcribed(x, min, max, || random.next_u32(), &mut spikes);
        let ours: Vec<i8> = x.iter().map(|&x| encoder.encode(x).sign()).collect();
        assert_eq!(ours, spikes);
    }
}

proptest! {
    #[test]
    fn as_transcribed(x in drawn()) {
        in_every_type(&x, Agrees);
    }
}
