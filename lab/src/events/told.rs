//! The length that a file of spikes states at its end.

use anyhow::{Context, Result, bail};

/// The number of events that the end tells, where there must be one.
#[derive(Default)]
pub(super) struct Told {
    is_file_of_spikes: bool,
    events: Option<u64>,
}

impl Told {
    /// Takes a comment, if it says anything of the kind.
    pub(super) fn observe(&mut self, note: &str) -> Result<()> {
        match note.split_once('=') {
            Some(("spikewire", _)) => self.is_file_of_spikes = true,
            Some(("events", count)) if self.is_file_of_spikes => {
                let count = count.parse().with_context(|| format!("`{count}` is not a count"))?;
                self.events = Some(count);
            }
            _ => {}
        }
        Ok(())
    }

    /// Refuses a file that was cut.
    pub(super) fn check(&self, events: u64) -> Result<()> {
        match self.events {
            None if self.is_file_of_spikes => {
                bail!("ends without `# samples=` and `# events=`; is it cut short?")
            }
            Some(told) if told != events => {
                bail!("holds {events} events where its end says {told}")
            }
            _ => Ok(()),
        }
    }
}
