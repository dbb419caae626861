//! Samples of all channels of a flight to the messages of their spikes.

use crate::clock::Clock;
use crate::codec::{Codec, Request};
use crate::counters::Counters;
use crate::encoding::{Coded, Encoding};
use crate::wire::{FlightSpikes, FlightValues, Header, Spike};
use anyhow::Result;
use spikewire_flight::{Filtering, Flight};
use std::collections::VecDeque;

/// Encodes samples of a flight's channels as they come, and decodes their spikes at once.
pub(crate) struct Bank {
    flight: Flight,
    channels: Vec<Encoding>,
    filters: Vec<Filtering>,
    clock: Clock,
    /// Headers of the samples whose spikes are still to come.
    headers: VecDeque<Header>,
    /// Number of samples coded.
    coded: u64,
}

impl Bank {
    /// # Errors
    /// The scheme cannot run with the flight's parameters.
    pub(crate) fn new(flight: Flight, gap: f64) -> Result<Self> {
        let channel = |at| Encoding::new(Request::of_flight(&flight, at));
        Ok(Self {
            channels: (0..flight.channels.len()).map(channel).collect::<Result<_>>()?,
            filters: flight.filters()?,
            clock: Clock::new(gap),
            headers: VecDeque::new(),
            coded: 0,
            flight,
        })
    }

    /// Returns the fields that the channels come from, in order.
    pub(crate) fn sources(&self) -> Vec<String> {
        self.flight.channels.iter().map(|channel| channel.source.clone()).collect()
    }

    /// Takes a sample: a value of each channel, in the flight's units. One with a value that is not finite is counted
    /// and emits nothing.
    ///
    /// # Errors
    /// The samples tell a parameter that is not good.
    pub(crate) fn take(
        &mut self,
        values: &[f64],
        header: Header,
        counters: &mut Counters,
    ) -> Result<Vec<(FlightSpikes, FlightValues)>> {
        let stamp = header.stamp.to_nanos();
        self.clock.observe(stamp, counters);
        let mut samples: Vec<f64> = values
            .iter()
            .zip(&self.flight.channels)
            .map(|(value, own)| value * own.counts)
            .collect();
        if let Some(bad) = samples.iter().find(|sample| !(**sample as f32).is_finite()) {
            counters.add("samples not finite", 1, &bad.to_string());
            return Ok(Vec::new());
        }
        for (sample, filter) in samples.iter_mut().zip(&mut self.filters) {
            *sample = filter(*sample);
        }
        self.headers.push_back(header);
        let channels = self.channels.iter_mut().zip(samples);
        let coded = channels.map(|(channel, sample)| channel.take(sample, stamp, counters));
        let coded = coded.collect::<Result<_>>()?;
        Ok(self.messages(coded))
    }

    /// Returns what is left when no more samples come.
    ///
    /// # Errors
    /// The samples tell a parameter that is not good.
    pub(crate) fn end(
        &mut self,
        counters: &mut Counters,
    ) -> Result<Vec<(FlightSpikes, FlightValues)>> {
        let coded = self.channels.iter_mut().map(|channel| channel.end(counters));
        let coded = coded.collect::<Result<_>>()?;
        Ok(self.messages(coded))
    }

    /// Makes messages of the samples that all channels have coded. Channels have one scheme and so one latency.
    fn messages(&mut self, coded: Vec<Vec<Coded>>) -> Vec<(FlightSpikes, FlightValues)> {
        let neurons = self.flight.neurons();
        let mut channels: Vec<_> = coded.into_iter().map(Vec::into_iter).collect();
        let mut all = Vec::new();
        while let Some(row) = channels.iter_mut().map(Iterator::next).collect::<Option<Vec<_>>>() {
            let Some(header) = self.headers.pop_front() else { break };
            let mut spikes = Vec::new();
            for (channel, coded) in row.iter().enumerate() {
                let cells = coded.spikes.iter().enumerate().filter(|(_, cell)| **cell != 0);
                spikes.extend(cells.map(|(at, cell)| Spike {
                    address: (channel * neurons + at % neurons) as u16,
                    slot: (at / neurons) as u16,
                    polarity: *cell,
                }));
            }
            let values = row.iter().zip(&self.flight.channels);
            let values = values.map(|(coded, own)| coded.decoded / own.counts).collect();
            let start = row.iter().map(|coded| coded.said.start).collect();
            let sample = self.coded;
            self.coded += 1;
            all.push((
                FlightSpikes { header: header.clone(), sample, spikes, start },
                FlightValues { header, values },
            ));
        }
        all
    }
}

