//! Reduces a recording, and the spikes and decoded values of schemes, to what a picture shows.

use super::decimate::{Line, Point};
use super::layout;
use crate::Result;
use crate::input::InputOptions;
use crate::measure::Measure;
use crate::passes::{First, Piece, each, pass};
use crate::scheme::Scheme;
use crate::trial::{Recording, Trial};
use crate::unit::unit_of_name;
use catalogue::run::{Asked, Event, SampleType, Settings, Shape, Words};
use spikewire::Polarity;
use std::collections::HashSet;
use std::ops::Range;

/// A recording and the trials of schemes on this recording, reduced to the pixels of a picture.
pub struct Picture {
    /// The unit of the signal, if it is known. The constructors take it from the channel's name.
    pub unit: Option<String>,
    pub(super) name: String,
    pub(super) axis: Axis,
    /// Number of segments of the whole recording.
    pub(super) segments: usize,
    pub(super) signal: Curve,
    pub(super) panels: Vec<Panel>,
    /// Whether the panels stand in a grid. Otherwise there is one panel.
    pub(super) is_grid: bool,
}

impl Picture {
    /// Reduces a recording in memory and its trials, one for each panel. `shown` is the range of the samples to show,
    /// by index.
    pub fn of(recording: &Recording, trials: &[Trial], shown: Range<usize>) -> Self {
        let Recording { values, times, segments, rate, name, .. } = recording;
        let is_grid = trials.len() != 1;
        let at = |sample: usize| (sample, times.get(sample).copied());
        let mut spans = Spans::of(shown);
        // In memory, the times of the segments follow each other already.
        spans.take(&Piece { values, times, all_times: times, is_end: true });
        let axis = spans.axis(*rate, &[0], is_grid);
        let mut signal = Curve::default();
        let mut panels: Vec<Panel> = trials
            .iter()
            .map(|trial| Panel {
                latency: trial.latency,
                efficiency: trial.efficiency(),
                ..Panel::new(trial.scheme, trial.settings.clone(), trial.shape)
            })
            .collect();
        for segment in segments {
            for own in segment.clone() {
                signal.add(&axis, at(own), values[own]);
            }
            signal.end_segment();
            for (panel, trial) in panels.iter_mut().zip(trials) {
                for own in segment.clone() {
                    panel.decoded.add(&axis, at(own), trial.decoded[own]);
                }
                panel.decoded.end_segment();
            }
        }
        for (panel, trial) in panels.iter_mut().zip(trials) {
            trial.events.iter().for_each(|own| panel.spike(&axis, own, at(own.sample as usize)));
        }
        let (name, unit) = (name.clone(), recording.unit().map(str::to_owned));
        Self { unit, name, axis, segments: segments.len(), signal, panels, is_grid }
    }
}

/// A picture of a file, and notes for the user.
pub struct Read {
    /// The picture, with a panel for each scheme that can encode the recording.
    pub picture: Picture,
    /// Number of finite samples of the recording.
    pub samples: usize,
    /// Notes for the user on the recording.
    pub notes: Vec<Words>,
    /// Notes on each scheme, or the reason that the scheme cannot encode the recording.
    pub schemes: Vec<(Scheme, Result<Vec<String>>)>,
}

