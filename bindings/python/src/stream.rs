//! Encoders and decoders that keep their state from one call to the next.

use std::sync::{Mutex, MutexGuard, TryLockError};

use anyhow::{Context, Result, ensure};
use catalogue::run::{Codec, SampleType, Values};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::array::{Lane, Samples};
use crate::channel;
use crate::coder::{Coder, told};
use crate::error::{Error, busy, value};
use crate::work;

/// What a stream pickles as: the package's version, the samples that wait for the encoder to start, and the states of the
/// channels that run. No version reads another's.
type Pickled = (String, Vec<Vec<f64>>, Vec<Vec<u8>>);

fn pickled(waiting: &[Vec<f64>], running: &[Codec]) -> Result<Pickled> {
    let states = running.iter().map(Codec::state).collect::<Result<_, _>>()?;
    Ok((env!("CARGO_PKG_VERSION").to_owned(), waiting.to_vec(), states))
}

fn set_states(running: &mut [Codec], (version, _, states): &Pickled) -> Result<()> {
    let own = env!("CARGO_PKG_VERSION");
    ensure!(version == own, "the stream was pickled by spikewire {version}, and this is {own}");
    ensure!(states.len() == running.len(), "the states are of {} channels", states.len());
    for (place, (channel, state)) in running.iter_mut().zip(states).enumerate() {
        channel.set_state(state).with_context(|| format!("channel {place}"))?;
    }
    Ok(())
}

/// Takes what a call works on, unless a call of another thread works on it.
fn taken<'a, T>(state: &'a Mutex<T>, what: &str) -> PyResult<MutexGuard<'a, T>> {
    match state.try_lock() {
        Ok(guard) => Ok(guard),
        Err(TryLockError::Poisoned(error)) => Ok(error.into_inner()),
        Err(TryLockError::WouldBlock) => Err(busy(format!(
            "this {what} is at work in another thread; chunks go through one after the other, and threads take an \
             {what} each"
        ))),
    }
}

/// Encoders of several channels.
#[pyclass(frozen, module = "spikewire._native")]
pub(crate) struct Encoder(Mutex<Encoding>);

impl Encoder {
    pub(crate) fn new(coder: Coder, channels: usize, shape: (usize, usize)) -> Self {
        let waiting = vec![Vec::new(); channels];
        Self(Mutex::new(Encoding { coder, running: Vec::new(), waiting, shape }))
    }

    fn taken(&self) -> PyResult<MutexGuard<'_, Encoding>> {
        taken(&self.0, "encoder")
    }
}

struct Encoding {
    coder: Coder,
    /// None before as many samples have come as the encoder starts from.
    running: Vec<Codec>,
    /// The samples that have come before that, by channel.
    waiting: Vec<Vec<f64>>,
    /// How many neurons and sub-timesteps a channel has.
    shape: (usize, usize),
}

impl Encoding {
    /// How many cells a row has.
    fn width(&self) -> usize {
        self.shape.0 * self.shape.1
    }

    /// Starts on the samples that wait, and encodes them.
    fn begin(&mut self, is_wide: bool) -> Result<Vec<Vec<i8>>> {
        let looks_back = self.coder.looks_back();
        let mut running = Vec::new();
        for (place, waiting) in self.waiting.iter().enumerate() {
            let first = &waiting[..waiting.len().min(looks_back)];
            let mut settings =
                self.coder.channel(place, self.waiting.len())?.settle(first, None)?;
            settings.stream = place as u64;
            running.push(self.coder.start(&settings)?);
        }
        self.running = running;
        let waiting: Vec<Vec<f64>> = self.waiting.iter_mut().map(std::mem::take).collect();
        let lanes: Vec<Lane> = waiting.iter().map(|own| Lane::F64(own.as_slice().into())).collect();
        self.push(&lanes, is_wide)
    }

