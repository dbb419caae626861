//! Converts video frames to pixel events, and draws the events as pictures.

mod ffmpeg;
mod kinds;
mod pictures;
mod preview;
mod sink;
mod video;
mod y4m;

pub use kinds::FramesKind;
pub use preview::Preview;
pub use sink::Sink;
pub use video::{Rate, open};
