//! Every scheme, with parameters that each channel's calibration gives.

use rand_pcg::Pcg32;
use spikewire::{
    Calibration, Code, ConfigError, Decoder, Encoder, Output, Sample, Scheme,
    population::{Centres, Gaussian, Position, Probabilistic, ReceptiveFields, Slots},
    rate::{Ben, BenToolbox, Hough, Scale, Shape, Taps, ThresholdHough},
    temporal::{MovingWindow, StepForward, TemporalContrast},
};

use crate::flight::{Recorded, channel};

/// Takes down what a scheme does with a channel.
pub trait Log {
    /// The scheme's latency in samples, at the beginning.
    fn latency(&mut self, samples: usize);

    /// One outcome of the encoder; no spike is one too.
    fn code(&mut self, code: &impl Code);

    /// What the decoder makes of it, beside the sample it stands for.
    fn decoded<S: Sample>(&mut self, sample: S, value: S);
}

/// One channel's calibration, as fractions of its range.
pub struct Channel<S> {
    index: usize,
    calibration: Calibration<S>,
    min: S,
    max: S,
}

impl<S: Recorded> Channel<S> {
    pub fn new(index: usize) -> Self {
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
    fn fly<E, D>(&self, log: &mut impl Log, mut encoder: E, mut decoder: D)
    where
        E: Encoder<Sample = S>,
        D: Decoder<Sample = S, Code = <E::Output as Output>::Code>,
    {
        let mut truth = self.samples();
        truth.clone().take(1).for_each(|first| decoder.resync(first));
        let mut receive = |code| {
            log.code(&code);
            let value = decoder.decode(code);
            truth.next().into_iter().for_each(|sample| log.decoded(sample, value));
        };
        self.samples().filter_map(|sample| encoder.encode(sample).code()).for_each(&mut receive);
        encoder.finish().for_each(receive);
    }

    fn fly_scheme<P: Scheme<Sample = S>>(&self, log: &mut impl Log, scheme: P) {
        log.latency(P::LATENCY);
        self.fly(log, scheme.encoder(), scheme.decoder());
    }
}

/// What runs a scheme on one channel.
pub type Flight<S, L> = fn(&Channel<S>, &mut L) -> Result<(), ConfigError>;

/// Every scheme, by its name.
pub fn flights<S: Recorded, L: Log>() -> [(&'static str, Flight<S, L>); 13] {
    [
        ("tbr", |channel, log| {
            let scheme = TemporalContrast::from_magnitudes(&channel.calibration, 0.5)?;
            channel.fly_scheme(log, scheme);
            Ok(())
        }),
        ("sf", |channel, log| {
            channel.fly_scheme(log, StepForward::new(channel.fraction(0.02))?);
            Ok(())
        }),
        ("mw", |channel, log| {
            channel.fly_scheme(log, MovingWindow::<S, 6>::new(channel.fraction(0.02))?);
            Ok(())
        }),
        ("hsa", |channel, log| {
            let taps =
                Taps::<S, 15>::shaped(Shape::Triangular, Scale::Peak(channel.fraction(0.1)))?;
            channel.fly_scheme(log, Hough::new(&taps).with_shift(channel.min)?);
            Ok(())
        }),
        ("t-hsa", |channel, log| {
            let taps =
                Taps::<S, 15>::shaped(Shape::Triangular, Scale::Peak(channel.fraction(0.1)))?;
            let scheme = ThresholdHough::new(&taps, channel.fraction(0.085))?;
            channel.fly_scheme(log, scheme.with_shift(channel.min)?);
            Ok(())
        }),
        ("bsa", |channel, log| {
            let taps = Taps::<S, 24>::shaped(Shape::Hann, Scale::Sum(channel.fraction(1.0)))?;
            let scheme = Ben::subtractive(&taps, channel.fraction(0.955))?;
            channel.fly_scheme(log, scheme.with_shift(channel.min)?);
            Ok(())
        }),
        ("bsa-mul", |channel, log| {
            let taps = Taps::<S, 24>::shaped(Shape::Hann, Scale::Sum(channel.fraction(2.0)))?;
            let scheme = Ben::multiplicative(&taps, 0.92)?;
            channel.fly_scheme(log, scheme.with_shift(channel.min)?);
            Ok(())
        }),
        ("bsa-toolbox", |channel, log| {
            let taps = Taps::<S, 9>::shaped(Shape::Triangular, Scale::Peak(channel.fraction(0.2)))?;
            let scheme = BenToolbox::new(&taps, 1.15)?;
            channel.fly_scheme(log, scheme.with_shift(channel.min)?);
            Ok(())
        }),
        ("position", |channel, log| {
            let centres = Centres::<S, 20>::new_linear(channel.min, channel.max)?;
            channel.fly_scheme(log, Position::new(&centres));
            Ok(())
        }),
        ("position-gauss", |channel, log| {
            let centres = Centres::<S, 20>::new_gaussian_spaced(channel.min, channel.max)?;
            channel.fly_scheme(log, Position::new(&centres));
            Ok(())
        }),
        ("grf", |channel, log| {
            let centres = Centres::<S, 20>::new_linear(channel.min, channel.max)?;
            channel.fly_scheme(log, Gaussian::new(&centres));
            Ok(())
        }),
        ("grf-slots", |channel, log| {
            let fields = ReceptiveFields::<S, 15, 10>::new(channel.min, channel.max, 1.5)?;
            channel.fly_scheme(log, Slots::new(&fields));
            Ok(())
        }),
        ("grf-prob", |channel, log| {
            let fields = ReceptiveFields::<S, 15, 64>::new(channel.min, channel.max, 1.5)?;
            let scheme = Probabilistic::new(&fields);
            let generator = Pcg32::new(2026, channel.index as u64);
            log.latency(Probabilistic::<S, 15, 64>::LATENCY);
            channel.fly(log, scheme.encoder(generator), scheme.decoder());
            Ok(())
        }),
    ]
}