    fn set(&mut self, pickled: &Pickled) -> Result<()> {
        let (_, waiting, states) = pickled;
        let channels = self.waiting.len();
        ensure!(waiting.len() == channels, "the stream has {} channels", waiting.len());
        let mut running = Vec::new();
        if !states.is_empty() {
            // They come from their states, whatever they would have started from.
            let first = vec![0.0; self.coder.looks_back()];
            let start = |place| {
                let settings = self.coder.channel(place, channels)?.settle(&first, None)?;
                self.coder.start(&settings)
            };
            running = (0..channels).map(start).collect::<Result<_>>()?;
        }
        set_states(&mut running, pickled)?;
        (self.running, self.waiting) = (running, waiting.clone());
        Ok(())
    }

    fn push(&mut self, lanes: &[Lane], is_wide: bool) -> Result<Vec<Vec<i8>>> {
        let (width, sample) = (self.width(), self.coder.sample);
        let code = |(place, (channel, lane)): (usize, (&mut Codec, &Lane))| {
            let mut cells = vec![0; lane.len() * width];
            let made = channel::encode(channel, sample, *lane, &mut cells)
                .map_err(|bad| told(place, 0, &bad))?;
            cells.truncate(made * width);
            Ok(cells)
        };
        if is_wide {
            self.running.par_iter_mut().zip(lanes).enumerate().map(code).collect()
        } else {
            self.running.iter_mut().zip(lanes).enumerate().map(code).collect()
        }
    }

    fn encode_all(&mut self, lanes: &[Lane], is_wide: bool) -> Result<Vec<Vec<i8>>> {
        for (channel, lane) in lanes.iter().enumerate() {
            if let Some(bad) = lane.bad(self.coder.sample) {
                return Err(told(channel, 0, &bad));
            }
        }
        if !self.running.is_empty() {
            return self.push(lanes, is_wide);
        }
        for (waiting, lane) in self.waiting.iter_mut().zip(lanes) {
            waiting.extend(lane.to_vec());
        }
        if self.waiting.iter().any(|waiting| waiting.len() < self.coder.looks_back().max(1)) {
            return Ok(vec![Vec::new(); lanes.len()]);
        }
        self.begin(is_wide)
    }

    fn finish_all(&mut self, is_wide: bool) -> Result<Vec<Vec<i8>>> {
        let width = self.width();
        let mut cells = vec![Vec::new(); self.waiting.len()];
        if self.running.is_empty() && self.waiting.iter().all(|waiting| !waiting.is_empty()) {
            cells = self.begin(is_wide)?;
        }
        for (cells, mut channel) in cells.iter_mut().zip(self.running.drain(..)) {
            let start = cells.len();
            cells.resize(start + channel.latency() * width, 0);
            let made = channel.finish_cells(&mut cells[start..]);
            cells.truncate(start + made * width);
        }
        self.waiting.iter_mut().for_each(Vec::clear);
        Ok(cells)
    }
}

#[pymethods]
impl Encoder {
    /// How many neurons and sub-timesteps a channel has.
    fn shape(&self) -> PyResult<(usize, usize)> {
        Ok(self.taken()?.shape)
    }

