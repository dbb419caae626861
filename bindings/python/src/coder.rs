//! A scheme with what was given of its parameters, and with all of them.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{Context, Result, anyhow, bail};
use catalogue::run::{
    Asked, Calibrated, Codec, Known, RunTime, SampleType, Settings, Value, Values, missing,
};
use lab::tune::costs::Costs;
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::array::{Bounds, Grid, Lane, RUN, Samples, Tile, View, are_good, lies_in};
use crate::channel::{self, Bad};
use crate::error::{Error, value};
use crate::stream::{Decoder, Encoder};
use crate::values::{self, Given};
use crate::work::{self, Meter};

/// What was given of a scheme's parameters; a signal may tell the rest.
#[derive(Clone)]
#[pyclass(frozen, from_py_object, module = "spikewire._native")]
pub(crate) struct Coder {
    pub(crate) scheme: &'static dyn RunTime,
    pub(crate) sample: SampleType,
    pub(crate) asked: Asked,
}

impl Coder {
    /// Complete settings for one channel, as they run.
    ///
    /// # Errors
    /// A parameter is missing or makes no sense.
    pub(crate) fn settle(
        &self,
        first: &[f64],
        calibrated: Option<&Calibrated>,
    ) -> Result<Settings> {
        if calibrated.is_none()
            && let Some(what) = self.scheme.needs_signal(&self.asked)
        {
            bail!("{} needs {what} before it has seen a signal; fit(x) finds it", self.name());
        }
        let known = Known { calibrated, first, can_calibrate: calibrated.is_some() };
        Ok(self.scheme.resolve(self.sample, &self.asked, &known)?)
    }

    /// The same for one channel of so many, which may have values of its own.
    ///
    /// # Errors
    /// A parameter has another number of values.
    pub(crate) fn channel(&self, channel: usize, channels: usize) -> Result<Self> {
        let asked = self.asked.channel(self.scheme.info(), channel, channels)?;
        Ok(Self { asked, ..self.clone() })
    }

    /// Any channel, for what is the same of all.
    fn any(&self) -> Result<Self> {
        self.channel(0, self.asked.channels(self.scheme.info())?.unwrap_or(1))
    }

    /// How many samples an encoder takes to start from.
    pub(crate) fn looks_back(&self) -> usize {
        self.scheme.looks_back(&self.asked)
    }

    /// A codec as it starts on these settings.
    pub(crate) fn start(&self, settings: &Settings) -> Result<Codec> {
        Ok(self.scheme.codec_from(settings, settings.first_value())?)
    }

    /// Refuses what makes no sense whatever the signal is.
    fn check(&self) -> Result<()> {
        let past = vec![0.0; self.looks_back()];
        let Some(what) = self.scheme.needs_signal(&self.asked) else {
            let settings = self.settle(&past, None)?;
            return self.start(&settings).map(drop);
        };
        let is_end_given = ["min", "max"].iter().any(|name| self.asked.get(name).is_some());
        if missing(self.scheme.info(), &self.asked) == Some(what) && !is_end_given {
            // Any range will do, in a type that rounds none of it.
            let mut calibrated = Calibrated::new(SampleType::F32);
            calibrated.observe(&[0.0, 1.0]);
            let plain = Self { sample: SampleType::F32, ..self.clone() };
            let settings = plain.settle(&past, Some(&calibrated))?;
            self.start(&settings)?;
        }
        Ok(())
    }

    /// Settings of some signal, for what does not depend on what a signal tells.
    fn of_ramp(&self) -> Result<Settings> {
        let ramp = [0.0, 1.0, 0.5];
        let calibrated = self.scheme.needs_signal(&self.asked).map(|_| {
            let mut calibrated = Calibrated::new(self.sample);
            calibrated.observe(&ramp);
            calibrated
        });
        self.any()?.settle(&ramp, calibrated.as_ref())
    }

    /// Says of each given parameter beyond the range of the sample type what it ran as.
    fn beyond(&self) -> Result<Vec<String>> {
        let (low, high) = self.sample.range();
        let channels = self.asked.channels(self.scheme.info())?.unwrap_or(1);
        let mut told = Vec::new();
        for channel in 0..channels {
            let own = self.channel(channel, channels)?;
            let settings = own.of_ramp()?;
            for (name, asked) in &settings.rounded {
                let is_beyond = |value: &f64| *value < low || *value > high;
                if own.asked.get(name).is_some()
                    && asked.numbers().is_some_and(|all| all.iter().any(is_beyond))
                    && let Some(ran) = settings.get(name)
                {
                    told.push(format!("in {}, {name} {asked} ran as {ran}", self.sample));
                }
            }
        }
        Ok(told)
    }