/// Reads one channel of a recording for a picture. The file is read twice, in constant memory, as by
/// [`score`](crate::score::score); standard input and pipes are held in memory, and give the same picture. `shown` is
/// the range of the samples to show; `None` shows all.
///
/// # Errors
/// Returns an error if the input cannot be read, has several channels, or has no finite sample.
pub fn read(
    input: &InputOptions,
    schemes: &[Scheme],
    asked: &Asked,
    sample: SampleType,
    shown: Option<Range<usize>>,
) -> Result<Read> {
    if input.is_read_once() {
        return read_once(input, schemes, asked, sample, shown);
    }
    let mut spans = Spans::of(shown.unwrap_or(0..usize::MAX));
    let (first, passed) = First::read(input, schemes, asked, sample, |own| spans.take(own))?;
    let mut all: Vec<Result<Streamed>> = schemes
        .iter()
        .map(|scheme| Streamed::new(*scheme, first.measure(*scheme, asked, sample)?))
        .collect();
    let is_grid = all.iter().filter(|own| own.is_ok()).count() != 1;
    let shifts = spans.shifts(passed.period());
    let axis = spans.axis(passed.rate(), &shifts, is_grid);
    let (mut signal, mut samples) = (Curve::default(), 0);
    let mut shift = shifts.iter();
    let mut own_shift = shift.next().copied().unwrap_or(0);
    pass(input, |piece| {
        let times: Vec<i64> =
            piece.times.iter().map(|time| time.saturating_add(own_shift)).collect();
        for (place, value) in piece.values.iter().enumerate() {
            signal.add(&axis, (samples + place, times.get(place).copied()), *value);
        }
        samples += piece.values.len();
        each(&mut all, |own| own.observe(&axis, piece, &times));
        if piece.is_end {
            signal.end_segment();
            own_shift = shift.next().copied().unwrap_or(0);
        }
    })?;
    let (mut panels, mut notes) = (Vec::new(), Vec::new());
    for (scheme, own) in schemes.iter().zip(all) {
        let told = own.map(|own| {
            panels.push(Panel {
                latency: own.measure.latency(),
                efficiency: own.measure.sums().efficiency(),
                ..own.panel
            });
            own.measure.notes()
        });
        notes.push((*scheme, told));
    }
    let segments = spans.segments.iter().filter(|own| own.samples > 0).count();
    let unit = unit_of_name(&passed.channel).map(str::to_owned);
    let name = passed.channel;
    let picture = Picture { unit, name, axis, segments, signal, panels, is_grid };
    Ok(Read { picture, samples, notes: passed.notes, schemes: notes })
}

/// Reads a recording that can be read only once.
fn read_once(
    input: &InputOptions,
    schemes: &[Scheme],
    asked: &Asked,
    sample: SampleType,
    shown: Option<Range<usize>>,
) -> Result<Read> {
    let recording = Recording::read(input)?;
    let samples = recording.values.len();
    let shown = shown.unwrap_or(0..samples);
    let (mut trials, mut notes) = (Vec::new(), Vec::new());
    for scheme in schemes {
        let trial = Trial::new(*scheme, asked, sample, &recording).map(|trial| {
            let notes = trial.notes.clone();
            trials.push(trial);
            notes
        });
        notes.push((*scheme, trial));
    }
    let picture = Picture::of(&recording, &trials, shown);
    Ok(Read { picture, samples, notes: recording.notes(), schemes: notes })
}

/// A scheme on a recording that is being read, and its panel.
struct Streamed<'a> {
    measure: Measure<'a>,
    panel: Panel,
    /// Number of decoded samples.
    done: usize,
    /// Times of the samples that are not decoded yet; empty if no times were recorded.
    times: Vec<i64>,
}

impl<'a> Streamed<'a> {
    fn new(scheme: Scheme, measure: Measure<'a>) -> Result<Self> {
        let settings = measure.settings().clone();
        let shape = scheme.shape(&settings)?;
        let panel = Panel::new(scheme, settings, shape);
        Ok(Self { measure, panel, done: 0, times: Vec::new() })
    }

    /// Encodes and decodes the next samples. `times` are those of the time axis.
    fn observe(&mut self, axis: &Axis, piece: &Piece, times: &[i64]) -> Result<()> {
        let Self { measure, panel, done, times: pending, .. } = self;
        pending.extend_from_slice(times);
        let mut take = |events: &[Event], decoded: &[f64]| {
            let at = |sample: usize| (sample, pending.get(sample - *done).copied());
            for (sample, value) in (*done..).zip(decoded) {
                panel.decoded.add(axis, at(sample), *value);
            }
            for event in events {
                panel.spike(axis, event, at(event.sample as usize));
            }
            *done += decoded.len();
            pending.drain(..decoded.len().min(pending.len()));
        };
        measure.observe(piece.values, &mut take)?;
        if piece.is_end {
            measure.end_segment(&mut take)?;
            panel.decoded.end_segment();
        }
        Ok(())
    }
}

