//! Several channels of a recording, each with a codec of its own.

use crate::Result;
use crate::scheme::Scheme;
use crate::tune::RequestKind;
use catalogue::run::{Codec, Event, Settings};

/// Codecs of one scheme, one for each channel. Neurons are numbered across all channels: the neurons of channel 1
/// follow the neurons of channel 0.
pub struct Bank {
    codecs: Vec<Codec>,
    neurons: u16,
    /// Buffer for the events of one channel.
    buffer: Vec<Event>,
}

impl Bank {
    /// Makes a codec for each channel, ready for the first sample of a recording. A stochastic code gets a separate
    /// stream of random numbers for each channel.
    ///
    /// # Errors
    /// Returns an error if a parameter is invalid, or if all channels together have more than 65 536 neurons.
    pub fn new(scheme: Scheme, channels: &[Settings]) -> Result<Self> {
        let neurons = match channels.first() {
            Some(settings) => scheme.shape(settings)?.neurons,
            None => 1,
        };
        if channels.len() * neurons > usize::from(u16::MAX) + 1 {
            let kind = RequestKind::Addresses { channels: channels.len(), neurons };
            return Err(kind.into());
        }
        let codecs = (0..)
            .zip(channels)
            .map(|(stream, settings)| scheme.codec(&settings.with_stream(stream)));
        let codecs = codecs.collect::<Result<_, _>>()?;
        Ok(Self { codecs, neurons: neurons as u16, buffer: Vec::new() })
    }

    /// Returns the number of neurons of each channel.
    pub fn neurons(&self) -> usize {
        self.neurons.into()
    }

    /// Returns the latency of the code: the number of samples by which the encoder's output lags behind its input.
    pub fn latency(&self) -> usize {
        self.codecs.first().map_or(0, Codec::latency)
    }

    /// Encodes the next samples of all channels, and appends their events. All samples must be finite.
    pub fn encode(&mut self, columns: &[Vec<f64>], events: &mut Vec<Event>) {
        let mut columns = columns.iter();
        self.collect(events, |codec, own| {
            if let Some(column) = columns.next() {
                codec.encode(column, own);
            }
        });
    }

    /// Ends the recording: encodes the last samples, which the encoders held back to look ahead, and appends their
    /// events.
    pub fn finish(&mut self, events: &mut Vec<Event>) {
        self.collect(events, Codec::finish);
    }

    /// Calls `take` on each channel's codec, and appends the events of all codecs. The events are sorted by sample,
    /// then by slot (sub-timestep), then by channel.
    fn collect(
        &mut self,
        events: &mut Vec<Event>,
        mut take: impl FnMut(&mut Codec, &mut Vec<Event>),
    ) {
        if let [codec] = self.codecs.as_mut_slice() {
            return take(codec, events);
        }
        let before = events.len();
        for (codec, channel) in self.codecs.iter_mut().zip(0..) {
            take(codec, &mut self.buffer);
            let first = channel * self.neurons;
            let own = self.buffer.drain(..);
            events.extend(own.map(|event| Event { neuron: first + event.neuron, ..event }));
        }
        events[before..].sort_by_key(|event| (event.sample, event.slot));
    }

    /// Decodes the next samples of all channels from their events.
    ///
    /// # Errors
    /// Returns an error if a sample has a combination of events that no encoder can emit. The error is the sample's
    /// first event.
    pub fn decode(
        &mut self,
        samples: usize,
        events: &[Event],
        columns: &mut [Vec<f64>],
    ) -> Result<(), Event> {
        if let ([codec], [column]) = (self.codecs.as_mut_slice(), &mut *columns) {
            return codec.decode(samples, events, column);
        }
        for ((codec, channel), column) in self.codecs.iter_mut().zip(0..).zip(columns) {
            let first = channel * self.neurons;
            self.buffer.clear();
            let is_own = |event: &&Event| event.neuron / self.neurons == channel;
            let own = events.iter().filter(is_own);
            self.buffer.extend(own.map(|event| Event { neuron: event.neuron - first, ..*event }));
            codec.decode(samples, &self.buffer, column)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{Bank, Scheme};
    use catalogue::run::{Asked, Known, SampleType};

    /// With a stochastic code, two channels fire at different times even if their values and settings are the same.
    #[test]
    fn channels_draw_apart() {
        for name in ["bernoulli", "grf-prob"] {
            let scheme = Scheme::named(name).unwrap();
            let mut asked = Asked::default();
            asked.set("min", 0.0);
            asked.set("max", 1.0);
            if scheme.info().parameter("neurons").is_some() {
                asked.set("neurons", 15_u64);
            }
            let known = Known { calibrated: None, first: &[0.5], can_calibrate: false };
            let settings = scheme.resolve(SampleType::F32, &asked, &known).unwrap();
            let mut bank = Bank::new(scheme, &vec![settings; 4]).unwrap();
            let (mut events, neurons) = (Vec::new(), bank.neurons() as u16);
            bank.encode(&vec![vec![0.43; 200]; 4], &mut events);
            let own = |channel| -> Vec<(u64, u16)> {
                let of = events.iter().filter(|event| event.neuron / neurons == channel);
                of.map(|event| (event.sample, event.neuron % neurons)).collect()
            };
            for channel in 1..4 {
                assert_ne!(own(channel), own(0), "{name}");
            }
        }
    }
}
