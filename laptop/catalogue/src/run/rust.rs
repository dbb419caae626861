//! Settings for firmware: a Rust constant, its memory, and the measured codec whose work is comparable.

use spikewire::Scheme;

use super::{ErrorKind, Result, SampleType, Settings, Value};
use crate::{Info, Unit};

/// A scheme as a Rust constant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Constant {
    /// Type of the scheme, with its path.
    pub scheme: String,
    /// Value of the constant.
    pub value: String,
}

/// The codec in the table of measurements whose work is comparable to that of a scheme.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counted {
    /// Name in the table.
    pub codec: &'static str,
    /// How many times the codec's work the scheme takes, at most.
    pub times: f64,
}

impl Counted {
    /// Makes the bound for a codec that is `longer` times as long as the measured one. For a longer one this is an
    /// upper bound, as a part of the work does not grow with the length; for a shorter one the measured codec itself
    /// is.
    pub fn at_most(codec: &'static str, longer: f64) -> Self {
        Self { codec, times: longer.max(1.0) }
    }
}

/// Returns the size in bytes of a channel's state in a scheme's encoder.
pub const fn state<P: Scheme>() -> usize {
    size_of::<P::EncoderState>()
}

/// Extrapolates a size that grows linearly with a length, from its values at 8 and 16.
pub const fn lengthened([at_8, at_16]: [usize; 2], length: usize) -> usize {
    (at_8 + (at_16 - at_8) * length / 8).saturating_sub(at_16 - at_8)
}

/// Writes the averaging of spikes in Rust: its type, and its value.
fn mean(settings: &Settings) -> Result<[String; 2]> {
    let power = settings.count("power", 0..=15)?;
    let (scheme, words) = if settings.takes_window()? {
        let words = settings.window()?.samples().div_ceil(32);
        ("spikewire::rate::Window", format!("<{words}>"))
    } else {
        ("spikewire::rate::Average", String::new())
    };
    Ok([format!("{scheme}{words}"), format!("{scheme}::new({power})")])
}

/// Writes settings as Rust, in a sample type.
#[derive(Clone, Copy, Debug)]
pub struct Rust {
    sample: SampleType,
}

impl Rust {
    /// Writes in this sample type.
    pub const fn new(sample: SampleType) -> Self {
        Self { sample }
    }

    /// Returns the sample type, with its path.
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

    /// Writes a number of the sample type.
    pub fn number(self, value: f64) -> String {
        let bits = (value / self.sample.step() + 0.5).floor() as i64;
        match self.sample {
            SampleType::F32 => format!("{:?}", value as f32),
            SampleType::Fixed16 { fraction: 0 } => bits.to_string(),
            _ => format!("{}::from_bits({bits})", self.sample()),
        }
    }

    /// Writes a parameter in the signal's unit.
    ///
    /// # Errors
    /// Returns an error if the setting is missing or not a finite number.
    pub fn signal(self, settings: &Settings, name: &str) -> Result<String> {
        Ok(self.number(settings.number(name)?))
    }

    /// Writes the range from `min` to `max`.
    ///
    /// # Errors
    /// See [`signal`](Self::signal).
    pub fn range(self, settings: &Settings) -> Result<String> {
        Ok(format!("{}..={}", self.signal(settings, "min")?, self.signal(settings, "max")?))
    }

    /// Writes numbers in the signal's unit, as an array.
    ///
    /// # Errors
    /// Returns an error if the settings are missing or not finite.
    pub fn signals(self, settings: &Settings, name: &str) -> Result<String> {
        let numbers = settings.numbers(name)?;
        let numbers: Vec<String> = numbers.iter().map(|number| self.number(*number)).collect();
        Ok(format!("[{}]", numbers.join(", ")))
    }

    /// Writes the filter.
    ///
    /// # Errors
    /// See [`signals`](Self::signals).
    pub fn taps(self, settings: &Settings) -> Result<String> {
        Ok(format!("spikewire::rate::Taps::new({})", self.signals(settings, "taps")?))
    }

    /// Fills in a template, in which `{name}` stands for the parameter of that name. Also, `{range}` stands for the
    /// range from `min` to `max`, `{taps}` for the filter, `{length}` for the number of its taps, `{averaging}` for the
    /// type of the averaging of spikes, and `{mean}` for its value.
    ///
    /// # Errors
    /// Returns an error if a setting is missing.
    pub fn filled(self, template: &str, info: &Info, settings: &Settings) -> Result<String> {
        let mut parts = template.split(['{', '}']);
        let mut all: Vec<String> = parts.next().map(str::to_owned).into_iter().collect();
        while let (Some(name), Some(rest)) = (parts.next(), parts.next()) {
            all.push(match name {
                "range" => self.range(settings)?,
                "taps" => self.taps(settings)?,
                "length" => settings.length()?.to_string(),
                "averaging" => mean(settings)?[0].clone(),
                "mean" => mean(settings)?[1].clone(),
                name => match (settings.value(name)?, info.parameter(name).map(|own| own.unit)) {
                    (Value::Number(number), Some(Unit::Signal)) => self.number(*number),
                    (Value::Number(number), _) => format!("{:?}", *number as f32),
                    (value, _) => value.to_string(),
                },
            });
            all.push(rest.to_owned());
        }
        Ok(all.concat())
    }

    /// Makes the constant of a scheme from its type, the type's arguments after the sample type, and its constructor.
    ///
    /// # Errors
    /// Returns an error if the sample type has fewer integer bits than a constant can express.
    pub fn constant(self, scheme: &str, shape: &str, value: &str) -> Result<Constant> {
        let sample = self.sample();
        if sample.contains("::I0F") {
            return Err(ErrorKind::NoNameInRust { sample: self.sample }.into());
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
