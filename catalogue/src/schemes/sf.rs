//! Step forward (SF).

#![allow(clippy::needless_range_loop)] // index by index, as the pseudo-code

use spikewire::Start;
use spikewire::temporal::StepForward;

use crate::plain::Plain;
use crate::{Channel, Count, Entry, Flight, Info, Parameter, Scaled};

#[cfg(feature = "run")]
use {
    crate::run::{Build, Given, Visit},
    anyhow::Result,
    spikewire::Sample,
};

/// Step forward.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "sf",
        title: "SF",
        words: "step forward (SF)",
        good_for: "following a signal closely with few spikes, while it changes by a threshold a sample at most",
        is_signed: true,
        has_first_value: true,
        climbs_by: Some("threshold"),
        is_drawn: true,
        colour: [0xe9, 0xc4, 0x3a],
        parameters: &[
            Parameter::threshold(
                "the step, above 0: what the distance from the baseline must exceed",
                0.5,
            ),
            Parameter::START,
        ],
    };

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = StepForward::try_new(channel.fraction(0.02))?;
        visitor.visit("sf", Self::INFO.words, &scheme, StepForward::START)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let threshold = signal.part(0.5);
        let scheme = StepForward::try_new(threshold)?;
        visitor.steps("sf", &scheme, threshold, |signal, spikes| {
            transcribed(signal, threshold, spikes);
        })
    }
}

#[cfg(feature = "run")]
impl Build for Scheme {
    fn build<S: Sample, V: Visit<S>>(given: &Given, visitor: V) -> Result<V::Output> {
        visitor.visit_steps(StepForward::try_new(given.signal("threshold")?)?, StepForward::START)
    }
}

/// The paper's algorithm 7.
#[inline(never)]
pub fn transcribed<S: Plain>(input: &[S], threshold: S, spikes: &mut [i8]) {
    let threshold = threshold.into();
    let mut base = input[0].into();
    for i in 1..input.len() {
        if input[i].into() > base + threshold {
            spikes[i] = 1;
            base += threshold;
        } else if input[i].into() < base - threshold {
            spikes[i] = -1;
            base -= threshold;
        } else {
            spikes[i] = 0;
        }
    }
}