    fn name(&self) -> &'static str {
        self.scheme.info().name
    }

    fn fitted(&self, samples: &View, is_shared: bool, is_wide: bool) -> Result<Fitted> {
        let (scheme, sample, count) = (self.scheme, self.sample, samples.count());
        let past = samples.length().min(self.looks_back());
        let has_own_start = self.asked.get("start").is_none() && scheme.info().has_first_value();
        let first = |lane: &Lane| lane.part(0..past).to_vec();
        let needs_signal = self.scheme.needs_signal(&self.asked).is_some();
        let is_one = self.asked.channels(scheme.info())?.is_none();
        // What is not given then follows from a channel's first samples alone, and all channels have the rest in common.
        if !is_shared && count > 1 && is_one && !needs_signal {
            let grid = samples.grid();
            let lanes = if grid.is_some() { Vec::new() } else { samples.lanes() };
            let firsts = |channels: Range<usize>| match &grid {
                Some(grid) => grid.firsts(channels, past),
                None => lanes[channels].iter().flat_map(first).collect(),
            };
            let settings = self.settle(&firsts(0..1), None)?;
            let begins = has_own_start.then(|| Begins { past, samples: firsts(0..count) });
            return Ok(Fitted::new(scheme, sample, vec![settings], begins, count));
        }
        let lanes = &samples.lanes()[..];
        let settle = |(place, group): (usize, &[Lane])| {
            let lane = group.first().ok_or_else(|| anyhow!("there is no channel"))?;
            let (first, channels) = (first(lane), if is_shared { 1 } else { lanes.len() });
            let one;
            let own = if is_one {
                self
            } else {
                one = self.channel(place, channels)?;
                &one
            };
            let settle = |mut calibrated: Calibrated| {
                for lane in group {
                    lane.observe(&mut calibrated);
                }
                own.settle(&first, Some(&calibrated))
            };
            let in_order = || settle(Calibrated::of(sample, &self.asked));
            // The sums in order say what is wrong, if anything is.
            let settled = match (needs_signal, sample) {
                (false, _) => own.settle(&first, None),
                (true, SampleType::F32) => {
                    settle(Calibrated::unordered(&self.asked)).or_else(|_| in_order())
                }
                (true, _) => in_order(),
            };
            if lanes.len() > 1 && !is_shared {
                settled.with_context(|| format!("channel {place}"))
            } else {
                settled
            }
        };
        if is_shared {
            let channels = vec![settle((0, lanes))?];
            return Ok(Fitted::new(scheme, sample, channels, None, 1));
        }
        let channels: Vec<_> = if is_wide {
            lanes.par_chunks(1).enumerate().map(settle).collect::<Result<_>>()?
        } else {
            lanes.chunks(1).enumerate().map(settle).collect::<Result<_>>()?
        };
        Ok(Fitted::new(scheme, sample, channels, None, count))
    }
}

#[pymethods]
impl Coder {
    #[new]
    fn new(scheme: &str, sample: &str, given: Vec<(String, Given)>, paper: bool) -> PyResult<Self> {
        let scheme = named(scheme)?;
        let asked = values::asked(scheme.info(), given, paper).map_err(value)?;
        let sample = sample.parse().map_err(value)?;
        let coder = Self { scheme, sample, asked };
        coder.any().and_then(|any| any.check()).map_err(value)?;
        Ok(coder)
    }

    /// What should be known of parameters that fixed point cut to its range.
    fn cut(&self) -> Vec<String> {
        // Settings that a ramp does not suit are told with the signal.
        self.beyond().unwrap_or_default()
    }

    /// How many neurons and sub-timesteps a channel has.
    fn shape(&self) -> PyResult<(usize, usize)> {
        let settings = self.of_ramp().map_err(value)?;
        let shape = self.scheme.shape(&settings).map_err(value)?;
        Ok((shape.neurons, shape.slots))
    }

    /// What a signal must tell, if anything.
    fn needs_signal(&self) -> Option<String> {
        self.scheme.needs_signal(&self.asked).map(|needs| needs.to_string())
    }

