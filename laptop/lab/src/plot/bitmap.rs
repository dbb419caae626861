//! Draws PNG pictures with the crate `tiny-skia`. Lines have round joins, as in the SVG pictures.

use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, DrawingBackend, DrawingErrorKind,
};
use std::convert::Infallible;
use tiny_skia::{
    Color, FillRule, LineJoin, Paint, Path, PathBuilder, Pixmap, PremultipliedColorU8, Stroke,
    Transform,
};

/// A picture in memory, on which the crate `plotters` draws.
pub(super) struct Bitmap<'a> {
    pixels: &'a mut Pixmap,
}

type Drawn = Result<(), DrawingErrorKind<Infallible>>;

impl<'a> Bitmap<'a> {
    pub(super) fn new(pixels: &'a mut Pixmap) -> Self {
        Self { pixels }
    }

    fn stroke<S: BackendStyle>(&mut self, path: Option<Path>, style: &S) {
        // A line of length 0 makes no path.
        let Some(path) = path else { return };
        let stroke = Stroke {
            width: style.stroke_width() as f32,
            line_join: LineJoin::Round,
            ..Stroke::default()
        };
        self.pixels.stroke_path(&path, &paint(style), &stroke, centred(), None);
    }
}

impl DrawingBackend for Bitmap<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        (self.pixels.width(), self.pixels.height())
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    /// Blends a pixel of a glyph into the picture; `color.alpha` is the share of the pixel that the glyph covers.
    fn draw_pixel(&mut self, (x, y): BackendCoord, color: BackendColor) -> Drawn {
        let (width, height) = self.get_size();
        let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) else { return Ok(()) };
        if x >= width || y >= height {
            return Ok(());
        }
        let part = color.alpha.clamp(0.0, 1.0);
        let over = |new: u8, old: u8| {
            (f64::from(new) * part + f64::from(old) * (1.0 - part)).round() as u8
        };
        if let Some(pixel) = self.pixels.pixels_mut().get_mut((y * width + x) as usize) {
            let (red, green, blue) = color.rgb;
            let alpha = over(u8::MAX, pixel.alpha());
            let blended = PremultipliedColorU8::from_rgba(
                over(red, pixel.red()).min(alpha),
                over(green, pixel.green()).min(alpha),
                over(blue, pixel.blue()).min(alpha),
                alpha,
            );
            *pixel = blended.unwrap_or(*pixel);
        }
        Ok(())
    }

    fn draw_line<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
    ) -> Drawn {
        self.stroke(path([from, to], false), style);
        Ok(())
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        points: I,
        style: &S,
    ) -> Drawn {
        self.stroke(path(points, false), style);
        Ok(())
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        (left, top): BackendCoord,
        (right, bottom): BackendCoord,
        style: &S,
        fill: bool,
    ) -> Drawn {
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
        if fill {
            return self.fill_polygon(corners, style);
        }
        self.stroke(path(corners, true), style);
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        style: &S,
    ) -> Drawn {
        if let Some(path) = path(corners, true) {
            let upright = Transform::identity();
            self.pixels.fill_path(&path, &paint(style), FillRule::Winding, upright, None);
        }
        Ok(())
    }
}

/// Returns the shift by half a pixel that puts lines on the middle of pixels.
fn centred() -> Transform {
    Transform::from_translate(0.5, 0.5)
}

fn paint<S: BackendStyle>(style: &S) -> Paint<'static> {
    let BackendColor { alpha, rgb: (red, green, blue) } = style.color();
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    let alpha = (alpha.clamp(0.0, 1.0) * f64::from(u8::MAX)).round() as u8;
    paint.set_color(Color::from_rgba8(red, green, blue, alpha));
    paint
}

fn path(points: impl IntoIterator<Item = BackendCoord>, is_closed: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for (place, (x, y)) in points.into_iter().enumerate() {
        let (x, y) = (x as f32, y as f32);
        if place == 0 { builder.move_to(x, y) } else { builder.line_to(x, y) }
    }
    if is_closed {
        builder.close();
    }
    builder.finish()
}
