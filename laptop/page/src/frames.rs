//! Grey frames of a video to the events of an event camera, as they come.

use crate::host::{Dropped, send};
use anyhow::Result;
use flight_logs::files::Bytes;
use serde::Deserialize;
use serde_json::{Value, json};
use spikewire_cameras::frame::{DynamicFrameEncoder, Intensity};
use spikewire::{Polarity, Tick};
use std::cell::RefCell;

/// A frame, row-major in a lent file, and how it is encoded.
#[derive(Deserialize)]
pub(crate) struct Frame {
    width: u16,
    height: u16,
    /// Grey levels that a pixel must differ from what it sent last.
    threshold: u8,
    /// Whether the frame begins a video.
    is_first: bool,
    file: u32,
}

thread_local! {
    static ENCODER: RefCell<Option<DynamicFrameEncoder<Intensity>>> = const { RefCell::new(None) };
}

/// Takes the next frame: for each pixel 2 if it sent that it is brighter, 1 if darker, 0 if nothing.
pub(crate) fn next(frame: &Frame) -> Result<Value> {
    let (width, height) = (frame.width, frame.height);
    let bytes = Dropped(frame.file);
    let mut grey = vec![0; bytes.len() as usize];
    bytes.read_at(0, &mut grey)?;
    ENCODER.with_borrow_mut(|own| {
        if frame.is_first {
            *own = None;
        }
        let encoder = match own {
            Some(encoder) => encoder,
            None => own.insert(DynamicFrameEncoder::try_new(
                Intensity::try_new(frame.threshold)?,
                width,
                height,
            )?),
        };
        let (mut pixels, mut events) = (vec![0_u8; grey.len()], 0_u32);
        encoder.encode_frame(Tick::default(), &grey, |event| {
            let place = usize::from(event.y) * usize::from(width) + usize::from(event.x);
            if let Some(pixel) = pixels.get_mut(place) {
                *pixel = if event.polarity == Polarity::Up { 2 } else { 1 };
            }
            events += 1;
        })?;
        send("pixels", &pixels);
        Ok(json!({ "events": events }))
    })
}