    /// With what these samples tell: each channel by itself, or one scheme for all. Samples that tell nothing are looked
    /// at only if asked, as encoding looks at all.
    fn fit(&self, py: Python, samples: Samples, is_shared: bool, all: bool) -> PyResult<Fitted> {
        let samples = samples.view();
        let (count, length) = (samples.count(), samples.length());
        if length == 0 {
            return Err(value(anyhow!("channel 0 has no samples")));
        }
        let is_wide = work::threads(py, count, count * length)? > 1;
        let looks = all || self.scheme.needs_signal(&self.asked).is_some();
        let fitted = || match looks.then(|| samples.bad(self.sample)).flatten() {
            Some((channel, bad)) => Err(told(channel, 0, &bad)),
            None => self.fitted(&samples, is_shared, is_wide),
        };
        work::detached(py, is_wide, fitted)?.map_err(value)
    }

    /// The range that was given of a code, for all channels or for each; none of a code without one. An end that was not
    /// given is the signal's, which no sample passes.
    fn ranges(&self) -> PyResult<Vec<[f64; 2]>> {
        let info = self.scheme.info();
        let count = self.asked.channels(info).map_err(value)?.unwrap_or(1);
        let mut ranges = Vec::new();
        for channel in 0..count {
            let own = self.channel(channel, count).map_err(value)?.asked;
            let end = |name| own.get(name).and_then(Value::number);
            let ends = [end("min"), end("max")];
            if ends != [None, None] {
                ranges.push([ends[0].unwrap_or(f64::MIN), ends[1].unwrap_or(f64::MAX)]);
            }
        }
        Ok(ranges)
    }

    /// It with draws that start from this seed.
    fn seeded(&self, seed: u64) -> Self {
        let mut own = self.clone();
        own.asked.set("seed", seed);
        own
    }

    /// How many samples after its own the code of a sample comes out.
    fn latency(&self) -> PyResult<usize> {
        let settings = self.of_ramp().map_err(value)?;
        let channel = self.start(&settings);
        channel.map(|channel| channel.latency()).map_err(value)
    }

    /// Instructions of a Cortex-M4F to encode a sample, by the measured table; none if they were not measured.
    fn instructions(&self) -> PyResult<Option<f64>> {
        let settings = self.of_ramp().map_err(value)?;
        Ok(Costs::new(self.scheme.into(), &settings, self.latency()?, "M4F").instructions)
    }

    /// An encoder of this many channels that keeps its state.
    fn encoder(&self, channels: usize) -> PyResult<Encoder> {
        if let Some(what) = self.scheme.needs_signal(&self.asked) {
            let error = anyhow!("{} needs {what} to begin a stream; fit(x) finds it", self.name());
            return Err(value(error));
        }
        Ok(Encoder::new(self.clone(), channels, self.shape()?))
    }

    /// A decoder that keeps its state, of as many channels as there are first values or none of these.
    fn decoder(&self, first: Vec<Option<f64>>) -> PyResult<Decoder> {
        let channels = first.iter().enumerate().map(|(place, own)| {
            let past = vec![own.unwrap_or_default(); self.looks_back()];
            let settings = self.channel(place, first.len())?.settle(&past, None)?;
            Ok(self.scheme.codec_from(&settings, settings.first_value().or(*own))?)
        });
        let channels = channels.collect::<Result<Vec<_>>>();
        Ok(Decoder::new(channels.map_err(value)?, self.sample))
    }
}

/// A scheme with all parameters of each channel.
#[derive(Clone)]
#[pyclass(frozen, from_py_object, module = "spikewire._native")]
pub(crate) struct Fitted {
    scheme: &'static dyn RunTime,
    sample: SampleType,
    /// Those of one stand for all, but for the samples with which a channel begins.
    channels: Vec<Settings>,
    begins: Option<Begins>,
    /// Number of channels; 1 if the same settings serve any number.
    count: usize,
    /// Whether a codec of one channel can start anew as that of another: they have the same settings, and draw nothing.
    serves_all: bool,
    /// The ranges of `channels`; none of a code without a range.
    bounds: Vec<Bounds>,
}

/// The first samples of each channel, from which its encoder starts.
#[derive(Clone)]
struct Begins {
    /// Number of samples of a channel.
    past: usize,
    samples: Vec<f64>,
}

impl Begins {
    fn of(&self, channel: usize) -> &[f64] {
        self.samples.chunks(self.past.max(1)).nth(channel).unwrap_or_default()
    }
}

