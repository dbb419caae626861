//! Every scheme of the catalogue, built at run time from a calibration.

use core::hint::black_box;

use catalogue::{Channel, Flight};
use spikewire::{
    Calibration, Conditions, ConfigError, Histogram, Sample, Scheme, Start, Survey,
    filter::{Biquad, Filter, FirstOrder},
    population::{Position, Slots},
    rate::{Bsa, Criterion, Taps},
    temporal::{StepForward, TemporalContrast},
};

use crate::exercise;

/// A flight controller would tell a bad parameter; whether it is one must not be known here.
pub fn link<S: Sample>() {
    black_box(catalogued::<S>().is_err());
    black_box(others::<S>().is_err());
}

fn catalogued<S: Sample>() -> Result<(), ConfigError> {
    let mut calibration = black_box(Calibration::<S>::new());
    calibration.observe(black_box(S::default()));
    black_box((calibration.min(), calibration.max(), calibration.seen(), calibration.rejected()));
    catalogue::fly(
        &Channel::new(black_box(0), black_box(calibration)),
        &mut Linked::<S>(black_box(S::default())),
    )
}

struct Linked<S>(S);

impl<S: Sample> Flight for Linked<S> {
    type Sample = S;
    type Error = ConfigError;

    fn visit<P: Scheme<Sample = S>>(
        &mut self,
        _: &'static str,
        _: &'static str,
        scheme: &P,
        start: P::EncoderState,
    ) -> Result<(), ConfigError> {
        // Linked are both; there is one start.
        if black_box(true) {
            exercise::codec(black_box(scheme), start);
        } else {
            exercise::bank(black_box(scheme), start);
        }
        Ok(())
    }
}

/// The constructors that the flight has no use for.
fn others<S: Sample>() -> Result<(), ConfigError> {
    let (value, calibration) = black_box((S::default(), Calibration::<S>::new()));
    started(&TemporalContrast::from_calibration(&calibration, black_box(0.5))?);
    started(&TemporalContrast::try_new(value)?.try_with_step(value)?);
    started(&StepForward::try_new(value)?);
    let taps = Taps::try_new(black_box([value; 15]))?;
    started(&Bsa::try_new(taps, black_box(Criterion::Subtractive(value)))?);
    started(&Position::try_new(black_box([value; 20]))?);
    let mut histogram = black_box(Histogram::<S, 32>::try_new(value..=value, black_box(1000))?);
    histogram.observe(value);
    black_box((histogram.quantile(black_box(1), black_box(2)), histogram.rejected()));
    started(&Position::try_new(histogram.centres::<20>()?)?);
    surveyed(value)?;
    filtered(value)?;
    started(
        &Slots::<S, 15, 10>::try_new(value..=value, black_box(1.5))?
            .try_with_floor(black_box(2))?,
    );
    Ok(())
}

fn started<P: Start>(scheme: &P) {
    exercise::scheme(black_box(scheme));
}

/// Both filters before a scheme, one before the other, and by themselves.
fn filtered<S: Sample>(value: S) -> Result<(), ConfigError> {
    let [corner, rate, q] = black_box([40.0, 500.0, 2.0]);
    let low_pass = FirstOrder::try_low_pass(corner, rate)?;
    let notch = Biquad::try_notch(corner, rate, q)?;
    started(&notch.before(low_pass.before(StepForward::try_new(value)?)));
    black_box(Biquad::<S>::try_low_pass(corner, rate)?);
    let (filter, mut state) = black_box((notch, Biquad::<S>::START));
    let mut outputs = black_box([value; 5]);
    black_box(filter.filter_slice(&mut state, &black_box([value; 5]), &mut outputs));
    black_box((outputs, filter.filter(&mut state, value), filter.delay(), low_pass.delay()));
    Ok(())
}

fn surveyed<S: Sample>(value: S) -> Result<(), ConfigError> {
    let conditions = Conditions::try_new(black_box(4), value..=value, value)?;
    let mut survey =
        black_box(Survey::<S, 32>::new(conditions.try_with_stillness(black_box(value))?));
    survey.observe(value);
    if let Ok(fit) = survey.verdict() {
        started(&fit.step_forward(black_box(0.1))?);
        started(&fit.temporal_contrast(black_box(0.1))?);
        black_box((fit.moments().mean()?, fit.moments().deviation()?));
    }
    survey.reset();
    Ok(())
}
