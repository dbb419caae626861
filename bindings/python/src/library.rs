//! What the laptop program does, on arrays.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;
use std::str::FromStr;

use anyhow::{Result, anyhow, bail};
use lab::advise::AdviseRequest;
use lab::coding::Coding;
use lab::emit::Codec;
use lab::events::PixelEvent;
use lab::input::{CHUNK, ChannelOptions, Chunk, Clock, InputOptions, TableKind, Unnamed};
use lab::plot::Picture;
use lab::scheme::Scheme;
use lab::score::Figures;
use lab::trial::{Recording, Trial};
use lab::tune::report::Row;
use lab::tune::{Goal, Limits, Over, TuneRequest};
use lab::watch::{Progress, Watch};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use spikewire::{Event, Polarity, Tick};

use crate::coder::Coder;
use crate::error::{Error, value};
use crate::values::{self, Given as Keyword, keywords};
use crate::work;
use catalogue::run::Given;

/// A tuned scheme: its name, its keywords, its figures as JSON, and what a file says of it.
type TunedFields = (&'static str, Vec<(&'static str, Keyword)>, String, Vec<String>);

/// Long work tells this many parts.
const PARTS: usize = 1_000_000;

fn tuned_fields(scheme: Scheme, row: &Row, channel: &str) -> Result<TunedFields> {
    let given = keywords(&row.settings.to_asked(scheme.info()));
    Ok((scheme.name(), given, serde_json::to_string(row)?, row.comments(channel)))
}

/// A signal as the library has recordings.
fn recording(name: &str, values: &PyReadonlyArray1<f64>, rate: Option<f64>) -> PyResult<Recording> {
    let values = values.as_array().to_vec();
    let refused = |text: String| Err(Error::new_err(text));
    if values.is_empty() {
        return refused(format!("{name}: there is no sample"));
    }
    if let Some(place) = values.iter().position(|value| !value.is_finite()) {
        return refused(format!("{name}, sample {place}: {} is not finite", values[place]));
    }
    if let Some(rate) = rate.filter(|rate| !(rate.is_finite() && *rate > 0.0)) {
        return refused(format!("rate {rate} must be above 0 and finite"));
    }
    Ok(Recording::of(name.to_owned(), values, rate))
}

impl Coder {
    pub(crate) fn coding(&self) -> Coding {
        Coding { scheme: self.scheme.into(), sample: self.sample, asked: self.asked.clone() }
    }

    fn trial(&self, recording: &Recording) -> Result<Trial> {
        Ok(Trial::new(self.scheme.into(), &self.asked, self.sample, recording)?)
    }
}

/// Long work that can be watched and stopped.
fn watched<T: Send>(
    py: Python,
    progress: Option<Py<PyAny>>,
    job: impl FnOnce(&Watch) -> Result<T> + Send,
) -> PyResult<T> {
    let done = work::run(py, true, PARTS, progress.as_ref(), |meter| {
        let tell = |now: &Progress| meter.set(now.done * PARTS / now.total.max(1));
        let done = job(&Watch { is_stopped: &|| meter.is_stopped(), tell: &tell });
        if meter.is_stopped() { Err(anyhow!("stopped")) } else { done }
    })?;
    done.map_err(value)
}

/// The figures of a scheme on a signal, as JSON.
#[pyfunction]
pub(crate) fn score(
    py: Python,
    coder: &Coder,
    values: PyReadonlyArray1<f64>,
    rate: Option<f64>,
) -> PyResult<String> {
    let recording = recording("x", &values, rate)?;
    let scored = || -> Result<_> {
        Ok(serde_json::to_string(&Figures::of(&recording, &coder.trial(&recording)?))?)
    };
    work::detached(py, true, scored)?.map_err(value)
}

/// A picture of a signal through schemes, as the bytes of a file.
#[pyfunction]
#[pyo3(signature = (coders, values, rate, name, unit, range, ending))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn plot<'py>(
    py: Python<'py>,
    coders: Vec<Coder>,
    values: PyReadonlyArray1<f64>,
    rate: Option<f64>,
    name: String,
    unit: Option<String>,
    range: Option<(usize, usize)>,
    ending: &str,
) -> PyResult<Bound<'py, PyBytes>> {
    let recording = recording(&name, &values, rate)?;
    let samples = recording.values.len();
    let shown = range.map_or(0..samples, |(start, end)| start..end);
    if shown.start + 1 >= shown.end || shown.end > samples {
        let Range { start, end } = shown;
        let text = format!("samples {start}..{end}: two samples at least, within 0..{samples}");
        return Err(Error::new_err(text));
    }
    let drawn = || -> Result<_> {
        let trials = coders.iter().map(|coder| coder.trial(&recording));
        let trials = trials.collect::<Result<Vec<_>>>()?;
        let mut picture = Picture::of(&recording, &trials, shown);
        picture.unit = unit.or(picture.unit);
        Ok(lab::plot::bytes(ending, &picture)?)
    };
    let bytes = work::detached(py, true, drawn)?;
    Ok(PyBytes::new(py, &bytes.map_err(value)?))
}

