//! Files of spikes: a table `index,address,polarity`, below lines `# key=value` with everything that decoding needs.
//!
//! `index` is the sample's index or, with sub-timesteps, that index times the number of slots, plus the slot. Neurons
//! are numbered through all channels: those of channel 1 follow those of channel 0.
//!
//! Comments between the events report values that were not finite and gaps in time, each where it occurs, and the time
//! before each gap and at the first and last sample. The last lines give the numbers of samples and events, by which a
//! truncated file is noticed.

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

/// A file in any format, to which spikes are written.
pub trait Record {
    /// Notes the next samples and the unusual steps in their times, and removes from `chunk` the rows that are not
    /// finite, which must not be encoded.
    ///
    /// # Errors
    /// Returns an error if the file cannot hold the samples.
    fn observe(&mut self, chunk: &mut Chunk, steps: &[Step]) -> Result<()>;

    /// Writes events. All events passed later must belong to the finite sample number `decided` or to later samples.
    ///
    /// # Errors
    /// Returns an error if the spikes cannot be written.
    fn write(&mut self, events: &mut Vec<Event>, decided: u64) -> Result<()>;

    /// Writes the last events and the file's end. Returns the output, which the caller must finish.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    fn finish(self: Box<Self>, events: &mut Vec<Event>) -> Result<(Output, Summary)>;
}

/// A source of spikes, which come in the order of their samples.
pub trait Spikes {
    /// Returns whether the events have times.
    fn is_timed(&self) -> bool;

    /// Returns the next item; the last is [`Item::End`].
    ///
    /// # Errors
    /// Returns an error if an item is invalid, or if the end is missing.
    fn next(&mut self) -> Result<Item>;

    /// Returns the place of the latest item, for an error.
    fn place(&self) -> Place;

    /// Returns notes for the user on the file, complete once the last item was read.
    fn notes(&mut self) -> Vec<String> {
        Vec::new()
    }
}
