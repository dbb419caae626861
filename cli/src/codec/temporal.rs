//! The temporal codes.

use super::Codec;
use super::erased::erase;
use super::shapes::{for_each_window, unsupported};
use crate::settings;
use anyhow::Result;
use spikewire::Sample;
use spikewire::temporal::{MovingWindow, StepForward, TemporalContrast};

pub(super) fn contrast<S: Sample>(settings: &settings::Contrast) -> Result<Codec> {
    let (threshold, step) = (S::from_f64(settings.threshold), S::from_f64(settings.step));
    Ok(erase(TemporalContrast::with_step(threshold, step)?))
}

pub(super) fn step_forward<S: Sample>(settings: &settings::StepForward) -> Result<Codec> {
    Ok(erase(StepForward::new(S::from_f64(settings.threshold))?))
}

pub(super) fn moving_window<S: Sample>(settings: &settings::MovingWindow) -> Result<Codec> {
    let threshold = S::from_f64(settings.threshold);
    macro_rules! with_window {
        ($($n:literal)*) => {
            match settings.window.saturating_add(1) {
                $($n => Ok(erase(MovingWindow::<S, $n>::new(threshold)?)),)*
                _ => Err(unsupported("window", settings.window, &[$($n - 1),*])),
            }
        };
    }
    for_each_window!(with_window)
}