/// Keywords of `tune`; what is `None` is as the library has it.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Tune {
    scheme: String,
    sample: String,
    min_efficiency: Option<f64>,
    max_rmse: Option<f64>,
    max_ram: Option<f64>,
    max_instructions: Option<f64>,
    max_latency: Option<f64>,
    max_rate: Option<f64>,
    core: Option<String>,
    hold_out: Option<f64>,
    blocks: Option<usize>,
    worst_flight: bool,
    seconds: Option<f64>,
    evaluations: Option<usize>,
    seed: Option<u64>,
    anyway: bool,
    below: Option<f64>,
    kept: BTreeMap<String, Keyword>,
}

impl Tune {
    fn request(self, recordings: Vec<Recording>) -> Result<TuneRequest> {
        let schemes = match self.scheme.as_str() {
            "all" => Scheme::all().collect(),
            name => {
                vec![Scheme::named(name).ok_or_else(|| catalogue::run::Error::no_scheme(name))?]
            }
        };
        let logs = recordings.into_iter().map(|recording| vec![recording]).collect();
        let mut request = TuneRequest::new(logs, schemes);
        let mut kept = self.kept;
        if matches!(kept.get("filter"), Some(Keyword::Word(word)) if word == "free") {
            request.free_taps = true;
            kept.remove("filter");
        }
        match request.schemes[..] {
            [scheme] => {
                request.fixed = values::asked(scheme.info(), kept.into_iter().collect(), false)?;
            }
            _ if !kept.is_empty() => bail!("all schemes are searched with all their parameters"),
            _ => {}
        }
        request.goal = match (self.min_efficiency, self.max_rmse) {
            (Some(_), Some(_)) => bail!("`min_efficiency` and `max_rmse`: one of them is the goal"),
            (Some(efficiency), None) => Some(Goal::LeastError(efficiency)),
            (None, rmse) => rmse.map(Goal::MostEfficient),
        };
        request.sample = self.sample.parse()?;
        request.limits = Limits {
            ram: self.max_ram,
            instructions: self.max_instructions,
            latency: self.max_latency,
            rate: self.max_rate,
        };
        (request.seconds, request.below, request.anyway) = (self.seconds, self.below, self.anyway);
        request.core = self.core.unwrap_or(request.core);
        request.hold_out.part = self.hold_out.unwrap_or(request.hold_out.part);
        request.hold_out.blocks = self.blocks.unwrap_or(request.hold_out.blocks);
        request.over = if self.worst_flight { Over::Worst } else { Over::Mean };
        request.evaluations = self.evaluations.unwrap_or(request.evaluations);
        request.seed = self.seed.unwrap_or(request.seed);
        Ok(request)
    }
}

/// The settings found for signals of one channel, the best first, and what reached no goal.
#[pyfunction]
pub(crate) fn tune(
    py: Python,
    signals: Vec<PyReadonlyArray1<f64>>,
    rate: Option<f64>,
    name: &str,
    keywords: Tune,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Vec<TunedFields>, Vec<String>)> {
    let recordings = signals.iter().map(|values| recording(name, values, rate));
    let recordings = recordings.collect::<PyResult<Vec<_>>>()?;
    watched(py, progress, |watch| {
        let all = lab::tune::tune(&keywords.request(recordings)?, watch)?;
        let Some(tuned) = all.first() else { bail!("there is no signal") };
        if tuned.rows.is_empty() {
            let missed: Vec<String> = tuned.missed.iter().map(ToString::to_string).collect();
            bail!("{name}: of the settings tried none keeps to all limits: {}", missed.join("; "));
        }
        let rows = tuned.rows.iter().map(|(scheme, row)| tuned_fields(*scheme, row, name));
        let missed = tuned.missed.iter().map(ToString::to_string).collect();
        Ok((rows.collect::<Result<_>>()?, missed))
    })
}

/// Keywords of `advise`; what is `None` is as the library has it.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Advise {
    sample: String,
    max_rmse: Option<f64>,
    max_latency: Option<f64>,
    loop_bandwidth: Option<f64>,
    frame_loss: Option<f64>,
    core: Option<String>,
    seconds: Option<f64>,
    evaluations: Option<usize>,
    seed: Option<u64>,
}

