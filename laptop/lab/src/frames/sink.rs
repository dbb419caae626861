//! Writes pixel events to files in an event format.

use super::FramesKind;
use crate::Result;
use crate::output::Output;
use spikewire::{Polarity, Tick};
use spikewire_cameras::format::{
    Dvs, DvsEncoder, EventFormat, Evt2Pixels, Evt2PixelsEncoder, FormatError,
};
use spikewire_cameras::frame::PixelEvent;
use std::io::Write;
use std::path::Path;

/// A file of pixel events. The ending of the file's name selects the format.
pub struct Sink {
    output: Output,
    format: Kind,
}

enum Kind {
    Dvs(DvsEncoder),
    Evt2(Evt2PixelsEncoder),
    Csv,
}

impl Sink {
    /// Opens the file and writes its header.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written, if its ending is unknown, or if its format cannot express a
    /// picture of this size.
    pub fn open(path: &Path, input: &Path, (width, height): (u16, u16)) -> Result<Self> {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let format = match ending.as_str() {
            "es" => Kind::Dvs(Dvs::new(width, height).encoder()),
            "raw" if width > 2048 || height > 2048 => {
                return Err(FramesKind::LargeEvt2 { width, height }.at(path));
            }
            "raw" => Kind::Evt2(Evt2Pixels::encoder()),
            "csv" => Kind::Csv,
            _ => return Err(FramesKind::EventsEnding.at(path)),
        };
        let mut output = Output::open(Some(path), input)?;
        match format {
            Kind::Dvs(_) => output.write_all(&Dvs::new(width, height).header())?,
            Kind::Evt2(_) => write!(
                output,
                "% evt 2.0\n% format EVT2;height={height};width={width}\n% geometry {width}x{height}\n% end\n"
            )?,
            Kind::Csv => writeln!(output, "tick,x,y,polarity")?,
        }
        Ok(Self { output, format })
    }

    /// Writes an event.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub fn write(&mut self, event: PixelEvent) -> Result<()> {
        let Self { output, format } = self;
        match format {
            Kind::Dvs(encoder) => encode(encoder, event, output),
            Kind::Evt2(encoder) => encode(encoder, event, output),
            Kind::Csv => {
                let PixelEvent { tick, x, y, polarity } = event;
                let sign = if polarity == Polarity::Up { 1 } else { -1 };
                Ok(writeln!(output, "{},{x},{y},{sign}", Tick::micros(tick))?)
            }
        }
    }

    /// Finishes the file, renames it from its temporary name to its final one, and returns its length in bytes.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub fn finish(self) -> Result<u64> {
        let bytes = self.output.bytes();
        self.output.finish()?;
        Ok(bytes)
    }
}

fn encode(
    encoder: &mut impl EventFormat<PixelEvent>,
    event: PixelEvent,
    output: &mut Output,
) -> Result<()> {
    let mut buffer = [0; 4096];
    loop {
        match encoder.encode(event, &mut buffer) {
            Ok(length) => return Ok(output.write_all(&buffer[..length])?),
            Err(FormatError::Full { written }) => output.write_all(&buffer[..written])?,
            Err(error) => return Err(FramesKind::NoWord { error }.into()),
        }
    }
}