impl Fitted {
    fn new(
        scheme: &'static dyn RunTime,
        sample: SampleType,
        channels: Vec<Settings>,
        begins: Option<Begins>,
        count: usize,
    ) -> Self {
        let serves_all = matches!(&*channels, [own] if own.get("seed").is_none());
        let mut bounds = Vec::new();
        for own in &channels {
            if let (Ok(min), Ok(max)) = (own.number("min"), own.number("max")) {
                bounds.push(Bounds::new(sample, min, max));
            }
        }
        Self { scheme, sample, channels, begins, count, serves_all, bounds }
    }

    fn bounds(&self, channel: usize) -> Option<&Bounds> {
        self.bounds.get(channel).or(self.bounds.first())
    }

    fn common(&self, channel: usize) -> Result<&Settings> {
        let own = self.channels.get(channel).or(self.channels.first());
        own.ok_or_else(|| anyhow!("there is no channel"))
    }

    fn settings(&self, channel: usize) -> Result<Settings> {
        let common = self.common(channel)?;
        let begins = self.begins.as_ref();
        Ok(begins.map_or_else(|| common.clone(), |all| common.beginning(all.of(channel))))
    }

    fn start(&self, channel: usize) -> Result<Codec> {
        let mut settings = self.settings(channel)?;
        settings.stream = channel as u64;
        Ok(self.scheme.codec_from(&settings, settings.first_value())?)
    }

    /// Starts a channel: anew on the codec of another one, if that can serve all.
    fn start_on(&self, codec: Option<Codec>, channel: usize) -> Result<Codec> {
        let Some(mut codec) = codec.filter(|_| self.serves_all) else { return self.start(channel) };
        let common = &self.common(channel)?.first;
        codec.restart(self.begins.as_ref().map_or(common, |all| all.of(channel)));
        Ok(codec)
    }

    /// Whether so many channels are encoded side by side, though each is long.
    fn has_lanes(&self, count: usize, length: usize) -> bool {
        /// Copies of longer ones would take too much memory.
        const MOST: usize = 1 << 20;
        /// Samples times taps; with more, Ctrl-C would wait.
        const WORK: usize = 1 << 24;
        let suits = |codec: Codec| codec.has_lanes() && length * (codec.latency() + 1) <= WORK;
        count > 1 && length <= MOST && self.start(0).is_ok_and(suits)
    }

    /// How many cells a row has.
    fn width(&self) -> Result<usize> {
        let shape = self.scheme.shape(self.common(0)?)?;
        Ok(shape.neurons * shape.slots)
    }
}

/// A channel's parameters by name, and its first samples.
type Parts = (Vec<(String, String)>, Vec<f64>);

/// Parameters as a file lists them.
fn texts(settings: &Settings) -> Vec<(&'static str, String)> {
    settings.entries().iter().map(|(name, value)| (*name, value.to_string())).collect()
}

/// The scheme of a short name.
fn named(name: &str) -> PyResult<&'static dyn RunTime> {
    let named = catalogue::ALL.iter().find(|own| own.info().name == name);
    let unknown = || Error::new_err(format!("there is no scheme {name:?}"));
    named.copied().ok_or_else(unknown)
}

/// So many samples are coded before anybody asks whether to stop.
const PIECE: usize = 1 << 16;

/// The error that ends the work; the first bad sample is then searched and told.
const BAD: &str = "a sample is not finite";

/// Returns how many channels with this many cells each a thread encodes in one go, so that they stay in the cache.
fn run_of(cells: usize) -> usize {
    const CACHED: usize = 1 << 13;
    (CACHED / cells.max(1)).clamp(1, CACHED).next_multiple_of(RUN)
}

#[pymethods]
impl Fitted {
    /// How many neurons and sub-timesteps a channel has.
    fn shape(&self) -> PyResult<(usize, usize)> {
        let shape = self.common(0).and_then(|settings| Ok(self.scheme.shape(settings)?));
        shape.map(|shape| (shape.neurons, shape.slots)).map_err(value)
    }

    /// How many samples after its own the code of a sample comes out.
    fn latency(&self) -> PyResult<usize> {
        self.start(0).map(|channel| channel.latency()).map_err(value)
    }

    /// The parameters of each channel, as a file lists them.
    fn parameters(&self) -> PyResult<Vec<Vec<(&'static str, String)>>> {
        let texts = |channel| Ok(texts(&self.settings(channel)?));
        (0..self.count).map(texts).collect::<Result<_>>().map_err(value)
    }

