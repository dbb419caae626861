//! Every scheme of the catalogue on one channel.

use core::marker::PhantomData;

use catalogue::{Channel, Flight};
use spikewire::{Calibration, Code, ConfigError, Encoder, Output, Sample, Scheme};

use crate::flight::{Recorded, channel};

/// Takes down what a scheme does with a channel.
pub trait Log {
    /// One outcome of the encoder; no spike is one too.
    fn code(&mut self, code: &impl Code);

    /// What the decoder makes of it, beside the sample it stands for.
    fn decoded<S: Sample>(&mut self, sample: S, value: S);
}

/// Has a log for every scheme.
pub trait Logs {
    /// What takes down.
    type Log: Log;

    /// The log of a scheme with this name and this latency in samples, on one channel.
    fn log(&mut self, name: &'static str, latency: usize) -> &mut Self::Log;
}

/// Flies every scheme on one channel, with parameters that its calibration gives.
pub fn fly<S: Recorded>(index: usize, logs: &mut impl Logs) -> Result<(), ConfigError> {
    let mut calibration = Calibration::<S>::new();
    channel::<S>(index).for_each(|sample| calibration.observe(sample));
    let channel = Channel::new(index, calibration);
    catalogue::fly(&channel, &mut Flown { index, logs, sample: PhantomData })
}

struct Flown<'l, S, L> {
    index: usize,
    logs: &'l mut L,
    sample: PhantomData<S>,
}

impl<S: Recorded, L: Logs> Flight for Flown<'_, S, L> {
    type Sample = S;
    type Error = ConfigError;

    /// From samples to spikes and back. The decoder starts where the signal does, if it adds up steps.
    fn visit<P: Scheme<Sample = S>>(
        &mut self,
        name: &'static str,
        _: &'static str,
        scheme: &P,
        start: P::EncoderState,
    ) -> Result<(), ConfigError> {
        let log = self.logs.log(name, P::LATENCY);
        let mut truth = channel::<S>(self.index);
        let mut encoder = Encoder::with_state(scheme, start);
        let mut decoder = scheme.decoder();
        truth.clone().take(1).for_each(|first| decoder.resync(first));
        let mut receive = |code| {
            log.code(&code);
            let value = decoder.decode(code);
            truth.next().into_iter().for_each(|sample| log.decoded(sample, value));
        };
        let samples = channel::<S>(self.index);
        samples.filter_map(|sample| encoder.encode(sample).code()).for_each(&mut receive);
        encoder.finish().for_each(receive);
        Ok(())
    }
}
