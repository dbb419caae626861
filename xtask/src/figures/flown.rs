//! Parses the output of the firmware program `demo`: each scheme's spikes and decoded values.

use anyhow::{Context, Result};

/// The spikes and decoded values of one scheme.
#[derive(PartialEq)]
pub struct Flown {
    pub scheme: String,
    /// Latency in samples.
    pub latency: usize,
    pub steps: Vec<Step>,
}

/// The spikes and the decoded value of one sample.
#[derive(PartialEq)]
pub struct Step {
    pub firings: Vec<NeuronSpike>,
    /// Bits of the decoded value, an `f32`; values are equal if their bits are.
    bits: u32,
}

#[derive(PartialEq)]
pub struct NeuronSpike {
    pub up: bool,
    pub neuron: u16,
    /// Sub-timestep, which is compared but not drawn.
    slot: u16,
}

impl Step {
    pub fn value(&self) -> f32 {
        f32::from_bits(self.bits)
    }
}

impl Flown {
    pub fn spikes(&self) -> usize {
        self.steps.iter().map(|step| step.firings.len()).sum()
    }

    /// Returns the root mean square error of the decoded values.
    pub fn rmse(&self, signal: &[f32]) -> f64 {
        let squares = self.steps.iter().zip(signal).map(|(step, sample)| {
            let error = f64::from(step.value()) - f64::from(*sample);
            error * error
        });
        (squares.sum::<f64>() / signal.len() as f64).sqrt()
    }
}

/// Reads everything the program printed.
pub fn parse(printed: &str) -> Result<Vec<Flown>> {
    let mut flown: Vec<Flown> = Vec::new();
    for line in printed.lines() {
        let (left, right) = line.split_once(' ').with_context(|| format!("no blank: {line}"))?;
        if left.starts_with(char::is_alphabetic) {
            let (scheme, latency) = (left.to_owned(), right.parse()?);
            flown.push(Flown { scheme, latency, steps: Vec::new() });
        } else {
            let step = step(left, right).with_context(|| format!("not a sample: {line}"))?;
            flown.last_mut().context("a sample without a scheme")?.steps.push(step);
        }
    }
    Ok(flown)
}

/// Parses `+3.0-4.1 3f800000`.
fn step(firings: &str, bits: &str) -> Option<Step> {
    let signed = firings.split_inclusive(['+', '-']);
    let signs = signed.clone().map(|part| part.ends_with('+'));
    let numbers = signed.skip(1).map(|part| part.trim_end_matches(['+', '-']));
    let firings = signs.zip(numbers).map(|(up, number)| {
        let (neuron, slot) = number.split_once('.')?;
        Some(NeuronSpike { up, neuron: neuron.parse().ok()?, slot: slot.parse().ok()? })
    });
    Some(Step {
        firings: firings.collect::<Option<_>>()?,
        bits: u32::from_str_radix(bits, 16).ok()?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_what_the_program_prints() {
        let flown = parse("tbr 0\n 00000000\n-0.0 bf800000\ngrf 2\n+3.0+14.7 3f800000\n").unwrap();
        assert_eq!(flown.len(), 2);
        assert_eq!((flown[0].scheme.as_str(), flown[0].spikes()), ("tbr", 1));
        assert!(!flown[0].steps[1].firings[0].up);
        let Step { firings, .. } = &flown[1].steps[0];
        assert!(firings.iter().all(|firing| firing.up));
        assert_eq!((firings[1].neuron, firings[1].slot), (14, 7));
        assert!((flown[0].rmse(&[0.0, 1.0]) - f64::sqrt(2.0)).abs() < 1e-12);
        assert!(parse("tbr 0\n+0 00000000\n").is_err());
    }
}
