//! `spikewire bench`: reproduces Tables I and II of Dupeyroux et al. (2022), the paper that many of the schemes come
//! from.

use crate::options::answer;
use crate::report::Report;
use anyhow::{Result, bail};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use lab::bench::{self, paper};
use std::time::Instant;

/// Reproduce Tables I and II of the paper, Dupeyroux et al. (2022), cell by cell; fails if a cell differs from the
/// paper's.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire bench
  spikewire bench --tests 100 --cases 3 --json")]
pub(crate) struct Bench {
    /// Number of signals of each length. The paper has 1000; with fewer signals, only larger differences are detected
    #[arg(long, default_value_t = paper::TESTS)]
    tests: usize,
    /// Number of signal lengths to run, 1 to 5, starting with the shortest
    #[arg(long, default_value_t = paper::CASES.len())]
    cases: usize,
    /// Seed of the noise in the signals
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print the figures as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
///
/// # Errors
/// Returns an error if an option is out of its range, or if a cell differs from the paper's.
pub(crate) fn run(options: &Bench) -> Result<()> {
    let &Bench { tests, cases, seed, json } = options;
    if !(2..=bench::MOST_TESTS).contains(&tests) {
        let most = bench::MOST_TESTS;
        bail!("--tests {tests} must lie in 2..={most}; a standard deviation takes 2");
    }
    let most = paper::CASES.len();
    if !(1..=most).contains(&cases) {
        bail!("--cases {cases} must lie in 1..={most}");
    }
    let samples: usize =
        paper::CASES[..cases].iter().map(|seconds| seconds * bench::signal::RATE * tests).sum();
    let bar = ProgressBar::new(samples as u64).with_style(ProgressStyle::with_template(
        "{bar:40} {percent:>3} %  {human_pos} of {human_len} samples, {eta} left",
    )?);
    let start = Instant::now();
    let results = bench::run(cases, tests, seed, |samples| bar.inc(samples));
    let seconds = start.elapsed().as_secs_f64();
    bar.finish_and_clear();
    say!(
        "{samples} samples through 8 schemes, there and back, in {seconds:.2} s on {} cores",
        rayon::current_num_threads()
    );
    if json {
        let summary = bench::json(&results, seed);
        Report::<(), _> { command: "bench", logs: &[], summary }.print()?;
    } else {
        answer(bench::print(&results))?;
    }
    let differing = bench::differing(&results);
    if !differing.is_empty() {
        bail!("not as in the paper: {}", differing.join("; "));
    }
    Ok(())
}
