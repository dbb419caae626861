//! What a flight controller does before arming: it watches every channel for four seconds on the ground, says whether
//! the sensor is well, takes the thresholds from what it saw, and flies with them. A line for each channel, sample type
//! and scheme:
//!
//! ```text
//! gyro-x f32 sf threshold=0.1217 spikes=812 rmse=0.2034
//! ```
//!
//! Threshold and error are in rad/s and m/s², or in the sensor's counts.

#![cfg_attr(target_os = "none", no_std, no_main)]

use core::fmt;

use flight_log::{Recorded, channel};
use spikewire::temporal::{AdaptiveContrast, AdaptiveStepForward};
use spikewire::{Conditions, ConfigError, Sample, Spike, Start, Survey};

/// About four seconds, at 198.5 samples a second.
const WATCHED: usize = 788;

/// At most one spike in fifty samples on the ground.
const SPIKES: f32 = 0.02;

/// How often the adaptive schemes may double a threshold in flight.
const DOUBLINGS: u8 = 5;

const CHANNELS: [&str; 6] = ["gyro-x", "gyro-y", "gyro-z", "accel-x", "accel-y", "accel-z"];

/// What a sensor of ±2000 °/s and ±16 g can say, and how much the vehicle may move while it is watched.
struct Sensor {
    /// In rad/s or m/s², as all of these.
    limit: f64,
    largest_change: f64,
    stillness: f64,
}

const GYRO: Sensor = Sensor { limit: 34.9, largest_change: 0.25, stillness: 1.0 };
const ACCEL: Sensor = Sensor { limit: 156.9, largest_change: 2.0, stillness: 8.0 };

fn run(out: &mut impl fmt::Write) -> fmt::Result {
    for (index, name) in CHANNELS.into_iter().enumerate() {
        fly::<f32>(out, index, name, "f32")?;
        fly::<i16>(out, index, name, "i16")?;
    }
    Ok(())
}

/// Watches one channel, then flies it, if it is fit.
fn fly<S: Recorded>(
    out: &mut impl fmt::Write,
    index: usize,
    name: &str,
    sample: &str,
) -> fmt::Result {
    let Ok(mut survey) = conditions::<S>(index).map(Survey::<S, 64>::new) else {
        return writeln!(out, "{name} {sample} cannot be watched");
    };
    channel::<S>(index).take(WATCHED).for_each(|sample| survey.observe(sample));
    let fit = match survey.verdict() {
        Ok(fit) => fit,
        Err(unfit) => return writeln!(out, "{name} {sample} unfit: {unfit}"),
    };
    let schemes = || {
        let (sf, tbr) = (fit.step_forward(SPIKES)?, fit.temporal_contrast(SPIKES)?);
        let asf = AdaptiveStepForward::try_new(sf.threshold(), DOUBLINGS)?;
        let atbr = AdaptiveContrast::try_new(tbr.threshold(), DOUBLINGS)?;
        Ok((sf, asf, tbr, atbr))
    };
    match schemes() {
        Ok((sf, asf, tbr, atbr)) => {
            Flown::of(index, &sf).write(out, name, sample, "sf", sf.threshold())?;
            Flown::of(index, &asf).write(out, name, sample, "asf", asf.threshold())?;
            Flown::of(index, &tbr).write(out, name, sample, "tbr", tbr.threshold())?;
            Flown::of(index, &atbr).write(out, name, sample, "atbr", atbr.threshold())
        }
        Err(error) => {
            let error: ConfigError = error;
            writeln!(out, "{name} {sample} {error}")
        }
    }
}

/// The conditions of a channel in a sample type.
fn conditions<S: Recorded>(index: usize) -> Result<Conditions<S>, ConfigError> {
    let (sensor, unit) = if index < 3 { (GYRO, S::GYRO) } else { (ACCEL, S::ACCEL) };
    let [limit, largest_change, stillness] =
        [sensor.limit, sensor.largest_change, sensor.stillness].map(|value| value * unit);
    Conditions::try_new(
        WATCHED as u32,
        S::from_f64(-limit)..=S::from_f64(limit),
        S::from_f64(largest_change),
    )?
    .try_with_stillness(S::from_f64(stillness))
}

/// What became of a channel after it was watched.
struct Flown {
    spikes: u32,
    rmse: f64,
}

impl Flown {
    /// Encodes and decodes the flight behind the seconds that were watched, from its first sample.
    fn of<S: Recorded, P: Start<Sample = S, Code = Spike, Output = Spike>>(
        index: usize,
        scheme: &P,
    ) -> Self {
        let (mut encoder, mut decoder) = (scheme.encoder(), scheme.decoder());
        let flight = channel::<S>(index).skip(WATCHED);
        flight.clone().take(1).for_each(|first| decoder.resync(first));
        let (mut samples, mut spikes, mut squares) = (0_u32, 0, 0.0);
        for sample in flight {
            let spike = encoder.encode(sample);
            spikes += u32::from(spike != Spike::None);
            let error = decoder.decode(spike).to_f64() - sample.to_f64();
            samples += 1;
            squares += error * error;
        }
        Self { spikes, rmse: libm::sqrt(squares / f64::from(samples)) }
    }

    fn write<S: Sample>(
        &self,
        out: &mut impl fmt::Write,
        name: &str,
        sample: &str,
        scheme: &str,
        threshold: S,
    ) -> fmt::Result {
        let (threshold, Self { spikes, rmse }) = (threshold.to_f64(), self);
        writeln!(
            out,
            "{name} {sample} {scheme} threshold={threshold:.4} spikes={spikes} rmse={rmse:.4}"
        )
    }
}

#[cfg_attr(target_os = "none", board::entry)]
fn main() -> ! {
    board::finish(run(&mut board::console()))
}