    /// The parameters of a channel as keywords that bring them about again.
    fn keywords(&self, channel: usize) -> PyResult<Vec<(&'static str, Given)>> {
        let settings = self.settings(channel).map_err(value)?;
        Ok(values::keywords(&settings.to_asked(self.scheme.info())))
    }

    /// The cells of all samples, and of those that wait for later ones at the end; and whether some samples lie outside
    /// the code's range.
    fn encode<'py>(
        &self,
        py: Python<'py>,
        samples: Samples,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Bound<'py, PyArray1<i8>>, bool)> {
        let samples = samples.view();
        let (count, length) = (samples.count(), samples.length());
        let width = self.width().map_err(value)?;
        let total = length * count;
        let output = PyArray1::zeros(py, total * width, false);
        let mut access = output.readwrite();
        let cells = access.as_slice_mut()?;
        let threads = work::threads(py, count, total * width)?;
        let is_wide = threads > 1;
        let is_one = self.channels.len() == 1 && self.count == count;
        let goes_at_once = is_one && (length <= PIECE / RUN || self.has_lanes(count, length));
        let grid = samples.grid().filter(|_| goes_at_once);
        let lanes = if grid.is_some() { Vec::new() } else { samples.lanes() };
        // Every thread has a share.
        let most = count.div_ceil(threads).max(1);
        let run = if grid.is_some() { run_of(length * width).min(most) } else { 1 };
        let is_outside = AtomicBool::new(false);
        let done = work::run(py, is_wide, total, progress.as_ref(), |meter| {
            let watch = &Watch { meter, is_outside: &is_outside };
            let encode = |bench: &mut Bench, (place, room): (usize, &mut [i8])| {
                let from = place * run;
                match &grid {
                    Some(grid) => {
                        let channels = from..count.min(from + run);
                        self.encode_grid(bench, grid, channels, length, room, watch)
                    }
                    None => self.encode_lane(bench, &lanes[from], from, room, watch),
                }
            };
            let size = (run * length * width).max(1);
            if is_wide {
                let rooms = cells.par_chunks_mut(size).enumerate();
                rooms.try_for_each_init(Bench::default, encode)
            } else {
                let mut bench = Bench::default();
                cells.chunks_mut(size).enumerate().try_for_each(|own| encode(&mut bench, own))
            }
        })?;
        // The first bad sample, whichever thread met one.
        done.map_err(|error| {
            let bad = samples.bad(self.sample);
            value(bad.map_or(error, |(channel, bad)| told(channel, 0, &bad)))
        })?;
        drop(access);
        Ok((output, is_outside.into_inner()))
    }

    /// The values of rows of cells, of this many channels.
    fn decode<'py>(
        &self,
        py: Python<'py>,
        cells: PyReadonlyArray1<i8>,
        channels: usize,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let cells = cells.as_slice()?;
        let width = self.width().map_err(value)?;
        let total = cells.len() / width;
        let progress = progress.as_ref();
        macro_rules! decoded {
            ($type:ty, $kind:ident) => {{
                let output = PyArray1::<$type>::zeros(py, total, false);
                let mut access = output.readwrite();
                let values = access.as_slice_mut()?;
                let is_wide = work::threads(py, channels, total * width)? > 1;
                let done = work::run(py, is_wide, total, progress, |meter| {
                    let length = (total / channels.max(1)).max(1);
                    let decode = |(place, (rows, room)): (usize, (&[i8], &mut [$type]))| {
                        let mut channel = self.start(place)?;
                        let pieces = rows.chunks(PIECE * width).zip(room.chunks_mut(PIECE));
                        for (piece, (rows, room)) in pieces.enumerate() {
                            if meter.is_stopped() {
                                break;
                            }
                            let done =
                                channel::decode(&mut channel, rows, &mut Values::$kind(room));
                            done.map_err(|bad| told(place, piece * PIECE, &bad))?;
                            meter.add(room.len());
                        }
                        Ok(())
                    };
                    if is_wide {
                        let rooms = values.par_chunks_mut(length);
                        let rows = cells.par_chunks(length * width);
                        rows.zip(rooms).enumerate().try_for_each(decode)
                    } else {
                        let rooms = values.chunks_mut(length);
                        let rows = cells.chunks(length * width);
                        rows.zip(rooms).enumerate().try_for_each(decode)
                    }
                })?;
                done.map_err(|error: anyhow::Error| value(error))?;
                drop(access);
                Ok(output.into_any())
            }};
        }
        match self.sample {
            SampleType::F32 => decoded!(f32, F32),
            SampleType::Fixed16 { fraction: 0 } => decoded!(i16, I16),
            _ => decoded!(f64, F64),
        }
    }

    /// The scheme, the sample type, and each channel's parameters and first samples, from which it is made again.
    fn parts(&self) -> PyResult<(&'static str, String, Vec<Parts>)> {
        let parts = |channel| {
            let settings = self.settings(channel)?;
            let texts = texts(&settings).into_iter();
            let texts = texts.map(|(name, text)| (name.to_owned(), text)).collect();
            Ok((texts, settings.first))
        };
        let channels = (0..self.count).map(parts).collect::<Result<_>>().map_err(value)?;
        Ok((self.scheme.info().name, self.sample.to_string(), channels))
    }

    /// Made of what [`parts`](Self::parts) gives.
    #[staticmethod]
    fn of_parts(scheme: &str, sample: &str, channels: Vec<Parts>) -> PyResult<Self> {
        let scheme = named(scheme)?;
        let sample = sample.parse().map_err(value)?;
        let settings = |(mut texts, first): Parts| {
            let mut settings = Settings::take(scheme.info(), sample, &mut texts)?;
            settings.first = first;
            Ok(settings)
        };
        let channels = channels.into_iter().map(settings).collect::<Result<Vec<_>>>();
        let channels = channels.map_err(value)?;
        let count = channels.len();
        Ok(Self::new(scheme, sample, channels, None, count))
    }
}

