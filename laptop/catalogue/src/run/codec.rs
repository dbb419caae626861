//! An encoder and its decoder, which process many samples in a call and whose type does not depend on the scheme.
//!
//! The code of a sample is a row of cells, one for each neuron in each sub-timestep. A cell holds the number of its
//! spikes, positive for up and negative for down: -1, 0 or 1, or more if the code has several spikes in a sample.

use std::{
    any::{Any, TypeId},
    array, iter,
    ops::Range,
};

use bytemuck::{Pod, cast_slice, try_cast_slice};
use rand_pcg::Pcg32;
use spikewire::population::{Probabilistic, ProbabilisticState};
use spikewire::rate::{Average, Bernoulli, BernoulliState};
use spikewire::{Code, NeuronSpike, Output, Polarity, Sample, Scheme, Spike, timing::PhaseBits};

#[cfg(feature = "states")]
use super::ErrorKind;
use super::chance;
use super::lanes::{Lanes, Recordings};
use super::settings::generator;
use super::{Result, Runs, Settings, Shape, Visit};
use crate::State;

/// A spike of one neuron, in one sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Event {
    /// Index of the sample, from 0.
    pub sample: u64,
    /// Index of the neuron, from 0.
    pub neuron: u16,
    /// Index of the sub-timestep in the sample; 0 for codes without.
    pub slot: u16,
    /// Direction of the spike.
    pub polarity: Polarity,
}

