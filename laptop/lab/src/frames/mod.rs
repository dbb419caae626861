//! Converts video frames to pixel events, and renders those events as pictures.

mod ffmpeg;
mod pictures;
mod preview;
mod sink;
mod video;
mod y4m;

pub use preview::Preview;
pub use sink::Sink;
pub use video::{Rate, open};
