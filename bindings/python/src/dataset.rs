//! Data sets of many logs, whose logs are encoded in any process.

use std::path::PathBuf;

use anyhow::{Result, bail};
use lab::dataset::{Code, Flights, Request, Run};
use lab::flight::Flight;
use pyo3::prelude::*;

use crate::coder::Coder;
use crate::error::{Error, value};
use crate::library::Input;

/// Keywords of `dataset`, which a task carries to another process.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Keywords {
    logs: Vec<PathBuf>,
    /// Text of a flight's file.
    flight: Option<String>,
    coder: Option<Coder>,
    input: Input,
    channels_of: Vec<String>,
    output: PathBuf,
    test: f64,
    by_directory: bool,
}

impl Keywords {
    fn request(self) -> Result<Request> {
        let code = match (self.flight, self.coder) {
            (Some(flight), _) => Code::Flight(Box::new(Flight::parse(&flight)?)),
            (None, Some(coder)) => Code::Coding(Box::new(coder.coding())),
            (None, None) => bail!("neither a flight nor a scheme"),
        };
        let channels_of = self.channels_of.iter().map(|own| own.parse());
        Ok(Request {
            logs: self.logs,
            code,
            channel: self.input.channel()?,
            channels_of: channels_of.collect::<lab::Result<_>>()?,
            output: self.output,
            test: self.test,
            flights: if self.by_directory { Flights::Directories } else { Flights::Logs },
            jobs: 1,
        })
    }
}

/// A data set that is being completed; its directory is locked.
#[pyclass(module = "spikewire._native")]
pub(crate) struct Dataset(Option<Run>);

#[pymethods]
impl Dataset {
    #[new]
    fn new(py: Python, keywords: Keywords) -> PyResult<Self> {
        let run = py.detach(|| -> Result<Run> { Ok(Run::open(&keywords.request()?)?) });
        run.map(|run| Self(Some(run))).map_err(value)
    }

    /// The logs that have no row yet.
    fn left(&self) -> Vec<PathBuf> {
        self.0.as_ref().map(Run::left).unwrap_or_default()
    }

    /// Appends the row of a log, as [`encode_log`] returns it.
    fn add(&mut self, row: &str) -> PyResult<()> {
        let own = serde_json::from_str(row).map_err(value)?;
        self.0.as_mut().map_or(Ok(()), |run| run.add(own)).map_err(value)
    }

    /// Completes the manifest, and returns the counts as JSON.
    fn finish(&mut self) -> PyResult<String> {
        let run = self.0.take().ok_or_else(|| Error::new_err("it is finished already"))?;
        let (outcome, _) = run.finish().map_err(value)?;
        serde_json::to_string(&outcome).map_err(value)
    }
}

/// Encodes a log to its parts; returns its row of the manifest, as JSON.
#[pyfunction]
pub(crate) fn encode_log(py: Python, keywords: Keywords, log: PathBuf) -> PyResult<String> {
    let encoded =
        || -> Result<String> { Ok(serde_json::to_string(&keywords.request()?.encode(&log)?)?) };
    py.detach(encoded).map_err(value)
}
