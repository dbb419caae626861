//! Videos: frames in, events of pixels and pictures of them out.

mod ffmpeg;
mod pictures;
mod preview;
mod sink;
mod video;
mod y4m;

pub(crate) use preview::Preview;
pub(crate) use sink::Sink;
pub(crate) use video::{Rate, open};