    /// Takes the next samples of all channels; the cells that are complete, one channel after the other.
    fn encode<'py>(&self, py: Python<'py>, samples: Samples) -> PyResult<Bound<'py, PyArray1<i8>>> {
        let lanes = samples.view().lanes();
        let mut own = self.taken()?;
        let own = &mut *own;
        if lanes.len() != own.waiting.len() {
            return Err(Error::new_err(format!(
                "there are {} channels, not {}",
                own.waiting.len(),
                lanes.len()
            )));
        }
        let held: usize = own.waiting.iter().map(Vec::len).sum();
        let count = held + lanes.iter().map(Lane::len).sum::<usize>();
        let is_wide = work::threads(py, lanes.len(), count * own.width())? > 1;
        let cells = work::detached(py, is_wide, || own.encode_all(&lanes, is_wide))?;
        Ok(cells.map_err(value)?.concat().into_pyarray(py))
    }

    /// All that it keeps from chunk to chunk.
    fn state(&self) -> PyResult<Pickled> {
        let own = self.taken()?;
        pickled(&own.waiting, &own.running).map_err(value)
    }

    /// Goes on from a state of an encoder of the same scheme and as many channels.
    fn set_state(&self, state: Pickled) -> PyResult<()> {
        self.taken()?.set(&state).map_err(value)
    }

    /// The cells of the samples that wait for later ones; the encoder is as at its start then.
    fn finish<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<i8>>> {
        let mut own = self.taken()?;
        let own = &mut *own;
        let held: usize = own.waiting.iter().map(Vec::len).sum();
        let is_wide = work::threads(py, own.waiting.len(), held * own.width())? > 1;
        let cells = work::detached(py, is_wide, || own.finish_all(is_wide))?;
        Ok(cells.map_err(value)?.concat().into_pyarray(py))
    }
}

/// Decoders of several channels.
#[pyclass(frozen, module = "spikewire._native")]
pub(crate) struct Decoder {
    channels: Mutex<Vec<Codec>>,
    sample: SampleType,
}

impl Decoder {
    pub(crate) fn new(channels: Vec<Codec>, sample: SampleType) -> Self {
        Self { channels: Mutex::new(channels), sample }
    }

    fn taken(&self) -> PyResult<MutexGuard<'_, Vec<Codec>>> {
        taken(&self.channels, "decoder")
    }
}

/// Decodes rows of cells, all or none: a bad one leaves the channels as they were.
fn decode_all<T: Copy + Default>(
    channels: &mut [Codec],
    cells: &[i8],
    rows: usize,
    as_values: impl Fn(&mut [T]) -> Values<'_>,
) -> Result<Vec<T>> {
    let before = channels.iter().map(Codec::state).collect::<Result<Vec<_>, _>>()?;
    let own = (cells.len() / channels.len().max(1)).max(1);
    let mut values = vec![T::default(); rows * channels.len()];
    let mut rooms = values.chunks_mut(rows.max(1));
    let mut failed = None;
    for (place, (channel, cells)) in channels.iter_mut().zip(cells.chunks(own)).enumerate() {
        let Some(room) = rooms.next() else { break };
        if let Err(bad) = channel::decode(channel, cells, &mut as_values(room)) {
            failed = Some(told(place, 0, &bad));
            break;
        }
    }
    let Some(error) = failed else { return Ok(values) };
    for (channel, state) in channels.iter_mut().zip(&before) {
        channel.set_state(state)?;
    }
    Err(error)
}

#[pymethods]
impl Decoder {
    /// All that it keeps from chunk to chunk.
    fn state(&self) -> PyResult<Pickled> {
        pickled(&[], &self.taken()?).map_err(value)
    }

    /// Goes on from a state of a decoder of the same scheme and as many channels.
    fn set_state(&self, state: Pickled) -> PyResult<()> {
        set_states(&mut self.taken()?, &state).map_err(value)
    }

    /// The values of the next rows of cells, this many of each channel, one channel after the other.
    fn decode<'py>(
        &self,
        py: Python<'py>,
        cells: PyReadonlyArray1<i8>,
        rows: usize,
    ) -> PyResult<Bound<'py, PyAny>> {
        let cells = cells.as_slice()?;
        let mut own = self.taken()?;
        let own = &mut own[..];
        macro_rules! decoded {
            ($type:ty, $kind:ident) => {{
                let values = decode_all::<$type>(own, cells, rows, |room| Values::$kind(room));
                Ok(values.map_err(value)?.into_pyarray(py).into_any())
            }};
        }
        match self.sample {
            SampleType::F32 => decoded!(f32, F32),
            SampleType::Fixed16 { fraction: 0 } => decoded!(i16, I16),
            _ => decoded!(f64, F64),
        }
    }
}
