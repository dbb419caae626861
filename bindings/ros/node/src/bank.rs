//! Samples of all channels of a flight to the messages of their spikes.

use crate::clock::Clock;
use crate::codec::Request;
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
            all.push((
                FlightSpikes { header: header.clone(), spikes },
                FlightValues { header, values },
            ));
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::Bank;
    use crate::counters::Counters;
    use crate::wire::{FlightSpikes, FlightValues, Header};
    use ros2_client::builtin_interfaces::Time;
    use spikewire_flight::Flight;

    fn flown(scheme: &str, samples: &[[f64; 2]]) -> (Vec<(FlightSpikes, FlightValues)>, Counters) {
        let text = format!(
            "version = 1\nperiod = 1000\n{scheme}\n[[channel]]\nname = \"a\"\n[[channel]]\nname = \"b\"\ncounts = 10\n"
        );
        let mut bank = Bank::new(Flight::parse(&text).unwrap(), 1.5).unwrap();
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
}
