//! Files of spikes: `index,address,polarity` below `# key=value` lines with all that decoding needs.
//!
//! With sub-timesteps, `index` counts those: sample times slots, plus the slot. The last lines say how
//! many samples and events there were, so that a file that is cut short is noticed. Values that were
//! not finite and gaps in time are told where they occur.

mod header;
mod reader;
mod writer;

pub use header::Header;
pub use reader::{Item, Reader};
pub use writer::{Summary, Writer};