impl Advise {
    fn request(self, recordings: Vec<Recording>) -> Result<AdviseRequest> {
        let request = AdviseRequest::new(recordings);
        Ok(AdviseRequest {
            sample: self.sample.parse()?,
            max_rmse: self.max_rmse.into_iter().collect(),
            max_latency: self.max_latency,
            loop_bandwidth: self.loop_bandwidth,
            frame_loss: self.frame_loss.unwrap_or(request.frame_loss),
            core: self.core.unwrap_or(request.core),
            seconds: self.seconds,
            evaluations: self.evaluations.unwrap_or(request.evaluations),
            seed: self.seed.unwrap_or(request.seed),
            recordings: request.recordings,
        })
    }
}

/// What is said of each signal: a page, figures as JSON, and the scheme advised.
#[pyfunction]
pub(crate) fn advise(
    py: Python,
    signals: Vec<(String, PyReadonlyArray1<f64>)>,
    rate: Option<f64>,
    keywords: Advise,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<(String, String, Option<TunedFields>)>> {
    let recordings = signals.iter().map(|(name, values)| recording(name, values, rate));
    let recordings = recordings.collect::<PyResult<Vec<_>>>()?;
    let names: Vec<&str> = signals.iter().map(|(name, _)| name.as_str()).collect();
    watched(py, progress, |watch| {
        let all = lab::advise::advise(&keywords.request(recordings)?, watch)?;
        let said = all.iter().zip(&names).map(|(own, name)| {
            let best = own.best().map(|(scheme, row)| tuned_fields(scheme, row, name));
            Ok((own.page(), serde_json::to_string(own)?, best.transpose()?))
        });
        said.collect()
    })
}

/// A scheme as a constant in Rust.
#[pyfunction]
pub(crate) fn to_rust(coder: &Coder, name: &str, comments: Vec<String>) -> PyResult<String> {
    lab::emit::rust(&coder.coding(), name, &comments).map_err(value)
}

/// A crate that makes the library for C of a scheme, in a new directory.
#[pyfunction]
pub(crate) fn to_c(
    coder: &Coder,
    name: &str,
    directory: PathBuf,
    spikewire: Option<PathBuf>,
) -> PyResult<()> {
    let named = Codec { name: name.to_owned(), coding: coder.coding() };
    lab::emit::c_crate(&[named], &directory, spikewire.as_deref()).map_err(value)
}

/// A scheme as a file of parameters.
#[pyfunction]
pub(crate) fn to_toml(coder: &Coder, comments: Vec<String>) -> PyResult<String> {
    lab::emit::toml(&coder.coding(), &comments).map_err(value)
}

/// A scheme out of a file of parameters: its name, its sample type and its keywords.
type Parsed = (&'static str, String, Vec<(&'static str, Keyword)>);

/// Reads a file of parameters, which `to_toml` or `spikewire tune --emit toml` wrote. Errors name it as `file`.
#[pyfunction]
pub(crate) fn from_toml(file: &str, text: &str) -> PyResult<Parsed> {
    let Coding { scheme, sample, asked } = Coding::parse(file, text).map_err(value)?;
    Ok((scheme.name(), sample.to_string(), keywords(&asked)))
}

/// Channels of a file: names, samples, times in µs, notes.
type Read<'py> =
    (Vec<String>, Vec<Bound<'py, PyArray1<f64>>>, Bound<'py, PyArray1<i64>>, Vec<String>);

/// Keywords of `read`; what is `None` is as the library has it.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Input {
    columns: Vec<String>,
    time: Option<String>,
    time_unit: Option<String>,
    delimiter: Option<String>,
    header: Option<u64>,
    topic: Option<String>,
    fields: Vec<String>,
    rate: Option<f64>,
    gap: Option<f64>,
    skip_non_finite: bool,
    accept_cut: bool,
}

impl Input {
    /// Returns the options for reading a recording.
    ///
    /// # Errors
    /// A keyword makes no sense.
    pub(crate) fn channel(self) -> Result<ChannelOptions> {
        for (name, value) in [("rate", self.rate), ("gap", self.gap)] {
            if let Some(value) = value.filter(|value| !(value.is_finite() && *value > 0.0)) {
                let error = lab::Error::from(TableKind::NotAboveZero);
                return Err(error.about(Given::new(name, value)).into());
            }
        }
        let usual = ChannelOptions::default();
        Ok(ChannelOptions {
            columns: self.columns,
            time: self.time,
            time_unit: parsed("time_unit", self.time_unit)?,
            delimiter: parsed("delimiter", self.delimiter)?,
            header: self.header,
            topic: self.topic,
            fields: self.fields,
            rate: self.rate,
            gap: self.gap.unwrap_or(usual.gap),
            skip_non_finite: self.skip_non_finite,
            accept_cut: self.accept_cut,
            ..usual
        })
    }
}

