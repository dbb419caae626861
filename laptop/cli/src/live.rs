//! A status line on the terminal, which shows counts and rates of events while they arrive.

use indicatif::{ProgressBar, ProgressStyle};
use lab::events::Stream;
use std::fmt::Write;
use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

/// Time between two updates of the status line.
const PERIOD: Duration = Duration::from_millis(500);
/// Maximum number of addresses whose event rates are shown.
const ADDRESSES: usize = 6;

/// A status line on standard error. The line is hidden if standard error is no terminal. It is also hidden if the
/// command's output goes to a terminal.
pub(crate) struct Live {
    line: Option<ProgressBar>,
    shown: Instant,
    /// Number of events of each address at the last update.
    counts: Vec<u64>,
    bytes: u64,
}

impl Live {
    /// Creates a status line without text. Set `is_output_shown` if the command's output goes to standard output.
    pub(crate) fn new(is_output_shown: bool) -> Self {
        let is_wanted =
            io::stderr().is_terminal() && !(is_output_shown && io::stdout().is_terminal());
        let line = is_wanted.then(|| {
            let line = ProgressBar::new_spinner().with_style(style());
            line.enable_steady_tick(PERIOD / 4);
            line
        });
        Self { line, shown: Instant::now(), counts: Vec::new(), bytes: 0 }
    }

    /// Updates the counts on the terminal if at least [`PERIOD`] has passed since the last update.
    pub(crate) fn update(&mut self, stream: &Stream) {
        let elapsed = self.shown.elapsed();
        if let Some(line) = self.line.as_ref().filter(|_| elapsed >= PERIOD) {
            line.set_message(self.message(stream, elapsed.as_secs_f64()));
            self.shown = Instant::now();
            self.counts = stream.addresses().to_vec();
            self.bytes = stream.bytes();
        }
    }

    /// Removes the line from the terminal.
    pub(crate) fn clear(&self) {
        if let Some(line) = &self.line {
            line.finish_and_clear();
        }
    }

    fn message(&self, stream: &Stream, seconds: f64) -> String {
        let before = self.counts.iter().copied().chain(std::iter::repeat(0));
        let mut rates: Vec<(usize, u64)> = stream
            .addresses()
            .iter()
            .zip(before)
            .map(|(now, before)| now - before)
            .enumerate()
            .filter(|(_, count)| *count > 0)
            .collect();
        let total: u64 = rates.iter().map(|(_, count)| count).sum();
        rates.sort_by_key(|&(_, count)| std::cmp::Reverse(count));
        rates.truncate(ADDRESSES);
        rates.sort_unstable();

        let rate = |count: u64| (count as f64 / seconds).round();
        let mut text = format!("{} events, {}/s", stream.count(), rate(total));
        for (address, count) in rates {
            let _ = write!(text, " {address}:{}", rate(count));
        }
        if total > 0 {
            let bytes = (stream.bytes() - self.bytes) as f64;
            let _ = write!(text, "; {:.2} bytes each", bytes / total as f64);
        }
        let tally = stream.tally();
        if let Some(link) = tally.link {
            let (frames, lost, gaps) = (link.frames, link.lost, link.gaps);
            let _ = write!(text, "; {frames} frames, {lost} lost in {gaps} gaps");
        }
        let _ = write!(text, "; {} bytes skipped", tally.skipped);
        text
    }
}

fn style() -> ProgressStyle {
    ProgressStyle::with_template("{spinner} {elapsed} {wide_msg}")
        .unwrap_or_else(|_| ProgressStyle::default_spinner())
}
