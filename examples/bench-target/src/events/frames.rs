//! Rows of a camera through each code of pixels, where nothing changes, where an edge passes, and where all changes.

use core::{
    fmt::{self, Write},
    hint::black_box,
};

use board::stopwatch::{counted, keep};
use spikewire::Tick;
use spikewire_cameras::frame::{FrameEncoder, Intensity, LogIntensity, PixelCode, Refractory};

use super::{
    ensure,
    meter::{Cost, take},
};

const W: usize = 160;
/// Few, as the rows are alike and a Cortex-M0 has not much room.
const H: usize = 4;
const FRAMES: u32 = 20;

/// What the camera sees.
#[derive(Clone, Copy)]
enum Scene {
    /// Every sample flickers, within the thresholds.
    Rest,
    /// An edge of four columns passes, a column a frame.
    Edge,
    /// Every pixel goes up and down by 100.
    All,
}

impl Scene {
    const EACH: [(Self, &'static str); 3] =
        [(Self::Rest, "rest"), (Self::Edge, "edge"), (Self::All, "all")];

    fn row(self, frame: u32, y: usize) -> [u8; W] {
        let column = (frame as usize + y) % W;
        core::array::from_fn(|x| {
            let flicker = (x as u32 * 7 + y as u32 * 13 + frame * 5) % 5;
            let edge = matches!(self, Self::Edge) && (x + W - column) % W < 4;
            let all = matches!(self, Self::All) && frame % 2 == 1;
            100 + flicker as u8 + if edge || all { 100 } else { 0 }
        })
    }
}

#[inline(never)] // leaves the stack before the next one comes
pub fn measure(out: &mut impl Write) -> fmt::Result {
    code(out, "frame-intensity", const { &Intensity::new(10) })?;
    code(out, "frame-log-u8", const { &LogIntensity::<u8>::new(9, 9) })?;
    code(out, "frame-log-u16", const { &LogIntensity::<u16>::new(205, 205) })?;
    code(out, "frame-refractory", const { &Refractory::new(Intensity::new(10), 1) })
}

#[inline(never)] // leaves the stack before the next one comes
fn code<C: PixelCode>(out: &mut impl Write, subject: &str, code: &C) -> fmt::Result {
    for (scene, name) in Scene::EACH {
        let mut camera = FrameEncoder::<C, W, H>::new(*black_box(code));
        let mut events = 0;
        let mut cost = Cost::default();
        for frame in 0..FRAMES {
            let tick = black_box(Tick::from(frame));
            for y in 0..H {
                let row = scene.row(frame, y);
                let row = black_box(&row);
                let call =
                    *cost.call.get_or_insert_with(|| counted(|| take(&mut camera, &tick, row)));
                let count = counted(|| encode(&mut camera, &tick, y, row, &mut events));
                // The first frame sets the bases.
                if frame > 0 {
                    cost.add(W, 0, count.saturating_sub(call));
                }
            }
        }
        ensure(out, (events == 0) == matches!(scene, Scene::Rest), subject)?;
        cost.print(out, (subject, name), None, "pixel")?;
    }
    Ok(())
}

#[inline(never)]
fn encode<C: PixelCode>(
    camera: &mut FrameEncoder<C, W, H>,
    tick: &Tick,
    y: usize,
    row: &[u8; W],
    events: &mut u32,
) {
    camera.encode_row(*tick, y, row, |event| {
        keep(&event);
        *events += 1;
    });
}
