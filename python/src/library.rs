//! What the laptop program does, on arrays.

use std::path::PathBuf;

use anyhow::Result;
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use spikewire::{Event, Polarity, Tick};
use spikewire_cli::library::{self, Arguments, Coding, Shown, Signal, Tuned, Watch};

use crate::coder::Coder;
use crate::error::value;
use crate::work;

/// Options by name; a value of `None` is a flag.
type Given = Vec<(String, Option<String>)>;

/// A tuned scheme: its name, its options, its figures as JSON, and what a file says of it.
type Told = (&'static str, Vec<(String, String)>, String, Vec<String>);

/// Long work tells this many parts.
const PARTS: usize = 1_000_000;

fn arguments(given: Given) -> Arguments {
    let mut arguments = Arguments::default();
    for (name, value) in given {
        match value {
            Some(value) => arguments.set(&name, &value),
            None => arguments.flag(&name),
        }
    }
    arguments
}

fn told(tuned: Tuned) -> Told {
    (tuned.scheme, tuned.options, tuned.figures, tuned.comments)
}

fn signal(name: String, values: &PyReadonlyArray1<f64>, rate: Option<f64>) -> Signal {
    Signal { name, values: values.as_array().to_vec(), rate }
}

impl Coder {
    fn coding(&self) -> Coding {
        let scheme = self.scheme.info().name.to_owned();
        Coding { scheme, sample: self.sample, options: self.options.clone() }
    }
}

/// Long work that can be watched and stopped.
fn watched<T: Send>(
    py: Python,
    progress: Option<Py<PyAny>>,
    job: impl FnOnce(&Watch) -> Result<T> + Send,
) -> PyResult<T> {
    let done = work::run(py, PARTS, progress.as_ref(), |meter| {
        let tell = |part: f64| meter.set((part * PARTS as f64) as usize);
        job(&Watch { stop: meter.stop(), tell: &tell })
    })?;
    done.map_err(|error| value(&error))
}

/// The figures of a scheme on a signal, as JSON.
#[pyfunction]
pub(crate) fn score(
    py: Python,
    coder: &Coder,
    values: PyReadonlyArray1<f64>,
    rate: Option<f64>,
) -> PyResult<String> {
    let (signal, coding) = (signal("x".to_owned(), &values, rate), coder.coding());
    py.detach(|| library::score(&signal, &coding)).map_err(|error| value(&error))
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
    let signal = signal(name, &values, rate);
    let codings: Vec<Coding> = coders.iter().map(Coder::coding).collect();
    let shown = Shown { unit, range: range.map(|(start, end)| start..end) };
    let bytes = py.detach(|| library::plot(&signal, &codings, &shown, ending));
    Ok(PyBytes::new(py, &bytes.map_err(|error| value(&error))?))
}

/// The settings found for signals of one channel, the best first, and what reached no goal.
#[pyfunction]
pub(crate) fn tune(
    py: Python,
    signals: Vec<PyReadonlyArray1<f64>>,
    rate: Option<f64>,
    name: &str,
    given: Given,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Vec<Told>, Vec<String>)> {
    let signals: Vec<Signal> =
        signals.iter().map(|values| signal(name.to_owned(), values, rate)).collect();
    let arguments = arguments(given);
    let (tuned, missed) =
        watched(py, progress, |watch| library::tune(&signals, &arguments, watch))?;
    Ok((tuned.into_iter().map(told).collect(), missed))
}

/// What is said of each signal: a page, figures as JSON, and the scheme advised.
#[pyfunction]
pub(crate) fn advise(
    py: Python,
    signals: Vec<(String, PyReadonlyArray1<f64>)>,
    rate: Option<f64>,
    given: Given,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<(String, String, Option<Told>)>> {
    let signals: Vec<Signal> =
        signals.into_iter().map(|(name, values)| signal(name, &values, rate)).collect();
    let arguments = arguments(given);
    let all = watched(py, progress, |watch| library::advise(&signals, &arguments, watch))?;
    Ok(all.into_iter().map(|own| (own.page, own.figures, own.best.map(told))).collect())
}

/// A scheme as a constant in Rust.
#[pyfunction]
pub(crate) fn to_rust(coder: &Coder, name: &str, comments: Vec<String>) -> PyResult<String> {
    library::rust(&coder.coding(), name, &comments).map_err(|error| value(&error))
}

/// A crate that makes the library for C of a scheme, in a new directory.
#[pyfunction]
pub(crate) fn to_c(
    coder: &Coder,
    name: &str,
    directory: PathBuf,
    spikewire: Option<PathBuf>,
) -> PyResult<()> {
    library::c(&coder.coding(), name, &directory, spikewire.as_deref())
        .map_err(|error| value(&error))
}

/// A scheme as a file of parameters.
#[pyfunction]
pub(crate) fn to_toml(coder: &Coder, comments: Vec<String>) -> PyResult<String> {
    library::toml(&coder.coding(), &comments).map_err(|error| value(&error))
}

/// Channels of a file: names, samples, times in µs, notes.
type Read<'py> =
    (Vec<String>, Vec<Bound<'py, PyArray1<f64>>>, Bound<'py, PyArray1<i64>>, Vec<String>);

/// Reads channels of a flight log or a table.
#[pyfunction]
pub(crate) fn read<'py>(py: Python<'py>, path: &str, given: Given) -> PyResult<Read<'py>> {
    let arguments = arguments(given);
    let log = py.detach(|| library::read(path, &arguments)).map_err(|error| value(&error))?;
    let columns = log.columns.into_iter().map(|column| column.into_pyarray(py)).collect();
    Ok((log.names, columns, log.times.into_pyarray(py), log.notes))
}

/// Times in µs, addresses, polarities, notes.
type Events<'py> =
    (Bound<'py, PyArray1<u32>>, Bound<'py, PyArray1<u16>>, Bound<'py, PyArray1<bool>>, Vec<String>);

/// The events in bytes of a format.
#[pyfunction]
pub(crate) fn read_events<'py>(
    py: Python<'py>,
    bytes: &[u8],
    format: &str,
) -> PyResult<Events<'py>> {
    let read = py.detach(|| library::read_events(bytes, format)).map_err(|error| value(&error))?;
    let ticks: Vec<u32> = read.events.iter().map(|event| event.tick.micros()).collect();
    let addresses: Vec<u16> = read.events.iter().map(|event| event.address).collect();
    let are_up: Vec<bool> =
        read.events.iter().map(|event| event.polarity == Polarity::Up).collect();
    Ok((ticks.into_pyarray(py), addresses.into_pyarray(py), are_up.into_pyarray(py), read.notes))
}

/// Events as bytes of a format, and what it could not hold.
#[pyfunction]
pub(crate) fn write_events<'py>(
    py: Python<'py>,
    ticks: PyReadonlyArray1<u32>,
    addresses: PyReadonlyArray1<u16>,
    are_up: PyReadonlyArray1<bool>,
    format: &str,
) -> PyResult<(Bound<'py, PyBytes>, Vec<String>)> {
    let (ticks, addresses) = (ticks.as_array(), addresses.as_array());
    let fields = ticks.iter().zip(addresses).zip(are_up.as_array());
    let events: Vec<Event> = fields
        .map(|((tick, address), is_up)| Event {
            tick: Tick::from(*tick),
            address: *address,
            polarity: if *is_up { Polarity::Up } else { Polarity::Down },
        })
        .collect();
    let written = py.detach(|| library::write_events(&events, format));
    let (bytes, notes) = written.map_err(|error| value(&error))?;
    Ok((PyBytes::new(py, &bytes), notes))
}