/// Samples in the signal's unit; all must be finite.
#[derive(Clone, Copy, Debug)]
pub enum Samples<'a> {
    /// In single precision.
    F32(&'a [f32]),
    /// In double precision.
    F64(&'a [f64]),
    /// Integers.
    I16(&'a [i16]),
}

impl Samples<'_> {
    /// Returns some of the samples. Panics if there are fewer.
    #[must_use]
    pub fn part(self, range: Range<usize>) -> Self {
        match self {
            Self::F32(own) => Self::F32(&own[range]),
            Self::F64(own) => Self::F64(&own[range]),
            Self::I16(own) => Self::I16(&own[range]),
        }
    }
}

/// Buffers for decoded values, in the signal's unit.
#[derive(Debug)]
pub enum Values<'a> {
    /// In single precision.
    F32(&'a mut [f32]),
    /// In double precision.
    F64(&'a mut [f64]),
    /// Integers.
    I16(&'a mut [i16]),
}

/// An encoder and its decoder, in the signal's unit.
pub struct Codec {
    running: Box<dyn Running + Send + Sync>,
    shape: Shape,
    /// Number of samples that were encoded as events; `decoded` is the number that were decoded from events.
    coded: u64,
    decoded: u64,
    /// The cells of the sample that is being decoded.
    row: Vec<i8>,
}

impl Codec {
    /// Returns the numbers of neurons and sub-timesteps.
    pub fn shape(&self) -> Shape {
        self.shape
    }

    /// Returns the latency: how many samples after a sample its code comes out.
    pub fn latency(&self) -> usize {
        self.running.latency()
    }

    /// Returns whether several recordings in one call take less time than one after the other.
    pub fn has_lanes(&self) -> bool {
        self.running.has_lanes()
    }

    /// Starts anew, on another recording of the same settings that begins with these samples: as many as the encoder
    /// looks back, or all there are. Costs far less than another codec. A code that draws by chance draws what it drew
    /// the first time.
    pub fn restart(&mut self, past: &[f64]) {
        self.running.restart(past);
        (self.coded, self.decoded) = (0, 0);
    }

    /// Encodes recordings of `length` samples, one after the other, each from its start, into rows of cells, which must
    /// all be 0. The first recording is that of channel `channel`: a code by chance draws from a stream for each. Unless
    /// the settings say where a recording begins, its first samples do.
    ///
    /// The codec must be started anew before it is used otherwise.
    pub fn encode_channels(
        &mut self,
        samples: Samples,
        length: usize,
        channel: u64,
        cells: &mut [i8],
    ) {
        self.running.encode_channels(samples, length, channel, cells);
    }

    /// Encodes the next samples into rows of cells, which must all be 0; returns the number of rows written.
    pub fn encode_cells(&mut self, samples: Samples, cells: &mut [i8]) -> usize {
        let mut sink = Sink::Cells { rows: cells, shape: self.shape, made: 0 };
        self.running.encode(samples, &mut sink);
        sink.made()
    }

    /// Writes the rows of the samples that still wait for later ones; returns their number.
    pub fn finish_cells(&mut self, cells: &mut [i8]) -> usize {
        let mut sink = Sink::Cells { rows: cells, shape: self.shape, made: 0 };
        self.running.finish(&mut sink);
        sink.made()
    }

    /// Decodes rows of cells, as many as there is room for values.
    ///
    /// # Errors
    /// Returns the index of the first row that no encoder writes; the rows before it were decoded.
    pub fn decode_cells(&mut self, cells: &[i8], values: &mut Values) -> Result<(), usize> {
        self.running.decode(cells, values)
    }

    /// Encodes the next samples, which must be finite, and appends their events.
    pub fn encode(&mut self, samples: &[f64], events: &mut Vec<Event>) {
        let mut sink = Sink::Events { events, sample: self.coded };
        self.running.encode(Samples::F64(samples), &mut sink);
        self.coded = sink.made() as u64;
    }

    /// Encodes the samples that still wait for their look-ahead, and appends their events.
    pub fn finish(&mut self, events: &mut Vec<Event>) {
        let mut sink = Sink::Events { events, sample: self.coded };
        self.running.finish(&mut sink);
        self.coded = sink.made() as u64;
    }

    /// Decodes the next samples from their events, and appends their values.
    ///
    /// # Errors
    /// Returns the first event of a sample if no encoder could emit the sample's events together.
    pub fn decode(
        &mut self,
        samples: usize,
        mut events: &[Event],
        values: &mut Vec<f64>,
    ) -> Result<(), Event> {
        let mut row = std::mem::take(&mut self.row);
        row.resize(self.shape.neurons * self.shape.slots, 0);
        for _ in 0..samples {
            let own = events.iter().take_while(|event| event.sample == self.decoded).count();
            let (now, later) = events.split_at(own);
            events = later;
            row.fill(0);
            let mut value = [0.0];
            let is_code = self.shape.put_all(now, &mut row)
                && self.running.decode(&row, &mut Values::F64(&mut value)).is_ok();
            if let (false, Some(first)) = (is_code, now.first()) {
                return Err(*first);
            }
            values.extend(value);
            self.decoded += 1;
        }
        self.row = row;
        Ok(())
    }

    /// Returns the state of encoder and decoder as bytes.
    ///
    /// # Errors
    /// Returns an error if the state cannot be written; no such state is known.
    #[cfg(feature = "states")]
    pub fn state(&self) -> Result<Vec<u8>> {
        self.running.state()
    }

    /// Restores a state that [`state`](Self::state) returned for a codec of the same scheme.
    ///
    /// # Errors
    /// Returns an error if the bytes are damaged, or belong to another scheme.
    #[cfg(feature = "states")]
    pub fn set_state(&mut self, bytes: &[u8]) -> Result<()> {
        self.running.set_state(bytes)
    }
}

impl Shape {
    /// Returns the index of a spike's cell; `None` if there is no such neuron or sub-timestep.
    fn cell(self, neuron: u16, slot: u16) -> Option<usize> {
        let (neuron, slot) = (usize::from(neuron), usize::from(slot));
        (neuron < self.neurons && slot < self.slots).then_some(slot * self.neurons + neuron)
    }

    /// Adds events to a row. Returns false if a cell does not exist, or if two events in a cell contradict each other.
    fn put_all(self, events: &[Event], row: &mut [i8]) -> bool {
        events.iter().all(|event| {
            let cell = self.cell(event.neuron, event.slot).and_then(|cell| row.get_mut(cell));
            let step = step(event.polarity);
            cell.is_some_and(|cell| {
                let is_good = i32::from(*cell) * i32::from(step) >= 0;
                let sum = cell.checked_add(step);
                *cell = sum.unwrap_or(*cell);
                is_good && sum.is_some()
            })
        })
    }
}

/// The destination of codes.
enum Sink<'a> {
    /// Rows of cells; `made` is the number written so far.
    Cells { rows: &'a mut [i8], shape: Shape, made: usize },
    /// A list of events; `sample` is the index of the next sample.
    Events { events: &'a mut Vec<Event>, sample: u64 },
}

impl Sink<'_> {
    /// Writes the first `count` outputs of a vector to cells, many at once. Returns false if the outputs are not spikes,
    /// or do not go to cells.
    fn put_spikes(&mut self, outputs: &dyn Any, count: usize) -> bool {
        let (Self::Cells { rows, made, .. }, Some(spikes)) =
            (self, outputs.downcast_ref::<Vec<Spike>>())
        else {
            return false;
        };
        let cells = rows.get_mut(*made..).unwrap_or_default();
        let spikes = &spikes[..count.min(cells.len())];
        for (cell, spike) in cells.iter_mut().zip(spikes) {
            *cell = *spike as i8;
        }
        *made += spikes.len();
        true
    }

    fn put(&mut self, codes: impl Iterator<Item: Code + 'static>) {
        match self {
            Self::Cells { rows, shape, made } => {
                let width = shape.neurons * shape.slots;
                let rows = rows.get_mut(*made * width..).unwrap_or_default();
                if width == 1 {
                    for (cell, code) in rows.iter_mut().zip(codes) {
                        *cell = code
                            .firings()
                            .fold(0, |sum: i8, firing| sum.saturating_add(step(firing.polarity)));
                        *made += 1;
                    }
                } else {
                    for (row, code) in rows.chunks_exact_mut(width).zip(codes) {
                        put(code, *shape, row);
                        *made += 1;
                    }
                }
            }
            Self::Events { events, sample } => {
                for code in codes {
                    let of = |NeuronSpike { neuron, slot, polarity }| Event {
                        sample: *sample,
                        neuron,
                        slot,
                        polarity,
                    };
                    events.extend(code.firings().map(of));
                    *sample += 1;
                }
            }
        }
    }

    /// Returns the number of rows written, or the index of the next sample.
    fn made(&self) -> usize {
        match self {
            Self::Cells { made, .. } => *made,
            Self::Events { sample, .. } => *sample as usize,
        }
    }
}

/// Adds the spikes of a code to a row.
fn put<C: Code + 'static>(code: C, shape: Shape, row: &mut [i8]) {
    // Digit by digit, which costs less than to look for the ones.
    if let Some(bits) = (&code as &dyn Any).downcast_ref::<PhaseBits<8>>()
        && let Ok(row) = <&mut [i8; 8]>::try_from(&mut *row)
    {
        *row = array::from_fn(|slot| (bits.digits() >> (7 - slot) & 1) as i8);
        return;
    }
    for NeuronSpike { neuron, slot, polarity } in code.firings() {
        if let Some(cell) = shape.cell(neuron, slot).and_then(|cell| row.get_mut(cell)) {
            *cell = cell.saturating_add(step(polarity));
        }
    }
}

/// Returns what a spike adds to its cell.
fn step(polarity: Polarity) -> i8 {
    match polarity {
        Polarity::Up => 1,
        Polarity::Down => -1,
    }
}

/// A codec that processes many samples in a call, so that the dynamic call costs nothing.
trait Running {
    fn latency(&self) -> usize;
    fn has_lanes(&self) -> bool;
    fn restart(&mut self, past: &[f64]);
    fn encode_channels(&mut self, samples: Samples, length: usize, channel: u64, cells: &mut [i8]);
    fn encode(&mut self, samples: Samples, sink: &mut Sink);
    fn finish(&mut self, sink: &mut Sink);
    fn decode(&mut self, cells: &[i8], values: &mut Values) -> Result<(), usize>;
    #[cfg(feature = "states")]
    fn state(&self) -> Result<Vec<u8>>;
    #[cfg(feature = "states")]
    fn set_state(&mut self, bytes: &[u8]) -> Result<()>;
}

/// The visitor that starts a codec.
pub(super) struct Start<'a> {
    pub(super) settings: &'a Settings,
    pub(super) shape: Shape,
    /// Value from which decoders that add up steps start; 0 if `None`.
    pub(super) first: Option<f64>,
}

impl<S: Sample> Visit<S> for Start<'_> {
    type Output = Codec;

    fn visit<P: Runs<S>>(self, scheme: P, start: P::EncoderState) -> Result<Codec> {
        let Self { settings, shape, first } = self;
        let mut running = Box::new(Channel {
            encoder: start.clone(),
            start,
            decoder: scheme.decoder_state(),
            silent: P::Code::assemble(std::iter::empty()),
            has_first: first.is_some(),
            starts_at_first: settings.starts_at_first(),
            is_first_held: false,
            one: settings.sample.one(),
            begins_with: settings.begins_with(),
            seed: settings.seed(),
            shape,
            seen: vec![0; shape.neurons * shape.slots],
            past: Vec::new(),
            block: Vec::new(),
            outputs: Vec::new(),
            lanes: Lanes::of(&scheme),
            scheme,
        });
        running.begin(&settings.first, first);
        Ok(Codec { running, shape, coded: 0, decoded: 0, row: Vec::new() })
    }
}