/// The time axis of a picture.
pub(super) struct Axis {
    /// Time of the recording's first sample in µs, if times were recorded.
    first: Option<i64>,
    /// Sample rate in Hz, if it is known.
    pub(super) rate: Option<f64>,
    /// The samples that are shown, by index.
    pub(super) shown: Range<usize>,
    /// The earliest and the latest position that is shown.
    pub(super) range: Range<f64>,
    /// Distance between the first two samples of the recording, or 0 if they are out of order.
    pub(super) step: f64,
    /// Number of columns of pixels.
    columns: u32,
}

impl Axis {
    /// Returns the position of a sample: seconds from the start, or the sample's index if neither times nor a rate are
    /// known. `time` is in µs.
    fn at(&self, (sample, time): (usize, Option<i64>)) -> f64 {
        match (time, self.first, self.rate) {
            (Some(time), Some(first), _) => time.saturating_sub(first) as f64 * 1e-6,
            (_, _, Some(rate)) => sample as f64 / rate,
            _ => sample as f64,
        }
    }

    /// Returns the column of pixels in which a position lies.
    fn column(&self, x: f64) -> i64 {
        let width = self.range.end - self.range.start;
        if width > 0.0 {
            ((x - self.range.start) / width * f64::from(self.columns)) as i64
        } else {
            0
        }
    }
}

/// The earliest and the latest of some times, in µs.
#[derive(Clone, Copy)]
struct Span(i64, i64);

impl Span {
    /// Extends the span to hold a time.
    fn with(own: Option<Self>, time: i64) -> Self {
        own.map_or(Self(time, time), |Self(first, last)| Self(first.min(time), last.max(time)))
    }

    /// Extends the span to hold some times.
    fn of(own: Option<Self>, times: impl IntoIterator<Item = i64>) -> Option<Self> {
        times.into_iter().fold(own, |own, time| Some(Self::with(own, time)))
    }
}

/// Times of a segment.
#[derive(Default)]
struct Segment {
    /// Number of finite samples.
    samples: usize,
    all: Option<Span>,
    shown: Option<Span>,
}

/// What the time axis depends on, found by a first pass.
struct Spans {
    shown: Range<usize>,
    samples: usize,
    /// The segments; the last one is not complete.
    segments: Vec<Segment>,
    /// Segment and time of the first two finite samples.
    first: Vec<(usize, i64)>,
}

impl Spans {
    fn of(shown: Range<usize>) -> Self {
        Self { shown, samples: 0, segments: vec![Segment::default()], first: Vec::new() }
    }

    fn take(&mut self, piece: &Piece) {
        let number = self.segments.len() - 1;
        let missing = 2 - self.first.len();
        self.first.extend(piece.times.iter().take(missing).map(|time| (number, *time)));
        let own = &mut self.segments[number];
        own.all = Span::of(own.all, piece.all_times.iter().copied());
        let shown = (self.samples..).zip(piece.times).filter(|(own, _)| self.shown.contains(own));
        own.shown = Span::of(own.shown, shown.map(|(_, time)| *time));
        own.samples += piece.values.len();
        self.samples += piece.values.len();
        if piece.is_end {
            self.segments.push(Segment::default());
        }
    }

    /// Returns for each segment the shift in µs that sets its earliest time to the latest time of the preceding segment
    /// plus `period`, as in a [`Recording`].
    fn shifts(&self, period: i64) -> Vec<i64> {
        let mut latest: Option<i64> = None;
        let shift = |own: &Segment| {
            let Some(Span(first, last)) = own.all else { return 0 };
            let follow = |latest: i64| latest.saturating_add(period).saturating_sub(first);
            let shift = latest.map_or(0, follow);
            latest = Some(last.saturating_add(shift));
            shift
        };
        self.segments.iter().map(shift).collect()
    }

