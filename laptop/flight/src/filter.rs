//! The filter that runs before the encoder of each channel: how it is run on the laptop, and written in Rust.

use catalogue::for_sample_type;
use catalogue::run::SampleType;
use serde::{Deserialize, Serialize};
use spikewire::filter::{Biquad, FirstOrder};
use spikewire::{ConfigError, Fingerprint, Sample};

/// Filter that runs before the encoder of each channel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Filter {
    /// First-order low-pass.
    FirstOrder {
        /// Corner frequency in Hz, 0.001 to 0.49 of the sample rate.
        corner: f32,
    },
    /// Butterworth low-pass of second order.
    LowPass {
        /// Corner frequency in Hz, 0.001 to 0.49 of the sample rate.
        corner: f32,
    },
    /// Notch: removes a narrow band of frequencies.
    Notch {
        /// Centre frequency in Hz, 0.001 to 0.49 of the sample rate.
        centre: f32,
        /// Quality factor: the centre frequency divided by the width of the band, 0.1 to 100.
        q: f32,
    },
}

/// A running filter: takes the samples one by one, and returns the filtered samples.
pub type Filtering = Box<dyn FnMut(f64) -> f64 + Send>;

impl Filter {
    /// Starts the filter for a sample type and a sample rate in Hz. Returns a function that takes one sample after the
    /// other; its results are bit for bit those of a firmware. Samples that are not finite are returned unchanged.
    ///
    /// # Errors
    /// Returns an error if the corner, the centre or `q` is out of its range at this rate.
    pub fn start(self, sample: SampleType, rate: f32) -> Result<Filtering, ConfigError> {
        for_sample_type!(sample, S => self.started::<S>(sample.one(), rate))
    }

    /// Returns the filter's fingerprint for a sample type and a sample rate in Hz, which becomes a part of the flight's
    /// fingerprint.
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

    /// Returns the delay of slow signals in samples, at a sample rate in Hz.
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

    /// Returns type and value, in Rust, of a scheme behind this filter. `scheme` holds type and value of the scheme
    /// alone, and `sample` is the sample type in Rust.
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
