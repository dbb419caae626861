//! Reads one channel of a recording in pieces, in constant memory, as often as it is needed.

use crate::Result;
use crate::input::{CHUNK, Chunk, Clock, InputOptions, Kind, TableKind};
use crate::measure::Measure;
use crate::scheme::Scheme;
use crate::trial::notes;
use catalogue::run::{Asked, Calibrated, SampleType, Words};
use rayon::prelude::*;

/// Consecutive samples of one segment.
#[cfg_attr(target_family = "wasm", allow(dead_code, reason = "only pictures ask for times"))]
pub(crate) struct Piece<'a> {
    /// The finite samples.
    pub(crate) values: &'a [f64],
    /// Times of the finite samples in µs, as recorded. Empty if no times were recorded.
    pub(crate) times: &'a [i64],
    /// Times of all samples, finite or not.
    pub(crate) all_times: &'a [i64],
    /// Whether the segment ends after these samples.
    pub(crate) is_end: bool,
}

/// Summary of a recording after a pass over it.
pub(crate) struct Passed {
    /// Name of the channel.
    pub(crate) channel: String,
    /// Notes for the user on the recording.
    pub(crate) notes: Vec<Words>,
    /// Number of finite samples.
    pub(crate) samples: usize,
    /// Number of samples, finite or not.
    rows: usize,
    clock: Clock,
    is_timed: bool,
}

impl Passed {
    /// Returns the sample rate in Hz, if it is known.
    pub(crate) fn rate(&self) -> Option<f64> {
        self.clock.rate()
    }

    /// Returns the usual time between samples in µs, or 0 if it is unknown.
    #[cfg(not(target_family = "wasm"))]
    pub(crate) fn period(&self) -> i64 {
        self.clock.period()
    }

    /// Returns the duration in seconds, if it is known. The unknown time between segments is left out.
    pub(crate) fn seconds(&self) -> Option<f64> {
        if self.is_timed {
            return Some(self.clock.seconds());
        }
        self.rate().map(|rate| self.samples as f64 / rate)
    }
}

/// Reads a channel from its start to its end, and hands its samples to `take`. The usual step of the times, by which
/// gaps and restarts of the clock are found, is that of the first [`CHUNK`] samples.
///
/// # Errors
/// Returns an error if the input cannot be read, or has several channels.
pub(crate) fn pass(input: &InputOptions, mut take: impl FnMut(&Piece)) -> Result<Passed> {
    input.single("this command")?;
    let (mut source, mut chunk) = (input.open()?, Chunk::default());
    InputOptions::check_single(&*source, "this command")?;
    source.next(&mut chunk)?;
    let mut clock = Clock::new(&chunk.times, input.rate, input.gap);
    let is_timed = !chunk.times.is_empty();
    let (mut read, mut samples) = (0, 0);
    while !chunk.is_empty() {
        let rows = chunk.finite_rows();
        let column = chunk.columns.first().map_or(&[][..], Vec::as_slice);
        let mut start = 0;
        let steps = clock.observe(&chunk.times);
        let restarts = steps.iter().filter(|step| step.kind == Kind::Restart);
        let ends = restarts.map(|step| ((step.after + 1 - read) as usize, true));
        for (end, is_end) in ends.chain([(rows.len(), false)]) {
            let all_times = chunk.times.get(start..end).unwrap_or_default();
            let values = finite(&column[start..end], &rows[start..end]);
            let times = finite(all_times, &rows[start..end]);
            samples += values.len();
            take(&Piece { values: &values, times: &times, all_times, is_end });
            start = end;
        }
        read += rows.len() as u64;
        source.next(&mut chunk)?;
    }
    take(&Piece { values: &[], times: &[], all_times: &[], is_end: true });
    let rows = read as usize;
    Ok(Passed {
        channel: source.names().first().copied().unwrap_or_default().to_owned(),
        notes: notes(source.notes(), rows - samples, &clock),
        samples,
        rows,
        clock,
        is_timed,
    })
}

/// Returns the items in the rows for which `rows` is true.
fn finite<T: Copy>(all: &[T], rows: &[bool]) -> Vec<T> {
    all.iter().zip(rows).filter(|(_, row)| **row).map(|(item, _)| *item).collect()
}

/// Results of a first pass over a recording: what [`Measure`] must know of the whole.
pub(crate) struct First {
    calibrated: Calibrated,
    mean: f64,
    /// The first finite samples.
    values: Vec<f64>,
}

impl First {
    /// Reads the recording for `schemes`; hands its samples to `take` as well.
    ///
    /// # Errors
    /// Returns an error if the input cannot be read, has several channels, or has no finite sample.
    pub(crate) fn read(
        input: &InputOptions,
        schemes: &[Scheme],
        asked: &Asked,
        sample: SampleType,
        mut take: impl FnMut(&Piece),
    ) -> Result<(Self, Passed)> {
        let looks_back = schemes.iter().map(|scheme| scheme.looks_back(asked)).max().unwrap_or(0);
        let mut calibrated = Calibrated::of(sample, asked);
        let (mut values, mut sum) = (Vec::new(), 0.0);
        let passed = pass(input, |piece| {
            calibrated.observe(piece.values);
            sum = piece.values.iter().fold(sum, |sum, value| sum + value);
            let missing = looks_back.max(CHUNK).saturating_sub(values.len());
            values.extend(piece.values.iter().take(missing));
            take(piece);
        })?;
        if values.is_empty() {
            return Err(TableKind::NoneFinite { samples: passed.rows }.at(input.name()));
        }
        let mean = sum / passed.samples as f64;
        Ok((Self { calibrated, mean, values }, passed))
    }

    /// Makes a measurement of the recording by a scheme.
    ///
    /// # Errors
    /// Returns an error if a parameter is invalid.
    pub(crate) fn measure(
        &self,
        scheme: Scheme,
        asked: &Asked,
        sample: SampleType,
    ) -> Result<Measure<'_>> {
        Measure::new(scheme, asked, sample, (&self.calibrated, self.mean), &self.values)
    }
}

/// Calls `work` on everything that has not failed, in parallel.
pub(crate) fn each<T: Send>(all: &mut [Result<T>], work: impl Fn(&mut T) -> Result<()> + Sync) {
    all.par_iter_mut().for_each(|own| {
        if let Ok(item) = own
            && let Err(error) = work(item)
        {
            *own = Err(error);
        }
    });
}
