//! Runs each scheme over a signal as the toolbox of the paper *A toolbox for neuromorphic perception in robotics* does.
//! The parameters and start values are those of the toolbox. The first spike and the last sample are treated as in the
//! toolbox.

use spikewire::population::{Gaussian, Slots};
use spikewire::rate::{BsaToolbox, Hough, Taps, ThresholdHough};
use spikewire::temporal::{MovingWindow, StepForward, TemporalContrast};
use spikewire::{Calibration, Code, ConfigError, Output, Spike, Start};

/// Number of columns: one for each scheme of the paper's tables, and two for Gaussian receptive fields (GRF), without
/// and with slots (sub-timesteps). The paper gives no figures for the last two columns.
pub(super) const COLUMNS: usize = 8;

/// The efficiency and error of a scheme on a signal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outcome {
    /// `(1 - spikes / samples) * 100`; below 0 if there are more spikes than samples.
    pub efficiency: f64,
    /// The root mean square error between the signal and the decoded values.
    pub rmse: f64,
}

const CONTRAST_FACTOR: f32 = 0.5;
const WINDOW: usize = 5 + 1;
const MOVING_WINDOW: MovingWindow<f32, WINDOW> = MovingWindow::new(0.25);
const STEP_FORWARD: StepForward<f32> = StepForward::new(0.5);
const BSA: BsaToolbox<f32, 9> = BsaToolbox::new(Taps::triangular(1.0), 1.15);
const HOUGH: Hough<f32, 15> = Hough::new(Taps::triangular(1.0));
const THRESHOLD_HOUGH: ThresholdHough<f32, 15> = ThresholdHough::new(Taps::triangular(1.0), 0.85);
const BETA: f32 = 1.5;

/// Runs all schemes over a signal. The results have the order of the columns of the paper's tables. The two results for
/// Gaussian receptive fields follow.
///
/// # Panics
/// Panics if the signal is shorter than a window, or constant. The benchmark's signals are neither.
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
        rate(signal, &BSA.try_with_shift(min)?),
        rate_but_last(signal, &HOUGH.try_with_shift(min)?, Spike::None),
        rate_but_last(signal, &THRESHOLD_HOUGH.try_with_shift(min)?, Spike::Up),
        population(signal, &Gaussian::<f32, 20>::try_linear(min..=max)?),
        population(signal, &Slots::<f32, 15, 10>::try_new(min..=max, BETA)?),
    ])
}

/// Runs temporal contrast over a signal. The encoder is primed with an extra sample before the signal. From the extra
/// sample to the first sample, the signal changes by as much as from the first to the second. Decoding starts from 0,
/// and each spike moves the value by two thresholds.
fn contrast(signal: &[f32], calibration: &Calibration<f32>) -> Result<Outcome, ConfigError> {
    let threshold = TemporalContrast::from_calibration(calibration, CONTRAST_FACTOR)?.threshold();
    let scheme = TemporalContrast::try_new(threshold)?.try_with_step(2.0 * threshold)?;
    let before = match signal {
        [first, second, ..] => vec![first - (second - first)],
        _ => Vec::new(),
    };
    Ok(step_outcome(signal, &scheme, &before, 0.0))
}

/// Runs the moving-window scheme over a signal. Before the run, the encoder's window is filled with the signal's first
/// samples. Decoding starts from the value of the first sample.
fn moving_window(signal: &[f32]) -> Outcome {
    let window = signal.get(..WINDOW).unwrap_or_default();
    step_outcome(signal, &MOVING_WINDOW, window, first(signal))
}

fn step_forward(signal: &[f32]) -> Outcome {
    step_outcome(signal, &STEP_FORWARD, &[], first(signal))
}

fn first(signal: &[f32]) -> f32 {
    signal.first().copied().unwrap_or_default()
}

/// Runs a step code (each spike moves the decoded value by one step) as the paper's toolbox does. Primes the encoder
/// with `past`. The first decoded value is `start`. From the second sample on, the decoder adds the steps.
fn step_outcome<P>(signal: &[f32], scheme: &P, past: &[f32], start: f32) -> Outcome
where
    P: Start<Sample = f32, Code = Spike, Output = Spike>,
{
    let (mut encoder, mut decoder) = (scheme.encoder(), scheme.decoder());
    encoder.prime(past);
    let spikes: Vec<Spike> = signal.iter().map(|&sample| encoder.encode(sample)).collect();
    decoder.resync(start);
    let later = spikes.iter().skip(1).map(|&spike| decoder.decode(spike));
    let error = rmse(signal, std::iter::once(start).chain(later));
    outcome(signal, count(&spikes), error)
}

fn rate<P>(signal: &[f32], scheme: &P) -> Outcome
where
    P: Start<Sample = f32, Code = Spike, Output = Option<Spike>>,
{
    let spikes = rate_spikes(signal, scheme);
    let mut decoder = scheme.decoder();
    let error = rmse(signal, spikes.iter().map(|&spike| decoder.decode(spike)));
    outcome(signal, count(&spikes), error)
}

/// Runs a rate code as the paper's toolbox does. The toolbox's loops end one sample early, and thus never read the last
/// sample. The last sample therefore always gets the spike `last`.
fn rate_but_last<P>(signal: &[f32], scheme: &P, last: Spike) -> Outcome
where
    P: Start<Sample = f32, Code = Spike, Output = Option<Spike>>,
{
    let mut spikes = rate_spikes(&signal[..signal.len() - 1], scheme);
    spikes.push(last);
    let mut decoder = scheme.decoder();
    let error = rmse(signal, spikes.iter().map(|&spike| decoder.decode(spike)));
    outcome(signal, count(&spikes), error)
}

fn rate_spikes<P>(signal: &[f32], scheme: &P) -> Vec<Spike>
where
    P: Start<Sample = f32, Code = Spike, Output = Option<Spike>>,
{
    let mut encoder = scheme.encoder();
    let mut spikes: Vec<Spike> =
        signal.iter().filter_map(|&sample| encoder.encode(sample)).collect();
    spikes.extend(encoder.finish());
    spikes
}

fn population<P>(signal: &[f32], scheme: &P) -> Outcome
where
    P: Start<Sample = f32>,
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
