//! What the laptop program does, for bindings to other languages: on signals in memory, without a command line.
//!
//! Options go by the names that they have on the command line, without dashes before them, and mean what they mean
//! there. Figures come as JSON, as the program writes it for other programs.

mod advise;
mod arguments;
mod emit;
mod events;
mod log;
mod plot;
mod score;
mod tune;

pub use advise::{Advice, advise};
pub use arguments::Arguments;
pub use emit::{c, rust, toml};
pub use events::{Events, read_events, write_events};
pub use log::{Log, read};
pub use plot::{Shown, plot};
pub use score::score;
pub use tune::{Tuned, tune};

use crate::scheme::Scheme;
use crate::trial::Recording;
use anyhow::{Context, Result, bail};
use catalogue::run::{Options, SampleType};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A channel in memory.
#[derive(Clone, Debug)]
pub struct Signal {
    /// What it is called.
    pub name: String,
    /// Its samples.
    pub values: Vec<f64>,
    /// Samples a second, if known.
    pub rate: Option<f64>,
}

impl Signal {
    /// As the program has recordings.
    ///
    /// # Errors
    /// There is no sample, or one that is not finite.
    fn recording(&self) -> Result<Recording> {
        let Self { name, values, rate } = self;
        if values.is_empty() {
            bail!("{name}: there is no sample");
        }
        if let Some(place) = values.iter().position(|value| !value.is_finite()) {
            bail!("{name}, sample {place}: {} is not finite", values[place]);
        }
        if let Some(rate) = rate.filter(|rate| !(rate.is_finite() && *rate > 0.0)) {
            bail!("rate {rate} must be above 0 and finite");
        }
        Ok(Recording::of(name.clone(), values.clone(), *rate))
    }
}

/// A scheme, the sample type that it runs in, and what was given of its parameters.
#[derive(Clone, Debug)]
pub struct Coding {
    /// The scheme's short name.
    pub scheme: String,
    /// The sample type.
    pub sample: SampleType,
    /// The parameters given.
    pub options: Options,
}

impl Coding {
    fn scheme(&self) -> Result<Scheme> {
        Scheme::named(&self.scheme).with_context(|| format!("there is no scheme `{}`", self.scheme))
    }
}

/// Long work as seen from outside: how far it is, and whether it should end.
pub struct Watch<'a> {
    /// Set where it should end.
    pub stop: Arc<AtomicBool>,
    /// Called with the part that is done, 0 to 1.
    pub tell: &'a (dyn Fn(f64) + Sync),
}

impl Watch<'_> {
    /// Refuses to go on where it should end.
    ///
    /// # Errors
    /// It should.
    fn check(&self) -> Result<()> {
        if self.stop.load(Ordering::Relaxed) {
            bail!("stopped");
        }
        Ok(())
    }
}
