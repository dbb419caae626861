//! Files of spikes: `index,address,polarity` below `# key=value` lines with all that decoding needs.
//!
//! With sub-timesteps, `index` counts those: sample times slots, plus the slot. The last lines say how
//! many samples and events there were, so that a file that is cut short is noticed. Values that were
//! not finite and gaps in time are told where they occur, and so are the times there, at the first and at
//! the last sample. The neurons of a second channel are numbered on from those of the first.

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

/// A file of one kind or another that takes spikes and samples.
pub trait Record {
    /// Takes note of the next samples and keeps the rows that are finite, for the encoder.
    ///
    /// # Errors
    /// The file cannot hold them.
    fn observe(&mut self, chunk: &mut Chunk, steps: &[Step]) -> Result<()>;

    /// Writes events. The encoder's next ones are of the finite sample `decided` or later.
    ///
    /// # Errors
    /// Returns an error if the spikes cannot be written.
    fn write(&mut self, events: &mut Vec<Event>, decided: u64) -> Result<()>;

    /// Writes the end and gives back the output.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    fn finish(self: Box<Self>, events: &mut Vec<Event>) -> Result<(Output, Summary)>;
}

/// A source of spikes, in the order of samples.
pub trait Spikes {
    /// Whether its events have times.
    fn is_timed(&self) -> bool;

    /// The next item; the last is [`Item::End`].
    ///
    /// # Errors
    /// Returns an error if an item makes no sense, or the end is missing.
    fn next(&mut self) -> Result<Item>;

    /// The place of the last item, for an error.
    fn place(&self) -> Place;

    /// Notes for the user on the file, complete after the last item.
    fn notes(&mut self) -> Vec<String> {
        Vec::new()
    }
}