/// A scheme with the states of one channel.
struct Channel<P: Scheme> {
    scheme: P,
    /// The encoder before any sample.
    start: P::EncoderState,
    encoder: P::EncoderState,
    decoder: P::DecoderState,
    /// The scheme for several channels at once, where that is faster.
    lanes: Option<Lanes>,
    /// The code without spikes.
    silent: P::Code,
    /// Whether the decoder starts from a value, and whether that is the value of the first sample.
    has_first: bool,
    starts_at_first: bool,
    /// Whether the decoder holds the value of the next sample already, so that this sample's spike changes nothing.
    is_first_held: bool,
    /// The number that represents 1 in the sample type.
    one: f64,
    /// Number of a recording's own samples from which its encoder starts; `None` if all start alike.
    begins_with: Option<usize>,
    /// The seed of a code by chance.
    seed: Option<u64>,
    shape: Shape,
    /// A row of cells, for comparisons.
    seen: Vec<i8>,
    /// The samples from which the encoder starts.
    past: Vec<P::Sample>,
    /// Room for a block of samples and for what becomes of them.
    block: Vec<P::Sample>,
    outputs: Vec<P::Output>,
}

impl<P: Scheme<EncoderState: Clone> + 'static> Channel<P> {
    /// Begins a recording with these samples; the decoder starts from `first` if there is one.
    fn begin(&mut self, past: &[f64], first: Option<f64>) {
        self.encoder.clone_from(&self.start);
        let one = self.one;
        self.past.clear();
        self.past.extend(past.iter().map(|value| sample::<P::Sample>(*value, one)));
        self.scheme.prime(&mut self.encoder, &self.past);
        self.decoder = self.scheme.decoder_state();
        if let Some(first) = first {
            self.scheme.resync(&mut self.decoder, sample(first, one));
        }
        self.is_first_held = self.starts_at_first;
    }

    /// Begins the encoder of a channel that starts with these samples.
    fn begin_encoder<T: Pod + Into<f64>>(&mut self, channel: u64, samples: &[T]) {
        self.encoder.clone_from(&self.start);
        if let Some(seed) = self.seed {
            let (generator, state) = (generator(seed, channel), &mut self.encoder as &mut dyn Any);
            if let Some(state) = state.downcast_mut::<BernoulliState<Pcg32>>() {
                *state = Bernoulli::<f32, _, Average>::state(generator);
            } else if let Some(state) = state.downcast_mut::<ProbabilisticState<Pcg32>>() {
                *state = Probabilistic::<f32, _, 3, 16>::state(generator);
            }
        }
        if let Some(count) = self.begins_with {
            let one = self.one;
            self.past.clear();
            self.past
                .extend(samples.iter().take(count).map(|value| sample::<P::Sample>(*value, one)));
        }
        self.scheme.prime(&mut self.encoder, &self.past);
    }

    /// Encodes in blocks, for which schemes have faster code.
    fn encode_all<T: Pod + Into<f64>>(&mut self, samples: &[T], sink: &mut Sink) {
        const BLOCK: usize = 512;
        const KEPT: usize = 64;
        let one = self.one;
        // Samples of the scheme's own type are taken where they are.
        let is_own = one == 1.0 && TypeId::of::<T>() == TypeId::of::<P::Sample>();
        for samples in samples.chunks(BLOCK) {
            let block: &[P::Sample] = if is_own {
                cast_slice(samples)
            } else {
                self.block.clear();
                self.block.extend(samples.iter().map(|value| sample::<P::Sample>(*value, one)));
                &self.block
            };
            if self.outputs.len() < block.len() {
                // Any output will do to make room for others.
                let any = self.scheme.encode(&mut self.encoder.clone(), block[0]);
                self.outputs.resize(block.len(), any);
            }
            let Self { scheme, encoder, outputs, .. } = self;
            let count = chance::encode_slice(scheme, encoder, block, outputs)
                .unwrap_or_else(|| scheme.encode_slice(encoder, block, outputs));
            if !sink.put_spikes(&self.outputs, count) {
                sink.put(self.outputs.iter().take(count).filter_map(|output| output.code()));
            }
        }
        // Codes of large populations take too much room to be kept for each channel.
        if size_of::<P::Output>() > KEPT {
            self.outputs = Vec::new();
        }
    }

    /// Encodes recordings, at once in lanes where that is faster; see [`Codec::encode_channels`].
    fn encode_each<T: Pod + Into<f64>>(
        &mut self,
        samples: &[T],
        length: usize,
        channel: u64,
        cells: &mut [i8],
    ) {
        let (shape, width) = (self.shape, length * self.seen.len());
        let count = samples.len() / length;
        let (samples, cells) = (&samples[..count * length], &mut cells[..count * width]);
        let least = self.lanes.as_ref().map_or(usize::MAX, Lanes::least);
        let mut uses_lanes = self.lanes.as_ref().is_some_and(|lanes| !lanes.is_slow_at_rest());
        for place in 0..count {
            let (rest, rows) = (&samples[place * length..], &mut cells[place * width..]);
            if uses_lanes && count - place >= least && self.encode_in_lanes(rest, length, rows) {
                return;
            }
            let (own, rows) = (&rest[..length], &mut rows[..width]);
            let mut sink = Sink::Cells { rows, shape, made: 0 };
            self.begin_encoder(channel + place as u64, own);
            self.encode_all(own, &mut sink);
            self.finish_all(&mut sink);
            let is_slow = self.lanes.as_ref().is_some_and(Lanes::is_slow_at_rest);
            uses_lanes = is_slow && is_dense(&cells[place * width..][..width]);
        }
    }

    /// Encodes recordings at once, if that is faster; returns whether it has.
    fn encode_in_lanes<T: Pod + Into<f64>>(
        &mut self,
        samples: &[T],
        length: usize,
        cells: &mut [i8],
    ) -> bool {
        // Only schemes of `f32` have lanes, whose past samples are of that type.
        let (Some(lanes), Ok(past)) = (&mut self.lanes, try_cast_slice(&self.past)) else {
            return false;
        };
        let converted: Vec<f32>;
        let samples = if TypeId::of::<T>() == TypeId::of::<f32>() {
            cast_slice(samples)
        } else {
            converted = samples.iter().map(|value| (*value).into() as f32).collect();
            &converted
        };
        let begins_with = self.begins_with;
        let is_done = lanes.encode(Recordings { samples, length, begins_with, past }, cells);
        if !is_done {
            cells.fill(0);
        }
        is_done
    }

    fn finish_all(&mut self, sink: &mut Sink) {
        while let Some(code) = self.scheme.finish_next(&mut self.encoder) {
            sink.put(iter::once(code));
        }
    }

    /// Returns the code of a row; `None` if no encoder emits it.
    fn code(&mut self, row: &[i8]) -> Option<P::Code> {
        if row.iter().all(|cell| *cell == 0) {
            return Some(self.silent);
        }
        let neurons = self.shape.neurons;
        let firings = row.iter().enumerate().flat_map(|(place, cell)| {
            let polarity = if *cell > 0 { Polarity::Up } else { Polarity::Down };
            let (neuron, slot) = ((place % neurons) as u16, (place / neurons) as u16);
            let firing = NeuronSpike { neuron, slot, polarity };
            std::iter::repeat_n(firing, cell.unsigned_abs().into())
        });
        let code = P::Code::assemble(firings);
        self.seen.fill(0);
        put(code, self.shape, &mut self.seen);
        (self.seen == row).then_some(code)
    }

    fn decode_next(&mut self, row: &[i8]) -> Option<P::Sample> {
        let code = self.code(row)?;
        if std::mem::take(&mut self.is_first_held)
            && let Some(held) = self.scheme.held(&self.decoder)
        {
            return Some(held);
        }
        Some(self.scheme.decode(&mut self.decoder, code))
    }

    fn decode_each<T>(
        &mut self,
        cells: &[i8],
        values: &mut [T],
        of: impl Fn(P::Sample) -> T,
    ) -> Result<(), usize> {
        let rows = cells.chunks_exact(self.seen.len());
        for (place, (row, value)) in rows.zip(values).enumerate() {
            *value = of(self.decode_next(row).ok_or(place)?);
        }
        Ok(())
    }
}

