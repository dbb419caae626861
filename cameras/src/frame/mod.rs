//! Camera frames to events, as an event camera would send them: row by row, on the microcontroller.
//!
//! For small grey cameras, such as optical-flow sensors of 35 x 35 pixels up to QVGA. A pixel sends an event when
//! its sample leaves the value that it sent last, its base, by a threshold, and the base follows:
//!
//! | code | threshold in | state a pixel |
//! |---|---|---|
//! | [`Intensity`] | grey levels (step forward, send-on-delta) | 1 byte |
//! | [`LogIntensity<u8>`](LogIntensity) | contrast, as in a DVS; 46 levels for a factor of e | 1 byte |
//! | [`LogIntensity<u16>`](LogIntensity) | contrast, finer; 1024 levels | 2 bytes |
//! | [`Refractory`] | either, and silence after an event | 1 byte more |
//!
//! A [`FrameEncoder`] holds the pixels and takes a row a call, as the camera's DMA interrupt has it; a
//! [`FrameDecoder`] makes frames again. Events come in raster order.
//!
//! ```
//! use spikewire::{Polarity, Tick};
//! use spikewire_cameras::frame::{FrameDecoder, FrameEncoder, Intensity};
//!
//! const FLOW: Intensity = Intensity::new(10).with_most(4); // grey levels; events a pixel and frame
//!
//! let mut camera = FrameEncoder::<_, 4, 1>::new(FLOW); // may be a static itself
//! let mut events = Vec::new();
//! camera.encode_row(Tick::from_micros(0), 0, &[100, 100, 0, 255], |_| ()); // the first frame sets the bases
//! camera.encode_row(Tick::from_micros(16_667), 0, &[103, 95, 255, 20], |event| events.push(event));
//! assert_eq!(events.iter().filter(|event| event.polarity == Polarity::Up).count(), 4);
//!
//! let mut picture = FrameDecoder::<_, 4, 1>::new(FLOW);
//! picture.start(&[[100, 100, 0, 255]]);
//! events.into_iter().for_each(|event| picture.decode(event));
//! assert_eq!(picture.row(0), Some([100, 100, 40, 215]));
//! ```
//!
//! # On the wire
//!
//! [`encode_row_into`](FrameEncoder::encode_row_into) puts the events into a queue at the address `y * W + x`, so
//! that links, sinks and chips take them as any other; up to 65 536 pixels have an address. Formats with
//! coordinates take [`PixelEvent`]s of any size: [`Dvs`](crate::format::Dvs) (`.es`) and
//! [`Evt2Pixels`](crate::format::Evt2Pixels). EVT3 and AEDAT4 are left to the programs that convert from these.
//!
//! Keyframes set a decoder right after a loss. One of each pixel would be a flood: send them a
//! [row](FrameEncoder::keyframe_row_into) now and then.

mod band;
mod decoder;
#[cfg(feature = "alloc")]
mod dynamic;
mod encoder;
mod intensity;
mod log;
mod pass;
mod pixel;
mod pixel_event;
mod refractory;

pub use decoder::FrameDecoder;
#[cfg(feature = "alloc")]
pub use dynamic::{DynamicFrameEncoder, FrameSize};
pub use encoder::FrameEncoder;
pub use intensity::Intensity;
pub use log::{Level, LogIntensity};
pub use pixel::PixelCode;
pub use pixel_event::PixelEvent;
pub use refractory::{Refractory, Resting};
