//! Settings as firmware has them: a constant in Rust, its memory, and which measured codec stands for its work.

use anyhow::{Result, bail};
use spikewire::Scheme;

use super::{SampleType, Settings};

/// A scheme as a constant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Constant {
    /// Its type, with its path.
    pub scheme: String,
    /// Its value.
    pub value: String,
}

/// The codec of the measured table that stands for a scheme's work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counted {
    /// The name in the table.
    pub codec: &'static str,
    /// How many times its work this is, at most.
    pub times: f64,
}

impl Counted {
    /// A codec of another length. A part of its work does not grow with the length, so that this bounds a longer one
    /// from above; for a shorter one the codec itself does.
    pub fn at_most(codec: &'static str, longer: f64) -> Self {
        Self { codec, times: longer.max(1.0) }
    }
}

/// The bytes of a channel's state in a scheme's encoder.
pub const fn state<P: Scheme>() -> usize {
    size_of::<P::EncoderState>()
}

/// Extrapolates a size that grows evenly with a length, from its values at 8 and at 16.
pub const fn lengthened([at_8, at_16]: [usize; 2], length: usize) -> usize {
    (at_8 + (at_16 - at_8) * length / 8).saturating_sub(at_16 - at_8)
}

/// How the mean of spikes is taken, in Rust.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mean {
    /// Its type, with its path.
    pub scheme: String,
    /// Its value.
    pub value: String,
}

impl Mean {
    /// The mean that settings ask for.
    ///
    /// # Errors
    /// They lack it, or it makes no sense.
    pub fn of(settings: &Settings) -> Result<Self> {
        let power = settings.count("power", 0..=15)?;
        Ok(if settings.takes_window()? {
            let words = settings.window()?.samples().div_ceil(32);
            Self {
                scheme: format!("spikewire::rate::Window<{words}>"),
                value: format!("spikewire::rate::Window::new({power})"),
            }
        } else {
            Self {
                scheme: "spikewire::rate::Average".to_owned(),
                value: format!("spikewire::rate::Average::new({power})"),
            }
        })
    }
}

/// Writes settings in a sample type.
#[derive(Clone, Copy, Debug)]
pub struct Rust {
    sample: SampleType,
}

impl Rust {
    /// In this sample type.
    pub const fn new(sample: SampleType) -> Self {
        Self { sample }
    }

    /// The sample type, with its path.
    pub fn sample(self) -> String {
        match self.sample {
            SampleType::F32 => "f32".to_owned(),
            SampleType::Fixed16 { fraction: 0 } => "i16".to_owned(),
            SampleType::Fixed16 { fraction } => {
                format!("fixed::types::I{}F{fraction}", 16 - fraction)
            }
            SampleType::Fixed32 { fraction } => {
                format!("fixed::types::I{}F{fraction}", 32 - fraction)
            }
        }
    }

    /// A number of the sample type.
    fn number(self, value: f64) -> String {
        let bits = (value / self.sample.step() + 0.5).floor() as i64;
        match self.sample {
            SampleType::F32 => format!("{:?}", value as f32),
            SampleType::Fixed16 { fraction: 0 } => bits.to_string(),
            _ => format!("{}::from_bits({bits})", self.sample()),
        }
    }

    /// A parameter in the signal's unit, as it runs.
    ///
    /// # Errors
    /// Returns an error if the setting is missing or not a finite number.
    pub fn signal(self, settings: &Settings, name: &str) -> Result<String> {
        Ok(self.number(settings.number(name)?))
    }

    /// From `min` to `max`, as they run.
    ///
    /// # Errors
    /// See [`signal`](Self::signal).
    pub fn range(self, settings: &Settings) -> Result<String> {
        Ok(format!("{}..={}", self.signal(settings, "min")?, self.signal(settings, "max")?))
    }

    /// Numbers in the signal's unit, as an array.
    ///
    /// # Errors
    /// Returns an error if the settings are missing or not finite.
    pub fn signals(self, settings: &Settings, name: &str) -> Result<String> {
        let numbers = settings.numbers(name)?;
        let numbers: Vec<String> = numbers.iter().map(|number| self.number(*number)).collect();
        Ok(format!("[{}]", numbers.join(", ")))
    }

    /// The filter.
    ///
    /// # Errors
    /// See [`signals`](Self::signals).
    pub fn taps(self, settings: &Settings) -> Result<String> {
        Ok(format!("spikewire::rate::Taps::new({})", self.signals(settings, "taps")?))
    }

    /// The constant of a scheme in the crate, with what its type takes besides the sample type, and its constructor.
    ///
    /// # Errors
    /// The sample type has fewer bits before the point than a constant can say.
    pub fn constant(self, scheme: &str, shape: &str, value: &str) -> Result<Constant> {
        let sample = self.sample();
        if sample.contains("::I0F") {
            bail!("{} has no name in Rust", self.sample);
        }
        let shape = if shape.is_empty() { String::new() } else { format!(", {shape}") };
        let name = scheme.rsplit("::").next().unwrap_or(scheme);
        let place = scheme.strip_suffix(name).unwrap_or_default();
        Ok(Constant {
            scheme: format!("spikewire::{scheme}<{sample}{shape}>"),
            value: format!("spikewire::{place}{name}::{value}"),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_bits() {
        let mut settings = Settings::default();
        settings.set("threshold", 0.1);
        for (sample, text) in [
            ("f32", "0.1"),
            ("q16.16", "fixed::types::I16F16::from_bits(6554)"),
            ("q8.8", "fixed::types::I8F8::from_bits(26)"),
            ("i16", "0"),
        ] {
            assert_eq!(
                Rust::new(sample.parse().unwrap()).signal(&settings, "threshold").unwrap(),
                text
            );
        }
        let constant = Rust::new(SampleType::F32).constant("rate::Hough", "3", "new(x)").unwrap();
        assert_eq!(constant.scheme, "spikewire::rate::Hough<f32, 3>");
        assert_eq!(constant.value, "spikewire::rate::Hough::new(x)");
    }

    #[test]
    fn memory_grows_with_the_filter() {
        use spikewire::rate::Hough;
        let sizes = [state::<Hough<f32, 8>>(), state::<Hough<f32, 16>>()];
        assert_eq!(lengthened(sizes, 15), state::<Hough<f32, 15>>());
        assert_eq!(lengthened(sizes, 15), 68); // as in docs/costs.md
        assert_eq!(lengthened(sizes, 64), state::<Hough<f32, 64>>());
        assert_eq!(lengthened(sizes, 1), state::<Hough<f32, 1>>());
    }
}