/// Whether more than one cell in 16 has a spike, in the middle of a recording.
fn is_dense(cells: &[i8]) -> bool {
    const MOST: usize = 512;
    let middle = &cells[cells.len().saturating_sub(MOST) / 2..];
    let middle = &middle[..middle.len().min(MOST)];
    middle.iter().filter(|cell| **cell != 0).count() > middle.len() / 16
}

/// Brings a value of the signal to a sample type in which `one` stands for 1.
fn sample<S: Sample>(value: impl Into<f64>, one: f64) -> S {
    S::from_f64(value.into() * one)
}

impl<P: Scheme<EncoderState: State + Clone, DecoderState: State> + 'static> Running for Channel<P> {
    fn latency(&self) -> usize {
        self.scheme.latency()
    }

    fn has_lanes(&self) -> bool {
        self.lanes.is_some()
    }

    fn restart(&mut self, past: &[f64]) {
        let first = past.first().copied().filter(|_| self.has_first);
        self.begin(past, first);
    }

    fn encode_channels(&mut self, samples: Samples, length: usize, channel: u64, cells: &mut [i8]) {
        match samples {
            Samples::F32(own) => self.encode_each(own, length, channel, cells),
            Samples::F64(own) => self.encode_each(own, length, channel, cells),
            Samples::I16(own) => self.encode_each(own, length, channel, cells),
        }
    }

    fn encode(&mut self, samples: Samples, sink: &mut Sink) {
        match samples {
            Samples::F32(own) => self.encode_all(own, sink),
            Samples::F64(own) => self.encode_all(own, sink),
            Samples::I16(own) => self.encode_all(own, sink),
        }
    }

    fn finish(&mut self, sink: &mut Sink) {
        self.finish_all(sink);
    }

    fn decode(&mut self, cells: &[i8], values: &mut Values) -> Result<(), usize> {
        let one = self.one;
        match values {
            Values::F32(room) => self.decode_each(cells, room, |own| (own.to_f64() / one) as f32),
            Values::F64(room) => self.decode_each(cells, room, |own| own.to_f64() / one),
            Values::I16(room) => self.decode_each(cells, room, |own| (own.to_f64() / one) as i16),
        }
    }

    #[cfg(feature = "states")]
    fn state(&self) -> Result<Vec<u8>> {
        let states = (&self.encoder, &self.decoder, self.is_first_held);
        postcard::to_allocvec(&states).map_err(|_| ErrorKind::UnwrittenState.into())
    }

    #[cfg(feature = "states")]
    fn set_state(&mut self, bytes: &[u8]) -> Result<()> {
        let read = postcard::take_from_bytes::<(P::EncoderState, P::DecoderState, bool)>(bytes);
        let ((encoder, decoder, is_first_held), rest) =
            read.map_err(|_| ErrorKind::DamagedState)?;
        if !(rest.is_empty() && self.scheme.fits(&encoder) && self.scheme.fits_decoder(&decoder)) {
            return Err(ErrorKind::DamagedState.into());
        }
        (self.encoder, self.decoder, self.is_first_held) = (encoder, decoder, is_first_held);
        Ok(())
    }
}
