//! What a signal is like, and which scheme suits it.

use super::{Arguments, Signal, Tuned, Watch};
use crate::commands::advise::{self, Advise};
use crate::stop::Stop;
use anyhow::Result;

/// What is said of a channel.
#[derive(Clone, Debug)]
pub struct Advice {
    /// What a person reads.
    pub page: String,
    /// All of it, as `spikewire advise --json` has it.
    pub figures: String,
    /// The scheme advised with its settings, if there is one.
    pub best: Option<Tuned>,
}

/// Looks at signals and says which scheme suits each, with the options of `spikewire advise`.
///
/// # Errors
/// The signals or options are not good, or somebody stopped it.
pub fn advise(signals: &[Signal], arguments: &Arguments, watch: &Watch) -> Result<Vec<Advice>> {
    let options: Advise = arguments.parse("-")?;
    let recordings = signals.iter().map(Signal::recording).collect::<Result<Vec<_>>>()?;
    let stop = Stop::at_word(watch.stop.clone(), options.seconds)?;
    let all = advise::advise(&options, &recordings, &stop, &|done, total, _| {
        (watch.tell)(done as f64 / total as f64);
    })?;
    watch.check()?;
    let told = all.iter().zip(signals).map(|(own, signal)| {
        let best = own.best().map(|(scheme, row)| Tuned::new(scheme, row, &signal.name));
        Ok(Advice {
            page: own.page(&options.core, options.sample),
            figures: serde_json::to_string(own)?,
            best: best.transpose()?,
        })
    });
    told.collect()
}
