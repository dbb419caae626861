//! What the laptop program does, for bindings to other languages: on signals in memory, without a command line.
//!
//! Options go by the names that they have on the command line, without dashes before them, and mean what they mean
//! there. Figures come as JSON, as the program writes it for other programs.

mod arguments;
mod emit;
mod events;
mod log;
mod plot;
mod score;

pub use arguments::Arguments;
pub use emit::{c, rust, toml};
pub use events::{Events, read_events, write_events};
pub use lab::coding::Coding;
pub use log::{Log, read};
pub use plot::{Shown, plot};
pub use score::score;

use anyhow::{Result, bail};
use lab::trial::Recording;

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
    pub fn recording(&self) -> Result<Recording> {
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
