//! The benchmark of the paper *A toolbox for neuromorphic perception in robotics*. It measures the efficiency and error
//! of each code, for the signals of the paper's Tables I and II. All signals of one duration form a case.

pub mod paper;
mod recipe;
mod report;
pub mod signal;
mod statistics;

pub use report::{differing, json, print};

use paper::CASES;
use rayon::prelude::*;
use recipe::{COLUMNS, Outcome};
use signal::Waveform;
use statistics::Statistics;

/// Maximum number of signals in a case of the benchmark. A case runs all schemes on signals of one duration.
pub const MOST_TESTS: usize = 1_000_000;

/// The results of one case: for each scheme, the statistics over all signals of the case.
pub struct CaseResult {
    /// Duration of the signals, in seconds.
    pub seconds: usize,
    /// Spiking efficiency in percent, for each scheme of the benchmark.
    pub efficiency: [Statistics; COLUMNS],
    /// Root mean square error, for each column of the table.
    pub rmse: [Statistics; COLUMNS],
}

/// Runs the first `cases` cases, with `tests` signals in each. After each signal, calls `tick` with the signal's number
/// of samples. Each signal has its own random generator, which makes the results independent of the number of cores.
pub fn run(cases: usize, tests: usize, seed: u64, tick: impl Fn(u64) + Sync) -> Vec<CaseResult> {
    let cases = CASES.iter().take(cases).enumerate();
    cases.map(|(case, &seconds)| run_case(case, seconds, tests, seed, &tick)).collect()
}

fn run_case(
    case: usize,
    seconds: usize,
    tests: usize,
    seed: u64,
    tick: &(impl Fn(u64) + Sync),
) -> CaseResult {
    let waveform = Waveform::new(seconds);
    let outcomes: Vec<[Outcome; COLUMNS]> = (0..tests)
        .into_par_iter()
        .map(|test| {
            let signal = waveform.with_noise(seed, (case * MOST_TESTS + test) as u64);
            let outcomes = recipe::run(&signal);
            tick(signal.len() as u64);
            outcomes
        })
        .collect();
    let of = |value: fn(&Outcome) -> f64| {
        std::array::from_fn(|column| {
            Statistics::new(outcomes.iter().map(|outcomes| value(&outcomes[column])))
        })
    };
    CaseResult {
        seconds,
        efficiency: of(|outcome| outcome.efficiency),
        rmse: of(|outcome| outcome.rmse),
    }
}
