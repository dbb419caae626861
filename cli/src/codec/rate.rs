//! The rate codes.

use super::Codec;
use super::erased::erase;
use super::shapes::{for_each_filter_length, unsupported};
use crate::settings::{Rate, RateRule};
use anyhow::Result;
use spikewire::Sample;
use spikewire::rate::{Ben, BenToolbox, Hough, Taps, ThresholdHough};

pub(super) fn build<S: Sample>(settings: &Rate) -> Result<Codec> {
    macro_rules! with_length {
        ($($n:literal)*) => {
            match settings.taps.len() {
                $($n => with_filter::<S, $n>(settings),)*
                length => Err(unsupported("filter length", length, &[$($n),*])),
            }
        };
    }
    for_each_filter_length!(with_length)
}

fn with_filter<S: Sample, const F: usize>(settings: &Rate) -> Result<Codec> {
    let taps = std::array::from_fn(|tap| S::from_f64(settings.taps[tap]));
    // The crate's codecs borrow their taps, for flash. A program that builds a few of them and ends
    // can leave the taps to the operating system.
    let taps: &'static Taps<S, F> = Box::leak(Box::new(Taps::new(taps)?));
    let shift = S::from_f64(settings.shift);
    Ok(match settings.rule {
        RateRule::Hough => erase(Hough::new(taps).with_shift(shift)?),
        RateRule::ThresholdHough { threshold } => {
            erase(ThresholdHough::new(taps, S::from_f64(threshold))?.with_shift(shift)?)
        }
        RateRule::BenSubtractive { threshold } => {
            erase(Ben::subtractive(taps, S::from_f64(threshold))?.with_shift(shift)?)
        }
        RateRule::BenMultiplicative { threshold } => {
            erase(Ben::multiplicative(taps, threshold as f32)?.with_shift(shift)?)
        }
        RateRule::BenToolbox { threshold } => {
            erase(BenToolbox::new(taps, threshold as f32)?.with_shift(shift)?)
        }
    })
}
