//! Rotation from the sensor's axes to the vehicle's.

use crate::Sample;

/// Orientation of a sensor on its board: a turn about z, clockwise as seen from above, with the sensor's face up or down.
///
/// The names are Betaflight's (`GYRO_1_ALIGN` in a board's `config.h`), so that a board's value can be copied. The vehicle's
/// axes point forward, left and up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Alignment {
    /// As the vehicle.
    #[default]
    Cw0,
    /// Turned by 90°.
    Cw90,
    /// Turned by 180°.
    Cw180,
    /// Turned by 270°.
    Cw270,
    /// On the board's lower side.
    Cw0Flip,
    /// On the lower side, turned by 90°.
    Cw90Flip,
    /// On the lower side, turned by 180°.
    Cw180Flip,
    /// On the lower side, turned by 270°.
    Cw270Flip,
}

impl Alignment {
    /// Rotates a sample into the vehicle's axes. The lowest count, which has no opposite, becomes the highest.
    #[must_use]
    pub const fn apply(self, [rx, ry, rz, ax, ay, az]: Sample) -> Sample {
        let [rx, ry, rz] = self.rotate([rx, ry, rz]);
        let [ax, ay, az] = self.rotate([ax, ay, az]);
        [rx, ry, rz, ax, ay, az]
    }

    const fn rotate(self, [x, y, z]: [i16; 3]) -> [i16; 3] {
        let [nx, ny, nz] = [x.saturating_neg(), y.saturating_neg(), z.saturating_neg()];
        match self {
            Self::Cw0 => [x, y, z],
            Self::Cw90 => [y, nx, z],
            Self::Cw180 => [nx, ny, z],
            Self::Cw270 => [ny, x, z],
            Self::Cw0Flip => [nx, y, nz],
            Self::Cw90Flip => [y, x, nz],
            Self::Cw180Flip => [x, ny, nz],
            Self::Cw270Flip => [ny, nx, nz],
        }
    }
}