impl Fitted {
    /// Encodes neighbouring channels, which share their settings.
    fn encode_grid(
        &self,
        bench: &mut Bench,
        grid: &Grid,
        channels: Range<usize>,
        length: usize,
        room: &mut [i8],
        watch: &Watch,
    ) -> Result<()> {
        if watch.meter.is_stopped() {
            return Ok(());
        }
        let codec = match &mut bench.codec {
            Some(codec) => codec,
            none => none.insert(self.start(0)?),
        };
        let (first, count) = (channels.start as u64, channels.len());
        let samples = grid.channels(channels, &mut bench.tile);
        // They share their settings. What lies in the range of their code is good without a look at each sample.
        let is_inside = self.bounds(0).map(|bounds| lies_in(samples, bounds));
        if is_inside != Some(true) && !are_good(samples, self.sample) {
            bail!(BAD);
        }
        if is_inside == Some(false) {
            watch.is_outside.store(true, Ordering::Relaxed);
        }
        codec.encode_channels(samples, length, first, room);
        watch.meter.add(count * length);
        Ok(())
    }

    /// Encodes one channel.
    fn encode_lane(
        &self,
        bench: &mut Bench,
        lane: &Lane,
        channel: usize,
        room: &mut [i8],
        watch: &Watch,
    ) -> Result<()> {
        let width = self.width()?;
        let started = self.start_on(bench.codec.take(), channel);
        let started = started.with_context(|| format!("channel {channel}"))?;
        let codec = bench.codec.insert(started);
        let mut made = 0;
        for start in (0..lane.len()).step_by(PIECE) {
            if watch.meter.is_stopped() {
                return Ok(());
            }
            let part = lane.part(start..lane.len().min(start + PIECE));
            let is_inside = self.bounds(channel).map(|bounds| part.lies_in(bounds));
            if is_inside != Some(true) && part.bad(self.sample).is_some() {
                bail!(BAD);
            }
            if is_inside == Some(false) {
                watch.is_outside.store(true, Ordering::Relaxed);
            }
            made += part.encode(codec, &mut room[made * width..]);
            watch.meter.add(part.len());
        }
        codec.finish_cells(&mut room[made * width..]);
        Ok(())
    }
}

/// What threads say of their work.
struct Watch<'a> {
    meter: &'a Meter,
    /// Whether some sample lies outside the code's range.
    is_outside: &'a AtomicBool,
}

/// The codec and the room for copies that a thread uses for one channel after the other.
#[derive(Default)]
struct Bench {
    codec: Option<Codec>,
    tile: Tile,
}

/// What is bad, of which sample of which channel.
pub(crate) fn told(channel: usize, start: usize, bad: &Bad) -> anyhow::Error {
    anyhow!("channel {channel}, sample {}: {}", start + bad.sample, bad.what)
}
