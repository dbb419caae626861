//! Cameras: every code of pixels by rows, frames and slots, their decoders, and the formats with columns and rows.

use core::hint::black_box;

use spikewire::{Event, Keyframe};
use spikewire_cameras::{
    format::{Dvs, EventDecoder, EventFormat, Evt2Pixels, Evt3Pixels, Evt21Order, Evt21Pixels},
    frame::{
        FrameDecoder, FrameEncoder, Intensity, LogIntensity, PixelCode, PixelEvent, Refractory,
    },
};

use crate::exercise::{EVENTS, event, hide, tick};

/// Not whole fours, so that the rest of a row is there too.
const W: usize = 35;
const H: usize = 3;

pub fn link() {
    let threshold = black_box(10);
    if let Ok(code) = Intensity::try_new(threshold).and_then(|code| code.try_with_most(threshold)) {
        hide(code.threshold());
        camera(code);
        if let Ok(code) = Refractory::try_new(code, black_box(2)) {
            camera(code);
        }
    }
    if let Ok(code) = LogIntensity::<u8>::try_new(threshold, black_box(9)) {
        camera(code);
    }
    let on = black_box(205_u16);
    if let Ok(code) = LogIntensity::try_new(on, on).and_then(|code| code.try_with_most(threshold)) {
        hide(code.thresholds());
        camera(code);
        if let Ok(code) = Refractory::try_new(code, black_box(2)) {
            camera(code);
        }
    }
    formats();
}

fn camera<C: PixelCode>(code: C) {
    let camera = black_box(FrameEncoder::<C, W, H>::new(code));
    let Ok(camera) = camera.try_with_budget(black_box(100)) else { return };
    let Ok(mut camera) = camera.try_with_first_address(black_box(6)) else { return };
    let frame = black_box([[7; W]; H]);
    camera.encode_row(tick(), black_box(1), &frame[0], hide);
    camera.encode_row_into(tick(), black_box(1), &frame[0], &EVENTS);
    camera.encode_frame(tick(), &frame, hide);
    camera.encode_frame_into(tick(), &frame, &EVENTS);
    camera.encode_interpolated(tick(), &frame, hide);
    camera.keyframe_row_into(tick(), black_box(1), &EVENTS);
    hide(camera.base(black_box(1), black_box(2)).map(Into::into));
    hide((camera.over_budget(), camera.outside(), *camera.code()));
    camera.reset();
    hide(camera);

    let picture = black_box(FrameDecoder::<C, W, H>::new(code));
    let Ok(mut picture) = picture.try_with_first_address(black_box(6)) else { return };
    picture.start(&frame);
    picture.event(event());
    picture.decode(pixel());
    picture.keyframe(Keyframe::new(tick(), black_box(9), black_box(100_i16)));
    picture.rows().for_each(hide);
    hide((picture.row(black_box(1)), picture.outside()));
    hide(picture.base(black_box(1), black_box(2)).map(Into::into));
    hide(picture);
}

fn pixel() -> PixelEvent {
    let Event { tick, polarity, .. } = event();
    black_box(PixelEvent { tick, x: 5, y: 2, polarity })
}

fn formats() {
    hide(pixel().to_event(black_box(35), black_box(6)));
    hide(PixelEvent::from_event(event(), black_box(35), black_box(1)));
    let camera = Dvs::new(black_box(320), black_box(240));
    hide(camera.header());
    format(camera.encoder_from(tick()), Dvs::decoder_from(tick()));
    let mut stream = Dvs::decoder();
    hide((stream.push(black_box(1)), stream.size(), stream.is_foreign()));
    format(Evt2Pixels::encoder(), Evt2Pixels::file_decoder());
    format(Evt3Pixels::encoder(), Evt3Pixels::decoder());
    format(Evt2Pixels::encoder(), Evt21Pixels::decoder(black_box(Evt21Order::Halves)));
}

fn format(mut encoder: impl EventFormat<PixelEvent>, mut decoder: impl EventDecoder<PixelEvent>) {
    let mut bytes = black_box([0; 16]);
    let length = black_box(7);
    hide(encoder.encode(pixel(), bytes.get_mut(..length).unwrap_or_default()).is_ok());
    hide(encoder.retimed());
    decoder.decode(&bytes).for_each(hide);
    hide((decoder.skipped(), decoder.is_partial()));
}