/// Reads the text of a keyword.
fn parsed<T: FromStr<Err = lab::Error>>(
    name: &'static str,
    text: Option<String>,
) -> Result<Option<T>> {
    let read = |text: String| {
        text.parse().map_err(|error: lab::Error| error.about(Given::new(name, text)))
    };
    Ok(text.map(read).transpose()?)
}

/// Reads channels of a flight log or a table.
#[pyfunction]
pub(crate) fn read<'py>(py: Python<'py>, path: &str, keywords: Input) -> PyResult<Read<'py>> {
    let done = work::detached(py, true, || {
        let options = InputOptions { input: path.into(), channel: keywords.channel()? };
        let mut source = options.or(Unnamed::All).open()?;
        let mut all = Chunk::default();
        source.next(&mut all)?;
        // As in the program, the first piece tells the usual step.
        let first = all.times.len();
        all.append(&mut source.rest()?);
        let mut clock = Clock::new(&all.times[..first], options.rate, options.gap);
        clock.observe(&all.times);
        let names = source.names().into_iter().map(str::to_owned).collect();
        let mut notes: Vec<String> = source.notes().iter().map(ToString::to_string).collect();
        if first > 0 {
            notes.push(clock.to_string());
        }
        anyhow::Ok((names, all, notes))
    })?;
    let (names, all, notes) = done.map_err(value)?;
    let columns = all.columns.into_iter().map(|column| column.into_pyarray(py)).collect();
    Ok((names, columns, all.times.into_pyarray(py), notes))
}

/// The rate of times in µs, in samples a second, and why it is uncertain.
#[pyfunction]
pub(crate) fn rate_of(times: PyReadonlyArray1<i64>) -> PyResult<(Option<f64>, Option<String>)> {
    let times = times.as_slice()?;
    let mut clock =
        Clock::new(&times[..times.len().min(CHUNK)], None, ChannelOptions::default().gap);
    clock.observe(times);
    Ok((clock.rate(), clock.uneven().map(|uneven| uneven.to_string())))
}

/// Times in µs, addresses or columns, rows if there are columns, polarities, notes.
type Events<'py> = (
    Bound<'py, PyArray1<u32>>,
    Bound<'py, PyArray1<u16>>,
    Option<Bound<'py, PyArray1<u16>>>,
    Bound<'py, PyArray1<bool>>,
    Vec<String>,
);

/// The events in bytes of a format.
#[pyfunction]
pub(crate) fn read_events<'py>(
    py: Python<'py>,
    bytes: &[u8],
    format: &str,
) -> PyResult<Events<'py>> {
    let read = py.detach(|| lab::events::read_events(bytes, format)).map_err(value)?;
    let (mut ticks, mut places, mut rows, mut are_up) = (vec![], vec![], vec![], vec![]);
    for event in read.events {
        ticks.push(event.tick.micros());
        places.push(event.address);
        are_up.push(event.polarity == Polarity::Up);
    }
    for event in read.pixels {
        ticks.push(event.tick.micros());
        places.push(event.x);
        rows.push(event.y);
        are_up.push(event.polarity == Polarity::Up);
    }
    let rows = (!rows.is_empty()).then(|| rows.into_pyarray(py));
    let (ticks, places) = (ticks.into_pyarray(py), places.into_pyarray(py));
    Ok((ticks, places, rows, are_up.into_pyarray(py), read.notes))
}

/// Events as bytes of a format, and what it could not hold.
#[pyfunction]
pub(crate) fn write_events<'py>(
    py: Python<'py>,
    ticks: PyReadonlyArray1<u32>,
    places: PyReadonlyArray1<u16>,
    rows: Option<PyReadonlyArray1<u16>>,
    are_up: PyReadonlyArray1<bool>,
    format: &str,
) -> PyResult<(Bound<'py, PyBytes>, Vec<String>)> {
    let (ticks, places) = (ticks.as_array(), places.as_array());
    let fields = ticks.iter().zip(places).zip(are_up.as_array());
    let events: Vec<Event> = fields
        .map(|((tick, place), is_up)| Event {
            tick: Tick::from(*tick),
            address: *place,
            polarity: if *is_up { Polarity::Up } else { Polarity::Down },
        })
        .collect();
    let written = match rows {
        None => py.detach(|| lab::events::write_events(&events, format)),
        Some(rows) => {
            let pixel = |(event, y): (&Event, &u16)| {
                let Event { tick, address: x, polarity } = *event;
                PixelEvent { tick, x, y: *y, polarity }
            };
            let pixels: Vec<PixelEvent> = events.iter().zip(rows.as_array()).map(pixel).collect();
            py.detach(|| lab::events::write_pixels(&pixels, format))
        }
    };
    let (bytes, notes) = written.map_err(value)?;
    Ok((PyBytes::new(py, &bytes), notes))
}
