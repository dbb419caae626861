//! How the paper's toolbox runs each scheme over a signal: its parameters, where its encoders start,
//! what its decoders do with the first spike, and the last sample.

use spikewire::population::{Centres, Gaussian, ReceptiveFields, Slots};
use spikewire::rate::{BenToolbox, Hough, Taps, ThresholdHough};
use spikewire::temporal::{MovingWindow, StepDecoder, StepForward, TemporalContrast};
use spikewire::{Calibration, Code, ConfigError, Decoder, Encoder, Output, Scheme, Spike};

/// The schemes of the tables, and GRF and GRF with slots, of which the paper gives no figures.
pub(super) const COLUMNS: usize = 8;

/// What a scheme made of a signal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outcome {
    /// `(1 - spikes / samples) * 100`. Below 0 where there are more spikes than samples.
    pub efficiency: f64,
    /// Between the signal and what was decoded.
    pub rmse: f64,
}

static TRIANGULAR_9: Taps<f32, 9> = Taps::<f32, _>::triangular(1.0);
static TRIANGULAR_15: Taps<f32, 15> = Taps::<f32, _>::triangular(1.0);

const CONTRAST_FACTOR: f32 = 0.5;
const WINDOW: usize = 5 + 1;
const MOVING_WINDOW: MovingWindow<f32, WINDOW> = MovingWindow::<f32, _>::checked(0.25);
const STEP_FORWARD: StepForward<f32> = StepForward::<f32>::checked(0.5);
const BEN: BenToolbox<f32, 9> = BenToolbox::<f32, _>::checked(&TRIANGULAR_9, 1.15);
const HOUGH: Hough<f32, 15> = Hough::new(&TRIANGULAR_15);
const THRESHOLD_HOUGH: ThresholdHough<f32, 15> =
    ThresholdHough::<f32, _>::checked(&TRIANGULAR_15, 0.85);
const BETA: f32 = 1.5;

/// Runs all schemes, in the order of the columns.
///
/// # Panics
/// If the signal is shorter than a window or never moves, which those of the benchmark do.
#[expect(clippy::expect_used, reason = "the signals are the benchmark's own")]
pub(super) fn run(signal: &[f32]) -> [Outcome; COLUMNS] {
    try_run(signal).expect("the benchmark's signals rise and fall")
}

fn try_run(signal: &[f32]) -> Result<[Outcome; COLUMNS], ConfigError> {
    let mut calibration = Calibration::new();
    for &sample in signal {
        calibration.observe(sample);
    }
    let (min, max) = (calibration.min().unwrap_or(0.0), calibration.max().unwrap_or(0.0));
    Ok([
        contrast(signal, &calibration)?,
        moving_window(signal),
        step_forward(signal),
        rate(signal, BEN.with_shift(min)?),
        rate_but_last(signal, HOUGH.with_shift(min)?, Spike::None),
        rate_but_last(signal, THRESHOLD_HOUGH.with_shift(min)?, Spike::Up),
        population(signal, Gaussian::new(&Centres::<f32, 20>::new_linear(min, max)?)),
        population(signal, Slots::new(&ReceptiveFields::<f32, 15, 10>::new(min, max, BETA)?)),
    ])
}

/// Primed so that the first difference counts twice; decoded from 0 in steps of two thresholds.
fn contrast(signal: &[f32], calibration: &Calibration<f32>) -> Result<Outcome, ConfigError> {
    let threshold = TemporalContrast::from_calibration(calibration, CONTRAST_FACTOR)?.threshold();
    let scheme = TemporalContrast::with_step(threshold, 2.0 * threshold)?;
    let mut encoder = scheme.encoder();
    if let [first, second, ..] = signal {
        encoder.prime(first - (second - first));
    }
    Ok(step_outcome(signal, encoder, scheme.decoder(), 0.0))
}

/// Primed with the first window; decoded from the first sample.
fn moving_window(signal: &[f32]) -> Outcome {
    let mut encoder = MOVING_WINDOW.encoder();
    if let Some(window) = signal.first_chunk() {
        encoder.prime(window);
    }
    step_outcome(signal, encoder, MOVING_WINDOW.decoder(), first(signal))
}

fn step_forward(signal: &[f32]) -> Outcome {
    step_outcome(signal, STEP_FORWARD.encoder(), STEP_FORWARD.decoder(), first(signal))
}

fn first(signal: &[f32]) -> f32 {
    signal.first().copied().unwrap_or_default()
}

/// The toolbox's step decoders set the first value and add from the second spike on.
fn step_outcome(
    signal: &[f32],
    mut encoder: impl Encoder<Sample = f32, Output = Spike>,
    mut decoder: StepDecoder<f32>,
    start: f32,
) -> Outcome {
    let spikes: Vec<Spike> = signal.iter().map(|&sample| encoder.encode(sample)).collect();
    decoder.resync(start);
    let later = spikes.iter().skip(1).map(|&spike| decoder.decode(spike));
    let error = rmse(signal, std::iter::once(start).chain(later));
    outcome(signal, count(&spikes), error)
}

fn rate<S>(signal: &[f32], scheme: S) -> Outcome
where
    S: Scheme<Sample = f32, Encoder: Encoder<Sample = f32, Output = Option<Spike>>>,
{
    let spikes = rate_spikes(signal, scheme);
    let mut decoder = scheme.decoder();
    let error = rmse(signal, spikes.iter().map(|&spike| decoder.decode(spike)));
    outcome(signal, count(&spikes), error)
}

/// The last sample takes no part in the windows of the toolbox, whose loops end one too early.
fn rate_but_last<S>(signal: &[f32], scheme: S, last: Spike) -> Outcome
where
    S: Scheme<Sample = f32, Encoder: Encoder<Sample = f32, Output = Option<Spike>>>,
{
    let mut spikes = rate_spikes(&signal[..signal.len() - 1], scheme);
    spikes.push(last);
    let mut decoder = scheme.decoder();
    let error = rmse(signal, spikes.iter().map(|&spike| decoder.decode(spike)));
    outcome(signal, count(&spikes), error)
}

fn rate_spikes<S>(signal: &[f32], scheme: S) -> Vec<Spike>
where
    S: Scheme<Sample = f32, Encoder: Encoder<Sample = f32, Output = Option<Spike>>>,
{
    let mut encoder = scheme.encoder();
    let mut spikes: Vec<Spike> =
        signal.iter().filter_map(|&sample| encoder.encode(sample)).collect();
    spikes.extend(encoder.finish());
    spikes
}

fn population<S>(signal: &[f32], scheme: S) -> Outcome
where
    S: Scheme<Sample = f32>,
{
    let (mut encoder, mut decoder) = (scheme.encoder(), scheme.decoder());
    let mut spikes = 0;
    let values = signal.iter().filter_map(|&sample| encoder.encode(sample).code()).map(|code| {
        spikes += code.firings().count();
        decoder.decode(code)
    });
    let error = rmse(signal, values);
    outcome(signal, spikes, error)
}

fn count(spikes: &[Spike]) -> usize {
    spikes.iter().filter(|spike| spike.is_fired()).count()
}

fn rmse(signal: &[f32], decoded: impl Iterator<Item = f32>) -> f64 {
    let squares = signal.iter().zip(decoded).map(|(&x, y)| (f64::from(x) - f64::from(y)).powi(2));
    (squares.sum::<f64>() / signal.len() as f64).sqrt()
}

fn outcome(signal: &[f32], spikes: usize, rmse: f64) -> Outcome {
    Outcome { efficiency: (1.0 - spikes as f64 / signal.len() as f64) * 100.0, rmse }
}
