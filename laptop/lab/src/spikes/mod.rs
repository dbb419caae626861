//! Files of spikes: `index,address,polarity`, below lines `# key=value` with everything that decoding needs.
//!
//! With sub-timesteps, `index` counts those: sample times slots, plus the slot. The last lines give the numbers of
//! samples and events, so that a truncated file is noticed. Comments report values that were not finite and gaps in
//! time where they occur, with the times there, at the first and at the last sample. The neurons of a second channel
//! are numbered on from those of the first.

mod bag;
mod header;
mod kinds;
mod mcap;
mod messages;
mod reader;
mod recorder;
mod spyke;
mod writer;

pub use header::{Header, unrecorded};
pub use kinds::SpikesKind;
pub use messages::Messages;
pub use reader::{Item, Reader};
pub use recorder::{Format, Recorder};
pub use writer::{Summary, Writer};

use crate::input::{Chunk, Step};
use crate::output::Output;
use crate::{Place, Result};
use catalogue::run::Event;

/// A file in any format to which spikes are recorded.
pub trait Record {
    /// Notes the next samples, and removes the rows that are not finite, which the encoder must not see.
    ///
    /// # Errors
    /// Returns an error if the file cannot hold the samples.
    fn observe(&mut self, chunk: &mut Chunk, steps: &[Step]) -> Result<()>;

    /// Writes events. The encoder's later events must belong to the finite sample `decided` or to a later one.
    ///
    /// # Errors
    /// Returns an error if the spikes cannot be written.
    fn write(&mut self, events: &mut Vec<Event>, decided: u64) -> Result<()>;

    /// Writes the end, and returns the output.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    fn finish(self: Box<Self>, events: &mut Vec<Event>) -> Result<(Output, Summary)>;
}

/// A source of spikes, in the order of samples.
pub trait Spikes {
    /// Returns whether the events have times.
    fn is_timed(&self) -> bool;

    /// Returns the next item; the last is [`Item::End`].
    ///
    /// # Errors
    /// Returns an error if an item is invalid, or if the end is missing.
    fn next(&mut self) -> Result<Item>;

    /// Returns the place of the last item, for an error.
    fn place(&self) -> Place;

    /// Returns notes for the user on the file; they are complete after the last item.
    fn notes(&mut self) -> Vec<String> {
        Vec::new()
    }
}
