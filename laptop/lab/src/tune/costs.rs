//! Costs of settings on a flight controller, from measured instruction counts.

use super::RequestKind;
use crate::Result;
use crate::scheme::Scheme;
use catalogue::run::{SampleType, Settings};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// The text of `baseline.json`: the measured instruction counts. `cargo bench-target --baseline` writes this file, and
/// `cargo verify` checks it. The file is a symbolic link, because a source package contains only files of its own
/// directory.
const COUNTS: &str = include_str!("baseline.json");

#[derive(Deserialize)]
struct Counts {
    instructions_mean: BTreeMap<String, f64>,
}

static MEASURED: LazyLock<BTreeMap<String, f64>> = LazyLock::new(|| {
    serde_json::from_str::<Counts>(COUNTS)
        .map(|counts| counts.instructions_mean)
        .unwrap_or_default()
});

/// The costs of one channel on a flight controller: latency, RAM and instructions.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Costs {
    /// Latency of the code, in samples: the time from a sample until the encoder emits the code of this sample.
    pub latency: usize,
    /// Size of the encoder's state in bytes, if known.
    pub ram: Option<usize>,
    /// Mean number of instructions to encode a sample, if measured.
    pub instructions: Option<f64>,
    /// Whether `instructions` is an upper bound. The bound is the count measured for a shorter filter, scaled up.
    pub is_bound: bool,
}

impl Costs {
    /// Looks up what settings cost on `core`, one of the processor cores whose instructions were counted.
    pub fn new(scheme: Scheme, settings: &Settings, latency: usize, core: &str) -> Self {
        let counted = scheme.counted(settings).ok();
        let measured = counted.and_then(|counted| {
            let sample = measured_as(settings.sample);
            let key = format!("{core} paper {} {sample} encode sample", counted.codec);
            MEASURED.get(&key).map(|count| count * counted.times)
        });
        Self {
            latency,
            ram: scheme.ram(settings).ok(),
            instructions: measured,
            is_bound: counted.is_some_and(|counted| counted.times > 1.0),
        }
    }

    /// Formats the mean number of instructions for a sample, as a number or as `not measured`.
    pub fn instructions(&self) -> String {
        match self.instructions {
            Some(count) if self.is_bound => format!("at most {count:.0}"),
            Some(count) => format!("{count:.1}"),
            None => "not measured".to_owned(),
        }
    }
}

/// Returns the name of a sample type for which instructions were counted. This type has the same width as `sample`, and
/// its counts are used for `sample`.
fn measured_as(sample: SampleType) -> &'static str {
    match sample {
        SampleType::F32 => "f32",
        SampleType::Fixed16 { .. } => "i16",
        SampleType::Fixed32 { .. } => "q16.16",
    }
}

/// Returns the names of the cores with measured counts.
fn cores() -> Vec<&'static str> {
    let mut cores: Vec<&str> = MEASURED.keys().filter_map(|key| key.split(' ').next()).collect();
    cores.dedup();
    cores
}

/// Finds a core by `name` in upper or lower case, and returns the usual spelling of the core's name.
///
/// # Errors
/// Returns an error if no instructions were measured on a core of this name.
pub fn core(name: &str) -> Result<String> {
    let known = cores();
    let Some(core) = known.iter().find(|core| core.eq_ignore_ascii_case(name)) else {
        let (name, cores) = (name.to_owned(), known.join(", "));
        return Err(RequestKind::NoCore { name, cores }.into());
    };
    Ok((*core).to_owned())
}

#[cfg(test)]
mod tests {
    use super::{Costs, core};
    use crate::scheme::Scheme;
    use catalogue::run::Settings;

    #[test]
    fn measured_figures_are_found() {
        assert_eq!(core("m4f").unwrap(), "M4F");
        assert!(core("M55").unwrap_err().to_string().contains("there are M0, M4F"));
        let mut settings = Settings::default();
        settings.set("taps", vec![1.0; 30]);
        let hsa = Scheme::named("hsa").unwrap();
        for sample in ["f32", "i16", "q8.8", "q16.16"] {
            settings.sample = sample.parse().unwrap();
            for core in ["M0", "M4F"] {
                let costs = Costs::new(hsa, &settings, 29, core);
                assert!(costs.instructions.is_some_and(|count| count > 100.0) && costs.is_bound);
                assert!(costs.ram.is_some_and(|ram| ram >= 60));
            }
        }
    }
}
