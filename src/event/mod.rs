//! Address events: time stamps, banks (samples to events), queues from the interrupt to main, and readouts (events to
//! values).

mod address;
mod bank;
mod bins;
#[cfg(feature = "heapless-09")]
mod counted;
mod item;
mod keyframe;
mod put;
#[cfg(feature = "queue")]
mod queue;
mod readout;
mod schemes;
mod source;
mod tick;

pub use address::Event;
#[cfg(feature = "link")]
pub(crate) use address::addressed;
pub use bank::Bank;
#[cfg(feature = "link")]
pub(crate) use bank::bank_fingerprint;
pub use bins::{Bins, StepOver};
#[cfg(feature = "heapless-09")]
pub use counted::{Container, Counted, Element};
pub use item::{Item, Taken};
pub use keyframe::Keyframe;
pub use put::Put;
#[cfg(feature = "queue")]
pub use queue::{
    Consumer, EventQueue, Overflow, Queue, QueueView, Refused, SpscConsumer, SpscProducer,
    SpscQueue,
};
#[cfg(feature = "link")]
pub(crate) use readout::Addresses;
pub use readout::Readout;
pub use schemes::Schemes;
#[cfg(feature = "link")]
pub(crate) use schemes::{CodeOf, DecoderStateOf, SampleOf, States};
pub use source::{AtMost, FromEvents, FromItems, Source};
pub use tick::Tick;
