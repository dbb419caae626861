//! The filter before the code: its kinds, how it runs on the laptop, and how it is written in Rust.

use catalogue::for_sample_type;
use catalogue::run::SampleType;
use serde::{Deserialize, Serialize};
use spikewire::filter::{Biquad, FirstOrder};
use spikewire::{ConfigError, Fingerprint, Sample};

/// A filter before the code of every channel, by its corner or centre in Hz.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Filter {
    /// A low-pass of first order.
    FirstOrder {
        /// The corner in Hz, 0.001 to 0.49 of the rate.
        corner: f32,
    },
    /// Butterworth's low-pass of second order.
    LowPass {
        /// The corner in Hz, 0.001 to 0.49 of the rate.
        corner: f32,
    },
    /// A notch.
    Notch {
        /// The centre in Hz, 0.001 to 0.49 of the rate.
        centre: f32,
        /// The centre over the width, 0.1 to 100.
        q: f32,
    },
}

/// A filter that keeps its state from sample to sample.
pub type Filtering = Box<dyn FnMut(f64) -> f64 + Send>;

impl Filter {
    /// Starts the filter on samples of this type and rate, in Hz: a function from sample to sample, whose results have
    /// the bits of a firmware's. What is not finite passes as it is.
    ///
    /// # Errors
    /// Returns an error if the corner, the centre or `q` is out of its range at this rate.
    pub fn start(self, sample: SampleType, rate: f32) -> Result<Filtering, ConfigError> {
        for_sample_type!(sample, S => self.started::<S>(sample.one(), rate))
    }

    /// The fingerprint of the filter before samples of this type and rate, in Hz, which a link's is made from.
    ///
    /// # Errors
    /// Returns an error if the corner, the centre or `q` is out of its range at this rate.
    pub fn fingerprint(self, sample: SampleType, rate: f32) -> Result<Fingerprint, ConfigError> {
        use spikewire::filter::Filter as _;
        for_sample_type!(sample, S => Ok(match self {
            Self::FirstOrder { corner } => FirstOrder::<S>::try_low_pass(corner, rate)?.fingerprint(),
            Self::LowPass { corner } => Biquad::<S>::try_low_pass(corner, rate)?.fingerprint(),
            Self::Notch { centre, q } => Biquad::<S>::try_notch(centre, rate, q)?.fingerprint(),
        }))
    }

    /// By how many samples of this rate, in Hz, a slow signal comes late.
    ///
    /// # Errors
    /// Returns an error if the corner, the centre or `q` is out of its range at this rate.
    pub fn delay(self, rate: f32) -> Result<f32, ConfigError> {
        use spikewire::filter::Filter as _;
        Ok(match self {
            Self::FirstOrder { corner } => FirstOrder::<f32>::try_low_pass(corner, rate)?.delay(),
            Self::LowPass { corner } => Biquad::<f32>::try_low_pass(corner, rate)?.delay(),
            Self::Notch { centre, q } => Biquad::<f32>::try_notch(centre, rate, q)?.delay(),
        })
    }

    fn started<S: Sample>(self, one: f64, rate: f32) -> Result<Filtering, ConfigError>
    where
        Biquad<S>: Send + 'static,
        <Biquad<S> as spikewire::filter::Filter>::State: Send + 'static,
        FirstOrder<S>: Send + 'static,
        <FirstOrder<S> as spikewire::filter::Filter>::State: Send + 'static,
    {
        Ok(match self {
            Self::FirstOrder { corner } => {
                running(FirstOrder::<S>::try_low_pass(corner, rate)?, one)
            }
            Self::LowPass { corner } => running(Biquad::<S>::try_low_pass(corner, rate)?, one),
            Self::Notch { centre, q } => running(Biquad::<S>::try_notch(centre, rate, q)?, one),
        })
    }

    /// The filter before a scheme, in Rust: its type, and its value.
    pub(crate) fn constant(self, sample: &str, rate: f32, scheme: [String; 2]) -> [String; 2] {
        let (name, value) = match self {
            Self::FirstOrder { corner } => {
                ("FirstOrder", format!("low_pass({corner:?}, {rate:?})"))
            }
            Self::LowPass { corner } => ("Biquad", format!("low_pass({corner:?}, {rate:?})")),
            Self::Notch { centre, q } => ("Biquad", format!("notch({centre:?}, {rate:?}, {q:?})")),
        };
        let [kind, scheme] = scheme;
        let filter = format!("spikewire::filter::{name}");
        [
            format!("spikewire::filter::Filtered<{filter}<{sample}>, {kind}>"),
            format!("{filter}::{value}.before({scheme})"),
        ]
    }
}

fn running<F>(filter: F, one: f64) -> Filtering
where
    F: spikewire::filter::Filter<State: Send> + Send + 'static,
{
    let mut state = F::START;
    Box::new(move |sample| {
        if !sample.is_finite() {
            return sample;
        }
        let sample = F::Sample::from_f64(sample * one);
        filter.filter(&mut state, sample).to_f64() / one
    })
}
