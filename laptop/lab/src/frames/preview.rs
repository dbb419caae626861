//! Draws a video and its events side by side: the frame, then a panel for each threshold.

use super::FramesKind;
use super::video::Rate;
use crate::Result;
use crate::output::Output;
use gif::{Encoder, Frame, Repeat};
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use spikewire::{Polarity, Tick};
use spikewire_cameras::frame::{DynamicFrameEncoder, Intensity};
use std::borrow::Cow;
use std::path::Path;

/// Number of greys in the palette, at the indexes 0 to 252. The indexes 253 to 255 are the colours of events and of
/// the background.
const GREYS: u16 = 253;
const UP: u8 = 253;
const DOWN: u8 = 254;
const PAPER: u8 = 255;
/// Margin around and between the panels, in pixels.
const GAP: usize = 6;
/// Maximum width of the picture, in pixels. Small videos are enlarged by a whole factor up to this width.
const WIDEST: usize = 1080;

/// Index of the frame that a still picture shows by default: about a second into a video.
const USUAL: u64 = 30;

/// A picture of one frame and its events, or an animation of all frames.
pub struct Preview {
    panels: Vec<DynamicFrameEncoder<Intensity>>,
    size: (usize, usize),
    scale: usize,
    canvas: Vec<u8>,
    /// Index of the last frame to draw.
    last: u64,
    file: Kind,
}

enum Kind {
    Png(Output),
    Gif(Box<Encoder<Output>>, Rate),
}

impl Preview {
    /// Opens the preview's file, `.png` or `.gif`. Each of `thresholds`, in grey levels, gets a panel. `last` is the
    /// index of the last frame to draw.
    ///
    /// # Errors
    /// Returns an error if the file's name ends in neither `.png` nor `.gif`, or if a threshold is 0 or 255.
    pub fn open(
        path: &Path,
        input: &Path,
        (width, height): (u16, u16),
        rate: Rate,
        thresholds: &[u8],
        last: Option<u64>,
    ) -> Result<Self> {
        let panels = thresholds
            .iter()
            .map(|&threshold| {
                let code = Intensity::try_new(threshold)?;
                DynamicFrameEncoder::try_new(code, width, height)
            })
            .collect::<Result<Vec<_>, _>>()?;
        let size = (usize::from(width), usize::from(height));
        let count = panels.len() + 1;
        let scale = (WIDEST / (count * size.0)).clamp(1, 4);
        let (columns, rows) = (count * (scale * size.0 + GAP) + GAP, scale * size.1 + 2 * GAP);
        let canvas = vec![PAPER; columns * rows];
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let file = match ending.as_str() {
            "png" => Kind::Png(Output::open(Some(path), input)?),
            "gif" => {
                let (Ok(columns), Ok(rows)) = (u16::try_from(columns), u16::try_from(rows)) else {
                    return Err(FramesKind::LargeGif { columns, rows }.at(path));
                };
                let output = Output::open(Some(path), input)?;
                let mut encoder = Encoder::new(output, columns, rows, &palette())?;
                encoder.set_repeat(Repeat::Infinite)?;
                Kind::Gif(Box::new(encoder), rate)
            }
            _ => return Err(FramesKind::PreviewEnding.at(path)),
        };
        let last = last.unwrap_or(if matches!(file, Kind::Png(_)) { USUAL } else { u64::MAX });
        Ok(Self { panels, size, scale, canvas, last, file })
    }

    /// Draws frame `index` of the video, unless it comes after the last frame to draw.
    ///
    /// # Errors
    /// Returns an error if the picture cannot be written.
    pub fn frame(&mut self, index: u64, frame: &[u8]) -> Result<()> {
        if index > self.last {
            return Ok(());
        }
        self.fill(0, |place| (u16::from(frame[place]) * (GREYS - 1) / 255) as u8);
        let mut shown = vec![PAPER; frame.len()];
        for panel in 0..self.panels.len() {
            shown.fill(PAPER);
            let (width, encoder) = (self.size.0, &mut self.panels[panel]);
            encoder.encode_frame(Tick::from(index as u32), frame, |event| {
                let up = event.polarity == Polarity::Up;
                shown[usize::from(event.y) * width + usize::from(event.x)] =
                    if up { UP } else { DOWN };
            })?;
            self.fill(panel + 1, |place| shown[place]);
        }
        let columns = self.columns();
        if let Kind::Gif(encoder, rate) = &mut self.file {
            let hundredths = |index| rate.micros(index) / 10_000;
            encoder.write_frame(&Frame {
                width: columns as u16,
                height: (self.canvas.len() / columns) as u16,
                delay: (hundredths(index + 1) - hundredths(index)) as u16,
                buffer: Cow::Borrowed(&self.canvas),
                ..Frame::default()
            })?;
        }
        Ok(())
    }

    fn columns(&self) -> usize {
        (self.panels.len() + 1) * (self.scale * self.size.0 + GAP) + GAP
    }

    /// Fills a panel; `colour` returns the palette index for each pixel of the frame, counted row by row.
    fn fill(&mut self, panel: usize, colour: impl Fn(usize) -> u8) {
        let (columns, scale, (width, height)) = (self.columns(), self.scale, self.size);
        let left = GAP + panel * (scale * width + GAP);
        for row in 0..scale * height {
            let start = (GAP + row) * columns + left;
            let source = row / scale * width;
            for (place, pixel) in self.canvas[start..start + scale * width].iter_mut().enumerate() {
                *pixel = colour(source + place / scale);
            }
        }
    }

    /// Finishes the file, and renames it from its temporary name to its final one.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub fn finish(self) -> Result<()> {
        let columns = self.columns();
        match self.file {
            Kind::Gif(encoder, _) => encoder.into_inner()?.finish(),
            Kind::Png(mut output) => {
                let palette = palette();
                let colours = |&index: &u8| palette[3 * usize::from(index)..][..3].to_vec();
                let pixels: Vec<u8> = self.canvas.iter().flat_map(colours).collect();
                let rows = self.canvas.len() / columns;
                let encoder = PngEncoder::new(&mut output);
                encoder.write_image(
                    &pixels,
                    columns as u32,
                    rows as u32,
                    ExtendedColorType::Rgb8,
                )?;
                output.finish()
            }
        }
    }
}

/// Returns the colours of the palette, three bytes each: red, green and blue. The palette begins with the greys, from
/// black to white. Three colours of the events panels follow: dark ink for pixels that became brighter, red for pixels
/// that became darker, and white for the background.
fn palette() -> Vec<u8> {
    let greys = (0..GREYS).flat_map(|grey| [(grey * 255 / (GREYS - 1)) as u8; 3]);
    greys.chain([0x2b, 0x2f, 0x36, 0xc2, 0x3b, 0x4e, 0xff, 0xff, 0xff]).collect()
}
