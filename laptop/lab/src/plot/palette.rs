//! The colours of pictures. As in the paper, the signal is blue and the reconstruction orange. Each scheme has the
//! colour that the scheme catalogue gives it.

use crate::scheme::Scheme;
use plotters::style::RGBColor;

pub(super) const SIGNAL: RGBColor = RGBColor(0x1f, 0x5f, 0xa8);
pub(super) const DECODED: RGBColor = RGBColor(0xe8, 0x7d, 0x1e);
pub(super) const INK: RGBColor = RGBColor(0x30, 0x34, 0x3b);
pub(super) const QUIET: RGBColor = RGBColor(0x66, 0x6c, 0x76);
pub(super) const GRID: RGBColor = RGBColor(0xe3, 0xe6, 0xea);
pub(super) const UP: RGBColor = RGBColor(0x2b, 0x2f, 0x36);
pub(super) const DOWN: RGBColor = RGBColor(0xc2, 0x3b, 0x4e);

/// Colour of the lines of schemes that form no part of the common Pareto front.
pub(super) const OTHERS: RGBColor = RGBColor(0xb8, 0xbd, 0xc5);
/// Colours that the colour-blind can tell apart, after Okabe and Ito.
pub(super) const DISTINCT: [RGBColor; 5] = [
    RGBColor(0x00, 0x72, 0xb2),
    RGBColor(0xd5, 0x5e, 0x00),
    RGBColor(0x00, 0x9e, 0x73),
    RGBColor(0xcc, 0x79, 0xa7),
    RGBColor(0x00, 0x00, 0x00),
];

/// Returns the catalogue's colour of a scheme, for the panel of efficiencies.
pub(super) fn of(scheme: Scheme) -> RGBColor {
    let [red, green, blue] = scheme.info().colour;
    RGBColor(red, green, blue)
}
