//! Files of spikes. Lines `# key=value` hold everything that decoding needs. Below them is a table with the columns
//! `index,address,polarity`.
//!
//! `index` is the sample's index. If a scheme divides each sample into sub-timesteps (slots), `index` counts slots
//! instead: `sample * slots + slot`. Neurons are numbered across all channels: the neurons of channel 1 follow the
//! neurons of channel 0.
//!
//! Comments between the events report values that were not finite, and gaps in time. Each comment stands where the
//! value or gap occurs. Further comments give the time at the first sample, before each gap, and at the last sample.
//! The last lines give the numbers of samples and events, which reveal a truncated file.

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
    /// Records the next samples, and the unusual steps in their times. Removes from `chunk` the rows that are not
    /// finite, because these must not be encoded.
    ///
    /// # Errors
    /// Returns an error if the file cannot hold the samples.
    fn observe(&mut self, chunk: &mut Chunk, steps: &[Step]) -> Result<()>;

    /// Writes events. After this call, the events of the first `decided` finite samples are complete. Later calls must
    /// pass only events of later samples.
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

    /// Returns the next item. The last item is [`Item::End`].
    ///
    /// # Errors
    /// Returns an error if an item is invalid, or if the end of the file is missing.
    fn next(&mut self) -> Result<Item>;

    /// Returns the place of the item that was read last. Errors name this place.
    fn place(&self) -> Place;

    /// Returns notes on the file, to be shown to the user. The notes are complete once the last item was read.
    fn notes(&mut self) -> Vec<String> {
        Vec::new()
    }
}