/// Decodes what a [`Bank`] of the same flight sends.
pub(crate) struct Unbank {
    flight: Flight,
    clock: Clock,
    /// The encoder's start and number of the last sample, and the decoder of each channel.
    started: Option<(Vec<f32>, u64, Vec<Codec>)>,
}

impl Unbank {
    pub(crate) fn new(flight: Flight, gap: f64) -> Self {
        Self { flight, clock: Clock::new(gap), started: None }
    }

    /// Returns the values, unless the message is none of the flight's: that is counted, and the decoders start anew.
    ///
    /// # Errors
    /// The scheme cannot run with the flight's parameters.
    pub(crate) fn take(
        &mut self,
        message: &FlightSpikes,
        counters: &mut Counters,
    ) -> Result<Option<Vec<f64>>> {
        self.clock.observe(message.header.stamp.to_nanos(), counters);
        let FlightSpikes { sample, start, .. } = message;
        let (codecs, is_new) = match self.started.take() {
            Some((own, last, codecs)) if own == *start && last < *sample => (codecs, false),
            other => {
                if other.is_some() {
                    counters.add("new starts of the encoder", 1, "");
                }
                (self.start(start)?, true)
            }
        };
        if is_new && *sample > 0 && self.flight.scheme.has_first_value() {
            let detail = format!(
                "the first sample heard is number {sample}: values are off by what was missed"
            );
            counters.add("starts in the middle", 1, &detail);
        }
        let (codecs, values) = self.decode(codecs, message);
        if values.is_some() {
            self.started = Some((start.clone(), *sample, codecs));
        } else {
            counters.add("messages refused", 1, "no codes of the flight's scheme");
        }
        Ok(values)
    }

    fn start(&self, start: &[f32]) -> Result<Vec<Codec>> {
        let channels = start.iter().take(self.flight.channels.len()).enumerate();
        let neurons = self.flight.neurons();
        channels
            .map(|(at, first)| {
                Request::of_flight(&self.flight, at).receive(&[], neurons, f64::from(*first))
            })
            .collect()
    }

    fn decode(
        &self,
        mut codecs: Vec<Codec>,
        message: &FlightSpikes,
    ) -> (Vec<Codec>, Option<Vec<f64>>) {
        let neurons = self.flight.neurons();
        let mut cells: Vec<_> = codecs.iter().map(|codec| vec![0; codec.width()]).collect();
        for spike in &message.spikes {
            let (channel, neuron) =
                (usize::from(spike.address) / neurons, usize::from(spike.address) % neurons);
            let at = usize::from(spike.slot) * neurons + neuron;
            match cells.get_mut(channel).and_then(|cells| cells.get_mut(at)) {
                Some(cell) => *cell = spike.polarity,
                None => return (codecs, None),
            }
        }
        let all = codecs.iter_mut().zip(&cells).zip(&self.flight.channels);
        let values = all.map(|((codec, cells), own)| Some(codec.decode(cells).ok()? / own.counts));
        let values = values.collect::<Option<Vec<_>>>();
        let is_whole = codecs.len() == self.flight.channels.len();
        (codecs, values.filter(|_| is_whole))
    }
}

#[cfg(test)]
mod tests {
    use super::{Bank, Unbank};
    use crate::counters::Counters;
    use crate::wire::{FlightSpikes, FlightValues, Header, Spike};
    use ros2_client::builtin_interfaces::Time;
    use spikewire_flight::Flight;

    fn flight(scheme: &str) -> Flight {
        let text = format!(
            "version = 1\nperiod = 1000\n{scheme}\n[[channel]]\nname = \"a\"\n[[channel]]\nname = \"b\"\ncounts = 10\n"
        );
        Flight::parse(&text).unwrap()
    }

