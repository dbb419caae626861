//! Full names of what the firmware calls by a short word.

use catalogue::{Channel, Flight};
use spikewire::{Calibration, ConfigError, Scheme};

/// Returns the full name of a scheme, from the catalogue.
pub fn full_name(scheme: &str) -> &str {
    let mut calibration = Calibration::<f32>::new();
    for sample in [0.0, 1.0, 0.0] {
        calibration.observe(sample);
    }
    let mut words = Words { name: scheme, words: scheme };
    // Parameters from three samples may be bad for some scheme; its name then stands as it is.
    let _ = catalogue::fly(&Channel::new(0, calibration), &mut words);
    words.words
}

struct Words<'a> {
    name: &'a str,
    words: &'a str,
}

impl Flight for Words<'_> {
    type Sample = f32;
    type Error = ConfigError;

    fn visit<P: Scheme<Sample = f32>>(
        &mut self,
        name: &'static str,
        words: &'static str,
        _: &P,
        _: P::EncoderState,
    ) -> Result<(), ConfigError> {
        if name == self.name {
            self.words = words;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::full_name;

    #[test]
    fn every_flown_scheme_has_words() {
        assert_eq!(full_name("sf"), "step forward (SF)");
        assert_eq!(full_name("grf-prob"), "GRF with probabilistic spiking");
        assert_eq!(full_name("none of them"), "none of them");
    }
}
