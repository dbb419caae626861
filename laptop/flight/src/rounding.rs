//! Parameters that the sample type changes.

use crate::{Flight, FlightError, FlightErrorKind, visible};
use catalogue::run::{Asked, SampleType};
use std::fmt;

/// A parameter of a channel that the sample type changes, by a tenth at most.
#[derive(Clone, Debug, PartialEq)]
pub struct Rounded {
    /// Name of the channel.
    pub channel: String,
    /// Name of the parameter.
    pub parameter: &'static str,
    /// Number in the flight file.
    pub given: f64,
    /// Number with which the channel flies.
    pub nearest: f64,
    /// Sample type.
    pub sample: SampleType,
}

impl fmt::Display for Rounded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { channel, parameter, given, nearest, sample } = self;
        let channel = visible(channel);
        write!(f, "{channel}: {parameter} {given} is {nearest} in {sample}")
    }
}

/// Largest change of a parameter by rounding, as a share of the parameter.
const LARGEST_CHANGE: f64 = 0.1;

impl Flight {
    /// Returns the parameters that the sample type changes: of each list only the number that changes most.
    pub fn rounded(&self) -> Vec<Rounded> {
        let mut all = Vec::new();
        for index in 0..self.channels.len() {
            all.extend(self.rounded_of(index).into_iter().map(|(rounded, _)| rounded));
        }
        all
    }

    /// Returns the parameters of a channel as it flies: those of the flight file, with the numbers that the sample type
    /// has in their place.
    pub fn asked_as_flown(&self, index: usize) -> Asked {
        let Some(channel) = self.channels.get(index) else { return Asked::default() };
        let mut asked = self.asked(channel);
        let settings = &self.settings()[index];
        for (key, _) in &settings.rounded {
            let parameter = self.scheme.parameters.iter().find(|own| own.key() == *key);
            if let (Some(parameter), Some(value)) = (parameter, settings.get(key))
                && asked.get(parameter.name).is_some()
            {
                asked.set(parameter.name, value.clone());
            }
        }
        asked
    }

    /// Checks that the sample type changes no parameter by more than a tenth: of itself, of the range from `min` to
    /// `max`, or of the largest number of a list.
    ///
    /// # Errors
    /// Returns an error for the first parameter that is changed by more.
    pub(crate) fn check_rounding(&self) -> Result<(), FlightError> {
        for index in 0..self.channels.len() {
            for (rounded, size) in self.rounded_of(index) {
                let Rounded { parameter, given, nearest, sample, .. } = rounded;
                if (given - nearest).abs() > LARGEST_CHANGE * size {
                    let kind = FlightErrorKind::Rounded { given, nearest, sample };
                    return Err(FlightError::new(parameter, kind).of_channel(index));
                }
            }
        }
        Ok(())
    }

    /// Returns the parameters of a channel that the sample type changes, each with the size by which its change is
    /// judged.
    fn rounded_of(&self, index: usize) -> Vec<(Rounded, f64)> {
        let mut all = Vec::new();
        let settings = &self.settings()[index];
        for (key, given) in &settings.rounded {
            let Some(parameter) = self.scheme.parameters.iter().find(|own| own.key() == *key)
            else {
                continue; // the first sample, which is rounded as every sample is
            };
            let (Some(given), Ok(nearest)) = (given.numbers(), settings.numbers(key)) else {
                continue;
            };
            let pairs = given.iter().zip(nearest);
            let most = pairs.max_by(|a, b| (a.0 - a.1).abs().total_cmp(&(b.0 - b.1).abs()));
            let Some((given_number, nearest)) = most else { continue };
            let range = match (settings.number("min"), settings.number("max")) {
                (Ok(min), Ok(max)) if ["min", "max"].contains(key) => max - min,
                _ => 0.0,
            };
            let size = given.iter().map(|number| number.abs()).fold(range, f64::max);
            let rounded = Rounded {
                channel: self.channels[index].name.clone(),
                parameter: parameter.name,
                given: *given_number,
                nearest: *nearest,
                sample: self.sample,
            };
            all.push((rounded, size));
        }
        all
    }
}
