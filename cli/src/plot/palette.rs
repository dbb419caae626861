//! Colours: the paper's blue signal and orange reconstruction, and its colours of the schemes.

use crate::scheme::SchemeName;
use plotters::style::RGBColor;

pub(super) const SIGNAL: RGBColor = RGBColor(0x1f, 0x5f, 0xa8);
pub(super) const DECODED: RGBColor = RGBColor(0xe8, 0x7d, 0x1e);
pub(super) const INK: RGBColor = RGBColor(0x30, 0x34, 0x3b);
pub(super) const QUIET: RGBColor = RGBColor(0x66, 0x6c, 0x76);
pub(super) const GRID: RGBColor = RGBColor(0xe3, 0xe6, 0xea);
pub(super) const UP: RGBColor = RGBColor(0x2b, 0x2f, 0x36);
pub(super) const DOWN: RGBColor = RGBColor(0xc2, 0x3b, 0x4e);

/// The colour of a scheme in the panel of efficiencies.
pub(super) fn of(scheme: SchemeName) -> RGBColor {
    match scheme {
        SchemeName::Sf => RGBColor(0xe9, 0xc4, 0x3a),
        SchemeName::Hsa => RGBColor(0x5b, 0xa8, 0x5a),
        SchemeName::THsa => RGBColor(0x3f, 0xb6, 0xc4),
        SchemeName::Tbr => RGBColor(0x3b, 0x6f, 0xb6),
        SchemeName::Bsa => RGBColor(0x8a, 0x5c, 0xb0),
        SchemeName::Mw => RGBColor(0xe0, 0x85, 0x3a),
        _ => RGBColor(0x9a, 0xa1, 0xab),
    }
}
