//! A set of six samples through a bank, channels side by side, and nothing after it.

use core::{
    fmt::{self, Write},
    hint::black_box,
};

use board::stopwatch::{counted, keep};
use spikewire::{
    Bank, Calibration, ConfigError, Start, Tick,
    rate::{Hough, Scale, Shape, Taps, ThresholdHough},
    temporal::StepForward,
};

use super::{
    flight::{self, CHANNELS},
    meter::{Cost, take},
};
use crate::signal::Measured;

#[inline(never)] // leaves the stack before the next one comes
pub fn measure<S: Measured>(out: &mut impl Write, sample: &str) -> fmt::Result {
    let schemes = flight::Schemes::new(StepForward::<S>::try_new).ok_or(fmt::Error)?;
    bank(out, ("bank-sf-6", sample), schemes.bank())?;

    let minima = minima::<S>();
    let [rates, accelerations] = peaks().map(|peak| {
        Taps::<S, 15>::try_shaped(Shape::Triangular, Scale::Peak(S::from_f64(peak))).ok()
    });
    let (rates, accelerations) = (rates.ok_or(fmt::Error)?, accelerations.ok_or(fmt::Error)?);
    let taps = |channel: usize| if channel < 3 { rates } else { accelerations };

    let scheme = |channel| Hough::new(taps(channel)).try_with_shift(minima[channel]);
    rate_bank(out, ("bank-hsa-6", sample), scheme)?;

    let scheme = |channel: usize| {
        let threshold = S::from_f64(0.85 * peaks()[channel / 3]);
        ThresholdHough::try_new(taps(channel), threshold)?.try_with_shift(minima[channel])
    };
    rate_bank(out, ("bank-t-hsa-6", sample), scheme)
}

/// Of the filters, in rad/s and m/s².
fn peaks() -> [f64; 2] {
    [0.5, 2.0]
}

/// The smallest sample of each channel, which a rate code takes off.
fn minima<S: Measured>() -> [S; CHANNELS] {
    let mut calibrations = [(); CHANNELS].map(|()| Calibration::<S>::new());
    for (_, set) in flight::samples().map(flight::typed::<S>) {
        calibrations.iter_mut().zip(set).for_each(|(channel, sample)| channel.observe(sample));
    }
    calibrations.map(|channel| channel.min().unwrap_or_default())
}

#[inline(never)] // leaves the stack before the next one comes
fn rate_bank<P: Start<Sample: Measured> + Copy>(
    out: &mut impl Write,
    name: (&str, &str),
    scheme: impl Fn(usize) -> Result<P, ConfigError>,
) -> fmt::Result {
    let first = scheme(0).map_err(|_| fmt::Error)?;
    let mut schemes = [first; CHANNELS];
    for (channel, slot) in schemes.iter_mut().enumerate() {
        *slot = scheme(channel).map_err(|_| fmt::Error)?;
    }
    bank(out, name, Bank::per_channel(schemes.each_ref()))
}

#[inline(never)] // leaves the stack before the next one comes
fn bank<P: Start<Sample: Measured>>(
    out: &mut impl Write,
    (name, sample): (&str, &str),
    mut bank: Bank<[&P; CHANNELS], CHANNELS>,
) -> fmt::Result {
    let mut cost = Cost::default();
    for (tick, set) in flight::samples().map(flight::typed::<P::Sample>) {
        let (tick, set) = (black_box(&tick), black_box(&set));
        let call = *cost.call.get_or_insert_with(|| counted(|| take(&mut bank, tick, set)));
        let count = counted(|| encode(&mut bank, tick, set)).saturating_sub(call);
        cost.add(1, 0, count);
    }
    cost.print(out, (name, "encode"), Some(sample), "sample set")
}

#[inline(never)]
fn encode<P: Start>(
    bank: &mut Bank<[&P; CHANNELS], CHANNELS>,
    tick: &Tick,
    set: &[P::Sample; CHANNELS],
) {
    bank.encode(*tick, *set, |event| keep(&event));
}
