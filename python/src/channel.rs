//! One channel of any scheme: samples to cells and back.
//!
//! The code of a sample is a row of cells, one for each neuron of each sub-timestep. A cell holds how many spikes went
//! up less how many went down: -1, 0 or 1, or more where a code sends several spikes a sample.

use anyhow::{Context, Result, ensure};
use catalogue::run::{RunTime, SampleType, Settings, Visit};
use catalogue::{State, for_sample_type};
use spikewire::{Code, NeuronSpike, Output, Polarity, Sample, SampleKind, Scheme};

use crate::array::{Lane, Values};

/// What was wrong with which sample, counted from the first of the call.
pub(crate) struct Bad {
    /// The sample.
    pub sample: usize,
    /// What is wrong.
    pub what: String,
}

/// An encoder or a decoder, or both, in the signal's unit.
pub(crate) trait Channel: Send + Sync {
    /// How many samples after its own the code of a sample comes out.
    fn latency(&self) -> usize;

    /// Encodes samples into rows of cells, which are all 0, and returns how many rows that made.
    ///
    /// # Errors
    /// A sample is not finite, or not so in the sample type.
    fn encode(&mut self, samples: Lane, cells: &mut [i8]) -> Result<usize, Bad>;

    /// The rows of the samples that still wait for later ones.
    fn finish(&mut self, cells: &mut [i8]) -> usize;

    /// Decodes as many rows of cells as there is room for values.
    ///
    /// # Errors
    /// No encoder makes such a row.
    fn decode(&mut self, cells: &[i8], values: &mut Values) -> Result<(), Bad>;

    /// All that it keeps from sample to sample, as bytes.
    ///
    /// # Errors
    /// None that is known.
    fn state(&self) -> Result<Vec<u8>>;

    /// Goes on from what [`state`](Self::state) gave, of a channel of the same scheme.
    ///
    /// # Errors
    /// It is damaged, or another scheme's.
    fn set_state(&mut self, bytes: &[u8]) -> Result<()>;
}

/// A channel as it starts on these settings, which are complete; its decoder from a value, if there is one.
///
/// # Errors
/// A parameter makes no sense.
pub(crate) fn start(
    scheme: &'static dyn RunTime,
    settings: &Settings,
    first: Option<f64>,
) -> Result<Box<dyn Channel>> {
    let shape = scheme.shape(settings)?;
    let one = settings.sample.one();
    let start = Start { settings, one, first, neurons: shape.neurons, slots: shape.slots };
    for_sample_type!(settings.sample, S => catalogue::visit::<S, _>(scheme.info().name, settings, start))
}

struct Start<'a> {
    settings: &'a Settings,
    one: f64,
    first: Option<f64>,
    neurons: usize,
    slots: usize,
}

impl<S: Sample> Visit<S> for Start<'_> {
    type Output = Box<dyn Channel>;

    fn visit<P>(self, scheme: P, mut encoder: P::EncoderState) -> Result<Box<dyn Channel>>
    where
        P: Scheme<
                Sample = S,
                EncoderState: State + Send + Sync,
                DecoderState: State + Send + Sync,
                Code: Send + Sync,
            > + Send
            + Sync
            + 'static,
    {
        let Self { settings, one, first, neurons, slots } = self;
        let sample = |value: f64| S::from_f64(value * one);
        let past: Vec<S> = settings.first.iter().copied().map(sample).collect();
        scheme.prime(&mut encoder, &past);
        let mut decoder = scheme.decoder_state();
        if let Some(first) = settings.first_value().or(first) {
            scheme.resync(&mut decoder, sample(first));
        }
        Ok(Box::new(Running {
            encoder,
            decoder,
            silent: P::Code::assemble(std::iter::empty()),
            is_first_held: settings.starts_at_first(),
            sample: settings.sample,
            one,
            neurons,
            slots,
            seen: vec![0; neurons * slots],
            scheme,
        }))
    }
}

/// A scheme with the states of one channel.
struct Running<P: Scheme> {
    scheme: P,
    encoder: P::EncoderState,
    decoder: P::DecoderState,
    /// The code without spikes.
    silent: P::Code,
    /// Whether the decoder holds the value of the sample that comes next, whose spike then changes nothing.
    is_first_held: bool,
    sample: SampleType,
    /// What a 1 of the signal is in the unit of the sample type.
    one: f64,
    neurons: usize,
    slots: usize,
    /// A row of cells, to compare.
    seen: Vec<i8>,
}

impl<P: Scheme> Running<P> {
    fn put(&self, code: P::Code, row: &mut [i8]) {
        for NeuronSpike { neuron, slot, polarity } in code.firings() {
            let cell = usize::from(slot) * self.neurons + usize::from(neuron);
            if let Some(cell) = row.get_mut(cell) {
                *cell = cell.saturating_add(if polarity == Polarity::Up { 1 } else { -1 });
            }
        }
    }