    /// Returns the time axis. `shifts` are those of the segments.
    fn axis(&self, rate: Option<f64>, shifts: &[i64], is_grid: bool) -> Axis {
        let shifted = |(segment, time): (usize, i64)| {
            time.saturating_add(shifts.get(segment).copied().unwrap_or(0))
        };
        let first: Vec<i64> = self.first.iter().copied().map(shifted).collect();
        let shown = self.shown.start..self.shown.end.min(self.samples);
        let mut axis = Axis {
            first: first.first().copied(),
            rate,
            range: 0.0..0.0,
            step: 0.0,
            columns: layout::columns(is_grid),
            shown,
        };
        axis.step = axis.at((1, first.get(1).copied())) - axis.at((0, first.first().copied()));
        axis.step = axis.step.max(0.0);
        let times = self.segments.iter().enumerate().filter_map(|(number, own)| {
            own.shown.map(|Span(first, last)| [first, last].map(|time| shifted((number, time))))
        });
        let times = Span::of(None, times.flatten());
        let Range { start, end } = axis.shown;
        axis.range = match times {
            Some(Span(first, last)) => axis.at((start, Some(first)))..axis.at((start, Some(last))),
            None => axis.at((start, None))..axis.at((end.saturating_sub(1), None)),
        };
        axis
    }
}

/// A curve that is reduced, as its points come, to the pixels of a picture.
pub(super) struct Curve {
    /// A line for each segment.
    pub(super) lines: Vec<Vec<Point>>,
    line: Line,
    /// The lowest and the highest value that is shown.
    pub(super) bounds: (f64, f64),
}

impl Default for Curve {
    fn default() -> Self {
        Self { lines: Vec::new(), line: Line::default(), bounds: (f64::MAX, f64::MIN) }
    }
}

impl Curve {
    /// Adds the next value, at a sample with its time in µs.
    fn add(&mut self, axis: &Axis, sample: (usize, Option<i64>), value: f64) {
        if axis.shown.contains(&sample.0) {
            let x = axis.at(sample);
            self.line.add(axis.column(x), (x, value));
            self.bounds = (self.bounds.0.min(value), self.bounds.1.max(value));
        }
    }

    fn end_segment(&mut self) {
        let line = std::mem::take(&mut self.line).end();
        if !line.is_empty() {
            self.lines.push(line);
        }
    }
}

/// A spike in a picture.
pub(super) struct Spike {
    pub(super) x: f64,
    pub(super) neuron: u16,
    pub(super) is_up: bool,
}

/// A scheme's spikes and decoded values, reduced to the pixels of a picture.
pub(super) struct Panel {
    pub(super) scheme: Scheme,
    pub(super) settings: Settings,
    pub(super) shape: Shape,
    pub(super) latency: usize,
    /// Spiking efficiency of the whole recording, in percent.
    pub(super) efficiency: f64,
    pub(super) decoded: Curve,
    /// Number of spikes of the samples that are shown.
    pub(super) count: usize,
    /// The spikes to draw. Spikes of one neuron in one column of pixels share a stroke.
    pub(super) spikes: Vec<Spike>,
    drawn: HashSet<(i64, u16, bool)>,
}

impl Panel {
    fn new(scheme: Scheme, settings: Settings, shape: Shape) -> Self {
        Self {
            scheme,
            settings,
            shape,
            latency: 0,
            efficiency: 0.0,
            decoded: Curve::default(),
            count: 0,
            spikes: Vec::new(),
            drawn: HashSet::new(),
        }
    }

    /// Adds a spike, of a sample with its time in µs.
    fn spike(&mut self, axis: &Axis, event: &Event, sample: (usize, Option<i64>)) {
        if !axis.shown.contains(&sample.0) {
            return;
        }
        self.count += 1;
        let slots = self.shape.slots as f64;
        let step = if slots > 1.0 { axis.step / slots } else { 0.0 };
        let x = axis.at(sample) + f64::from(event.slot) * step;
        let Event { neuron, polarity, .. } = *event;
        let is_up = polarity == Polarity::Up;
        if self.drawn.insert((axis.column(x), neuron, is_up)) {
            self.spikes.push(Spike { x, neuron, is_up });
        }
    }
}
