//! Files of spikes: `index,address,polarity` below `# key=value` lines with all that decoding needs.
//!
//! With sub-timesteps, `index` counts those: sample times slots, plus the slot. The last lines say how
//! many samples and events there were, so that a file that is cut short is noticed. Values that were
//! not finite and gaps in time are told where they occur, and so are the times there, at the first and at
//! the last sample. The neurons of a second channel are numbered on from those of the first.

mod header;
mod reader;
mod writer;

pub(crate) use header::{Header, unrecorded};
pub(crate) use reader::{Item, Reader};
pub(crate) use writer::{Summary, Writer};