    /// Encodes in blocks, which schemes have faster code for.
    fn encode_all(
        &mut self,
        mut samples: impl Iterator<Item = P::Sample>,
        cells: &mut [i8],
    ) -> usize {
        const BLOCK: usize = 512;
        let mut rows = cells.chunks_exact_mut(self.neurons * self.slots);
        let mut made = 0;
        let mut put = |own: &Self, output: P::Output| {
            if let Some(code) = output.code()
                && let Some(row) = rows.next()
            {
                own.put(code, row);
                made += 1;
            }
        };
        let Some(first) = samples.next() else { return 0 };
        // It also stands in the room for the others.
        let first = self.scheme.encode(&mut self.encoder, first);
        put(self, first);
        let (mut block, mut outputs) = (Vec::with_capacity(BLOCK), vec![first; BLOCK]);
        loop {
            block.clear();
            block.extend(samples.by_ref().take(BLOCK));
            let count = self.scheme.encode_slice(&mut self.encoder, &block, &mut outputs);
            if count == 0 {
                return made;
            }
            outputs.iter().take(count).for_each(|output| put(self, *output));
        }
    }

    /// The code of a row, unless there is none.
    fn code(&mut self, row: &[i8]) -> Option<P::Code> {
        if row.iter().all(|cell| *cell == 0) {
            return Some(self.silent);
        }
        let neurons = self.neurons;
        let firings = row.iter().enumerate().flat_map(|(place, cell)| {
            let polarity = if *cell > 0 { Polarity::Up } else { Polarity::Down };
            let (neuron, slot) = ((place % neurons) as u16, (place / neurons) as u16);
            let firing = NeuronSpike { neuron, slot, polarity };
            std::iter::repeat_n(firing, cell.unsigned_abs().into())
        });
        let code = P::Code::assemble(firings);
        let mut seen = std::mem::take(&mut self.seen);
        seen.fill(0);
        self.put(code, &mut seen);
        let is_same = seen == row;
        self.seen = seen;
        is_same.then_some(code)
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
    ) -> Result<(), Bad> {
        let rows = cells.chunks_exact(self.neurons * self.slots);
        for (place, (row, value)) in rows.zip(values).enumerate() {
            let decoded = self.decode_next(row).ok_or_else(|| Bad {
                sample: place,
                what: format!("{row:?} is no code of a sample"),
            })?;
            *value = of(decoded);
        }
        Ok(())
    }
}

impl<P> Channel for Running<P>
where
    P: Scheme<
            EncoderState: State + Send + Sync,
            DecoderState: State + Send + Sync,
            Code: Send + Sync,
        > + Send
        + Sync,
{
    fn latency(&self) -> usize {
        self.scheme.latency()
    }

    fn encode(&mut self, samples: Lane, cells: &mut [i8]) -> Result<usize, Bad> {
        if let Some(bad) = samples.bad(self.sample) {
            return Err(bad);
        }
        let one = self.one;
        let sample = |value: f64| P::Sample::from_f64(value * one);
        Ok(match samples {
            Lane::F32(lane) if P::Sample::KIND == SampleKind::F32 => {
                let as_is = lane.iter().map(|value| P::Sample::from_bits32(value.to_bits()));
                self.encode_all(as_is, cells)
            }
            Lane::F32(lane) => {
                self.encode_all(lane.iter().map(|value| sample((*value).into())), cells)
            }
            Lane::F64(lane) => self.encode_all(lane.iter().map(|value| sample(*value)), cells),
            Lane::I16(lane) => {
                self.encode_all(lane.iter().map(|value| sample((*value).into())), cells)
            }
        })
    }

    fn finish(&mut self, cells: &mut [i8]) -> usize {
        let mut made = 0;
        for row in cells.chunks_exact_mut(self.neurons * self.slots) {
            let Some(code) = self.scheme.finish_next(&mut self.encoder) else { break };
            self.put(code, row);
            made += 1;
        }
        made
    }

    fn decode(&mut self, cells: &[i8], values: &mut Values) -> Result<(), Bad> {
        let one = self.one;
        match values {
            Values::F32(values) => {
                self.decode_each(cells, values, |value| (value.to_f64() / one) as f32)
            }
            Values::F64(values) => self.decode_each(cells, values, |value| value.to_f64() / one),
            Values::I16(values) => {
                self.decode_each(cells, values, |value| (value.to_f64() / one) as i16)
            }
        }
    }

    fn state(&self) -> Result<Vec<u8>> {
        Ok(postcard::to_allocvec(&(&self.encoder, &self.decoder, self.is_first_held))?)
    }

    fn set_state(&mut self, bytes: &[u8]) -> Result<()> {
        let read = postcard::take_from_bytes::<(P::EncoderState, P::DecoderState, bool)>(bytes);
        let ((encoder, decoder, is_first_held), rest) = read.context("the state is damaged")?;
        ensure!(
            rest.is_empty() && self.scheme.fits(&encoder) && self.scheme.fits_decoder(&decoder),
            "the state is damaged, or another scheme's"
        );
        (self.encoder, self.decoder, self.is_first_held) = (encoder, decoder, is_first_held);
        Ok(())
    }
}
