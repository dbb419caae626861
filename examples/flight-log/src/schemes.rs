//! Every scheme, with parameters that each channel's calibration gives.

use core::fmt;

use rand_pcg::Pcg32;
use spikewire::{
    Calibration, ConfigError, Decoder, Encoder, Output, Scheme,
    population::{Centres, Gaussian, Position, Probabilistic, ReceptiveFields, Slots},
    rate::{Ben, BenToolbox, Hough, Scale, Shape, Taps, ThresholdHough},
    temporal::{MovingWindow, StepForward, TemporalContrast},
};

use crate::{
    flight::{CHANNELS, Recorded, channel},
    line::Line,
};

/// One channel's calibration, as fractions of its range.
struct Channel<S> {
    index: usize,
    calibration: Calibration<S>,
    min: S,
    max: S,
}

impl<S: Recorded> Channel<S> {
    fn new(index: usize) -> Self {
        let mut calibration = Calibration::new();
        channel::<S>(index).for_each(|sample| calibration.observe(sample));
        let (min, max) = (calibration.min(), calibration.max());
        Self { index, calibration, min: min.unwrap_or_default(), max: max.unwrap_or_default() }
    }

    fn fraction(&self, part: f64) -> S {
        S::from_f64((self.max.to_f64() - self.min.to_f64()) * part)
    }

    fn samples(&self) -> impl Iterator<Item = S> + Clone {
        channel(self.index)
    }

    /// From samples to spikes and back. The decoder starts where the signal does, if it adds up steps.
    fn fly<E, D>(&self, line: &mut Line, mut encoder: E, mut decoder: D)
    where
        E: Encoder<Sample = S>,
        D: Decoder<Sample = S, Code = <E::Output as Output>::Code>,
    {
        let mut truth = self.samples();
        truth.clone().take(1).for_each(|first| decoder.resync(first));
        let mut receive = |code| {
            line.code(&code);
            let value = decoder.decode(code);
            truth.next().into_iter().for_each(|sample| line.decoded(sample, value));
        };
        self.samples().filter_map(|sample| encoder.encode(sample).code()).for_each(&mut receive);
        encoder.finish().for_each(receive);
    }

    fn fly_scheme<P: Scheme<Sample = S>>(&self, line: &mut Line, scheme: P) {
        self.fly(line, scheme.encoder(), scheme.decoder());
    }
}

/// What runs a scheme on one channel.
type Flight<S> = fn(&Channel<S>, &mut Line) -> Result<(), ConfigError>;

/// Flies every scheme in one sample type, and prints a line for each.
pub fn fly<S: Recorded>(out: &mut impl fmt::Write, sample: &str) -> fmt::Result {
    let flights: [(&str, Flight<S>); 13] = [
        ("tbr", |channel, line| {
            let scheme = TemporalContrast::from_magnitudes(&channel.calibration, 0.5)?;
            channel.fly_scheme(line, scheme);
            Ok(())
        }),
        ("sf", |channel, line| {
            channel.fly_scheme(line, StepForward::new(channel.fraction(0.02))?);
            Ok(())
        }),
        ("mw", |channel, line| {
            channel.fly_scheme(line, MovingWindow::<S, 6>::new(channel.fraction(0.02))?);
            Ok(())
        }),
        ("hsa", |channel, line| {
            let taps =
                Taps::<S, 15>::shaped(Shape::Triangular, Scale::Peak(channel.fraction(0.1)))?;
            channel.fly_scheme(line, Hough::new(&taps).with_shift(channel.min)?);
            Ok(())
        }),
        ("t-hsa", |channel, line| {
            let taps =
                Taps::<S, 15>::shaped(Shape::Triangular, Scale::Peak(channel.fraction(0.1)))?;
            let scheme = ThresholdHough::new(&taps, channel.fraction(0.085))?;
            channel.fly_scheme(line, scheme.with_shift(channel.min)?);
            Ok(())
        }),
        ("bsa", |channel, line| {
            let taps = Taps::<S, 24>::shaped(Shape::Hann, Scale::Sum(channel.fraction(1.0)))?;
            let scheme = Ben::subtractive(&taps, channel.fraction(0.955))?;
            channel.fly_scheme(line, scheme.with_shift(channel.min)?);
            Ok(())
        }),
        ("bsa-mul", |channel, line| {
            let taps = Taps::<S, 24>::shaped(Shape::Hann, Scale::Sum(channel.fraction(1.0)))?;
            let scheme = Ben::multiplicative(&taps, 0.875)?;
            channel.fly_scheme(line, scheme.with_shift(channel.min)?);
            Ok(())
        }),
        ("bsa-toolbox", |channel, line| {
            let taps = Taps::<S, 9>::shaped(Shape::Triangular, Scale::Peak(channel.fraction(0.1)))?;
            let scheme = BenToolbox::new(&taps, 1.15)?;
            channel.fly_scheme(line, scheme.with_shift(channel.min)?);
            Ok(())
        }),
        ("position", |channel, line| {
            let centres = Centres::<S, 20>::new_linear(channel.min, channel.max)?;
            channel.fly_scheme(line, Position::new(&centres));
            Ok(())
        }),
        ("position-gauss", |channel, line| {
            let centres = Centres::<S, 20>::new_gaussian_spaced(channel.min, channel.max)?;
            channel.fly_scheme(line, Position::new(&centres));
            Ok(())
        }),
        ("grf", |channel, line| {
            let centres = Centres::<S, 20>::new_linear(channel.min, channel.max)?;
            channel.fly_scheme(line, Gaussian::new(&centres));
            Ok(())
        }),
        ("grf-slots", |channel, line| {
            let fields = ReceptiveFields::<S, 15, 10>::new(channel.min, channel.max, 1.5)?;
            channel.fly_scheme(line, Slots::new(&fields));
            Ok(())
        }),
        ("grf-prob", |channel, line| {
            let fields = ReceptiveFields::<S, 15, 64>::new(channel.min, channel.max, 1.5)?;
            let scheme = Probabilistic::new(&fields);
            let generator = Pcg32::new(2026, channel.index as u64);
            channel.fly(line, scheme.encoder(generator), scheme.decoder());
            Ok(())
        }),
    ];
    for (name, flight) in flights {
        let mut line = Line::default();
        for index in 0..CHANNELS {
            if let Err(error) = flight(&Channel::new(index), &mut line) {
                writeln!(out, "{name} {sample} channel {index}: {error}")?;
                return Err(fmt::Error);
            }
        }
        line.write(out, name, sample)?;
    }
    Ok(())
}
