//! Videos of any file format, as sequences of grey frames.

use super::{FramesKind, ffmpeg, pictures, y4m};
use crate::{Error, Result};
use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// A sequence of grey frames of one size.
pub trait Video {
    /// Returns the width and height of a frame, in pixels.
    fn size(&self) -> (u16, u16);

    /// Returns the frame rate, if the file contains it.
    fn rate(&self) -> Option<Rate>;

    /// Returns the number of frames, if it is known in advance.
    fn frames(&self) -> Option<u64>;

    /// Reads the next frame into the buffer, row by row; returns false at the end.
    ///
    /// # Errors
    /// Returns an error if the frame cannot be read, or if its size differs from the first frame's.
    fn next(&mut self, frame: &mut Vec<u8>) -> Result<bool>;
}

/// A frame rate as a fraction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rate {
    frames: u64,
    seconds: u64,
}

impl Rate {
    /// Makes the rate of `frames` frames in `seconds` seconds. Returns `None` if either number is 0.
    pub fn new(frames: u64, seconds: u64) -> Option<Self> {
        (frames > 0 && seconds > 0).then_some(Self { frames, seconds })
    }

    /// Returns the time in µs of a frame. `frame` is the frame's index, and frame 0 has time 0.
    pub fn micros(self, frame: u64) -> u64 {
        (u128::from(frame) * 1_000_000 * u128::from(self.seconds) / u128::from(self.frames)) as u64
    }
}

impl FromStr for Rate {
    type Err = Error;

    /// Parses a frame rate in frames a second, such as `25`, `29.97` or `30000/1001`.
    fn from_str(text: &str) -> Result<Self> {
        let rate = if let Some((frames, seconds)) = text.split_once('/') {
            frames.parse().ok().zip(seconds.parse().ok())
        } else {
            let micro = |rate: f64| (rate * 1e6).clamp(0.0, 1e15) as u64;
            text.parse().ok().map(|rate| (micro(rate), 1_000_000))
        };
        rate.and_then(|(frames, seconds)| Self::new(frames, seconds))
            .ok_or_else(|| FramesKind::Rate { text: text.to_owned() }.into())
    }
}

/// Opens a video: YUV4MPEG2, a sequence of pictures, or any format that `ffmpeg` reads.
///
/// # Errors
/// Returns an error if the video is missing or cannot be read.
pub fn open(inputs: &[PathBuf]) -> Result<Box<dyn Video>> {
    let [input] = inputs else { return Ok(Box::new(pictures::Pictures::open(inputs.to_vec())?)) };
    if input == Path::new("-") {
        let stdin = BufReader::new(io::stdin());
        return Ok(Box::new(y4m::Y4m::open(stdin, "standard input".into(), None)?));
    }
    let cannot = |error| Error::open(input.display().to_string(), error);
    if input.is_dir() {
        let mut files = Vec::new();
        for entry in input.read_dir().map_err(cannot)? {
            let path = entry.map_err(cannot)?.path();
            if pictures::is_picture(&path) {
                files.push(path);
            }
        }
        files.sort();
        if files.is_empty() {
            return Err(FramesKind::NoPictures.at(input.as_path()));
        }
        return Ok(Box::new(pictures::Pictures::open(files)?));
    }
    let mut file = File::open(input).map_err(cannot)?;
    let mut magic = Vec::new();
    (&mut file).take(y4m::MAGIC.len() as u64).read_to_end(&mut magic).map_err(cannot)?;
    if magic == y4m::MAGIC {
        let file = File::open(input).map_err(cannot)?;
        let length = file.metadata().ok().filter(std::fs::Metadata::is_file).map(|data| data.len());
        return Ok(Box::new(y4m::Y4m::open(
            BufReader::new(file),
            input.display().to_string(),
            length,
        )?));
    }
    if pictures::is_picture(input) {
        return Ok(Box::new(pictures::Pictures::open(vec![input.clone()])?));
    }
    Ok(Box::new(ffmpeg::Converted::open(input)?))
}