    fn flown(scheme: &str, samples: &[[f64; 2]]) -> (Vec<(FlightSpikes, FlightValues)>, Counters) {
        let mut bank = Bank::new(flight(scheme), 1.5).unwrap();
        let (mut all, mut counters) = (Vec::new(), Counters::default());
        for (stamp, sample) in (0..).step_by(1_000_000).zip(samples) {
            let header = Header { stamp: Time::from_nanos(stamp), frame_id: "imu".to_owned() };
            all.extend(bank.take(sample, header, &mut counters).unwrap());
        }
        all.extend(bank.end(&mut counters).unwrap());
        (all, counters)
    }

    #[test]
    fn a_sample_with_a_channel_that_is_not_finite_emits_nothing() {
        let sf = "scheme = \"sf\"\nparameters = { threshold = 0.5 }";
        let samples = [[0.0, 0.0], [1.0, f64::NAN], [1.0, -0.1], [f64::MAX, 0.0], [1.0, -0.1]];
        let (all, counters) = flown(sf, &samples);
        assert_eq!(counters.to_string(), "2 samples not finite");
        let stamps: Vec<i64> = all.iter().map(|(one, _)| one.header.stamp.to_nanos()).collect();
        assert_eq!(stamps, [0, 2_000_000, 4_000_000]);
        let spikes = |at: usize| all[at].0.spikes.iter().map(|own| (own.address, own.polarity));
        assert_eq!(spikes(1).collect::<Vec<_>>(), [(0, 1), (1, -1)]);
        // Thresholds are in counts, values in the unit.
        assert_eq!(all[1].1.values, [0.5, -0.05]);
    }

    #[test]
    fn addresses_go_by_channel_and_spikes_that_come_late_have_the_header_of_their_sample() {
        let grf = "scheme = \"grf\"\nparameters = { neurons = 5, min = -1, max = 1 }";
        let samples = [[-1.0, 0.1], [1.0, -0.1], [0.0, 0.0]];
        let (all, _) = flown(grf, &samples);
        for (FlightSpikes { spikes, .. }, _) in &all {
            let channels: Vec<u16> = spikes.iter().map(|spike| spike.address / 5).collect();
            assert_eq!(channels, [0, 1]);
        }
        let hsa = "scheme = \"hsa\"\nparameters = { filter = \"triang:15\", shift = 0 }";
        let samples: Vec<[f64; 2]> = (0..100).map(|at| [f64::from(at % 20), 1.0]).collect();
        let (all, counters) = flown(hsa, &samples);
        let stamps = all.iter().map(|(one, _)| one.header.stamp.to_nanos());
        assert!(stamps.eq((0..100).map(|at| at * 1_000_000)), "{counters}");
    }

    #[test]
    fn messages_decode_to_what_the_encoder_decoded_and_a_late_start_is_counted() {
        let samples: Vec<[f64; 2]> =
            (0..200).map(|at| [(f64::from(at) / 9.0).sin(), f64::from(at % 7) / 5.0]).collect();
        for scheme in [
            "scheme = \"sf\"\nparameters = { threshold = 0.25 }",
            "scheme = \"sod\"\nparameters = { threshold = 0.1, spikes = 4 }",
            "scheme = \"hsa\"\nparameters = { filter = \"triang:15\", shift = -1 }",
            "scheme = \"grf-slots\"\nparameters = { neurons = 5, slots = 4, min = -20, max = 20 }",
        ] {
            let (all, mut counters) = flown(scheme, &samples);
            let mut decoding = Unbank::new(flight(scheme), 1.5);
            for (spikes, values) in &all {
                let decoded = decoding.take(spikes, &mut counters).unwrap();
                assert_eq!(decoded.as_ref(), Some(&values.values), "{scheme}");
            }
            assert!(counters.counts().is_empty(), "{scheme}: {counters}");
            let (mut foreign, _) = all[150].clone();
            foreign.spikes.push(Spike { address: 99, slot: 0, polarity: 1 });
            foreign.sample += 100;
            assert_eq!(decoding.take(&foreign, &mut counters).unwrap(), None);
            assert_eq!(counters.to_string(), "1 messages refused, 1 steps back in time");
        }
        let sf = "scheme = \"sf\"\nparameters = { threshold = 0.25 }";
        let (all, mut counters) = flown(sf, &samples);
        Unbank::new(flight(sf), 1.5).take(&all[9].0, &mut counters).unwrap();
        assert_eq!(counters.to_string(), "1 starts in the middle");
    }
}
