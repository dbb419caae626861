//! Every scheme, built at run time.

use core::hint::black_box;
use rand_pcg::Pcg32;
use spikewire::{
    Calibration, ConfigError, Sample, Scheme,
    population::{Centres, Gaussian, Position, Probabilistic, ReceptiveFields, Slots},
    rate::{Ben, BenToolbox, Hough, Scale, Shape, Taps, ThresholdHough},
    temporal::{MovingWindow, StepForward, TemporalContrast},
};

use crate::exercise;

/// A flight controller would tell a bad parameter; whether it is one must not be known here.
pub fn link<S: Sample>() {
    let failed = [temporal::<S>, rate::<S>, population::<S>, probabilistic::<S>]
        .map(|family| black_box(family)().is_err());
    black_box(failed);
}

fn temporal<S: Sample>() -> Result<(), ConfigError> {
    let mut calibration = black_box(Calibration::<S>::new());
    calibration.observe(black_box(S::default()));
    black_box((calibration.min(), calibration.max(), calibration.seen(), calibration.rejected()));
    let threshold = black_box(S::from_f64(black_box(1.0)));

    exercise::scheme(TemporalContrast::from_calibration(&calibration, black_box(0.5))?);
    exercise::scheme(TemporalContrast::from_magnitudes(&calibration, black_box(0.5))?);
    let scheme = TemporalContrast::with_step(threshold, threshold)?;
    let mut encoder = scheme.encoder();
    encoder.prime(threshold);
    exercise::codec(encoder, scheme.decoder());

    let scheme = StepForward::new(threshold)?;
    exercise::scheme(scheme);
    let mut encoder = scheme.encoder();
    encoder.prime(threshold);
    exercise::codec(encoder, scheme.decoder());

    let scheme = MovingWindow::<S, 6>::new(threshold)?;
    exercise::scheme(scheme);
    let mut encoder = scheme.encoder();
    encoder.prime(black_box(&[threshold; 6]));
    exercise::codec(encoder, scheme.decoder());
    Ok(())
}

fn rate<S: Sample>() -> Result<(), ConfigError> {
    let value = black_box(S::default());
    let own = Taps::new(black_box([value; 15]))?;
    let shaped = Taps::<S, 15>::shaped(black_box(Shape::Hann), black_box(Scale::Sum(value)))?;
    for taps in [&own, &shaped] {
        exercise::scheme(Hough::new(taps).with_shift(value)?);
        exercise::scheme(ThresholdHough::new(taps, value)?.with_shift(value)?);
        exercise::scheme(Ben::subtractive(taps, value)?.with_shift(value)?);
        exercise::scheme(Ben::multiplicative(taps, black_box(0.9))?.with_shift(value)?);
        exercise::scheme(BenToolbox::new(taps, black_box(1.15))?.with_shift(value)?);
    }
    Ok(())
}

fn population<S: Sample>() -> Result<(), ConfigError> {
    let (min, max) = black_box((S::default(), S::default()));
    exercise::scheme(Position::new(&Centres::new(black_box([min; 20]))?));
    exercise::scheme(Position::new(&Centres::<S, 20>::new_gaussian_spaced(min, max)?));
    exercise::scheme(Gaussian::new(&Centres::<S, 20>::new_linear(min, max)?));

    let fields = ReceptiveFields::<S, 15, 10>::new(min, max, black_box(1.5))?;
    exercise::scheme(Slots::new(&fields).with_floor(black_box(2))?);
    Ok(())
}

fn probabilistic<S: Sample>() -> Result<(), ConfigError> {
    let (min, max) = black_box((S::default(), S::default()));
    let fields = ReceptiveFields::<S, 15, 64>::new(min, max, black_box(1.5))?;
    let scheme = Probabilistic::new(&fields);
    let generator = black_box(Pcg32::new(2026, 0));
    exercise::codec(scheme.encoder(generator), scheme.decoder());
    Ok(())
}
