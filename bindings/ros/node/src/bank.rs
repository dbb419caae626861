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
