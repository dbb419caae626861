//! Samples to the messages of their spikes.

use crate::codec::{Codec, Request};
use crate::counters::Counters;
use crate::names::published;
use crate::wire::Said;
use anyhow::Result;
use ros2_client::builtin_interfaces::Time;
use std::collections::VecDeque;

/// What becomes of one sample.
#[derive(Debug)]
pub(crate) struct Coded {
    pub spikes: Vec<i8>,
    pub said: Said,
    /// What the spikes decode to.
    pub decoded: f64,
}

/// Encodes samples as they come, and decodes their spikes at once.
///
/// Nothing comes out before the scheme can start: it may need samples to calibrate on or to fill its window, which
/// are encoded as soon as it can. A rate code's spikes come later than their sample by its latency.
pub(crate) struct Encoding {
    request: Request,
    codec: Option<Codec>,
    /// The samples before the start, and then those whose spikes are still to come; each with its stamp in nanoseconds.
    waiting: VecDeque<(f64, i64)>,
    range: (f64, f64),
    pub is_array: bool,
}

impl Encoding {
    /// # Errors
    /// A parameter is missing or not good.
    pub(crate) fn new(request: Request) -> Result<Self> {
        let is_array = request.is_array()?;
        Ok(Self {
            request,
            codec: None,
            waiting: VecDeque::new(),
            range: (f64::INFINITY, f64::NEG_INFINITY),
            is_array,
        })
    }

    /// From the first message on, all that decoding needs, as the text of a file's header.
    pub(crate) fn header(&self) -> Option<String> {
        self.codec.as_ref().map(Codec::header)
    }

    /// Takes a sample. One that is not finite, in the 32 bits of messages, is counted and emits nothing.
    ///
    /// # Errors
    /// The samples tell a parameter that is not good.
    pub(crate) fn take(
        &mut self,
        value: f64,
        stamp: i64,
        counters: &mut Counters,
    ) -> Result<Vec<Coded>> {
        if !(value as f32).is_finite() {
            counters.add("samples not finite", 1, &value.to_string());
            return Ok(Vec::new());
        }
        self.range = (self.range.0.min(value), self.range.1.max(value));
        self.waiting.push_back((value, stamp));
        if self.codec.is_some() {
            return self.encode(&[value]);
        }
        if self.waiting.len() < self.request.enough() { Ok(Vec::new()) } else { self.start() }
    }

    /// Returns what is left when no more samples come.
    ///
    /// # Errors
    /// The samples tell a parameter that is not good.
    pub(crate) fn end(&mut self, counters: &mut Counters) -> Result<Vec<Coded>> {
        let (held, least) = (self.waiting.len(), self.request.least());
        let mut all = Vec::new();
        if self.codec.is_none() && held >= least {
            all = self.start()?;
        }
        match &mut self.codec {
            Some(codec) => {
                let rows = codec.finish();
                all.extend(self.coded(rows)?);
            }
            None if held > 0 => {
                let detail = format!("it needs {least}");
                counters.add("samples that came too few to start", held as u64, &detail);
            }
            None => {}
        }
        Ok(all)
    }

    fn start(&mut self) -> Result<Vec<Coded>> {
        let held: Vec<f64> = self.waiting.iter().map(|(value, _)| *value).collect();
        self.codec = Some(self.request.codec(&held)?);
        self.encode(&held)
    }

    fn encode(&mut self, samples: &[f64]) -> Result<Vec<Coded>> {
        let rows = self.codec.as_mut().map(|codec| codec.encode(samples)).unwrap_or_default();
        self.coded(rows)
    }

    fn coded(&mut self, rows: Vec<Vec<i8>>) -> Result<Vec<Coded>> {
        let Self { codec: Some(codec), waiting, range, .. } = self else { return Ok(Vec::new()) };
        let samples = waiting.drain(..rows.len().min(waiting.len()));
        let all = rows.into_iter().zip(samples).map(|(spikes, (input, stamp))| {
            let (min_input, max_input) = codec.range(*range);
            let said = Said {
                start: codec.first() as f32,
                min_input: min_input as f32,
                max_input: max_input as f32,
                threshold: codec.threshold() as f32,
                input: input as f32,
                scheme: published(codec.name()).to_owned(),
                timestamp: Time::from_nanos(stamp),
            };
            Ok(Coded { decoded: codec.decode(&spikes)?, spikes, said })
        });
        all.collect()
    }
}
