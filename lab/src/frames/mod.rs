//! Videos: frames in, events of pixels and pictures of them out.

mod ffmpeg;
mod pictures;
mod preview;
mod sink;
mod video;
mod y4m;

pub use preview::Preview;
pub use sink::Sink;
pub use video::{Rate, open};
