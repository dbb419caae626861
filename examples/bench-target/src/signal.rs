//! What the codecs are measured on.

use core::f64::consts::PI;

use fixed::{
    FixedI16, FixedI32,
    types::extra::{U8, U16},
};
use flight_data::{Record, records};
use rand_pcg::{Pcg32, rand_core::Rng};
use spikewire::Sample;

use crate::in_c::InC;
use catalogue::plain::Plain;

/// Samples of either signal.
pub const LENGTH: usize = 2000;

/// The recording's beginning.
static FLIGHT: [u8; LENGTH * Record::SIZE] = match flight_data::HEXAROTOR.first_chunk() {
    Some(beginning) => *beginning,
    None => panic!("the recording is too short"),
};

#[derive(Clone, Copy)]
pub enum Signal {
    /// The paper's sum of sines and noise, 20 s at 100 Hz.
    Paper,
    /// The recorded hexarotor's gyroscope around x, in rad/s: the first 10 s, with the take-off.
    Flight,
}

impl Signal {
    pub fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Flight => "flight",
        }
    }

    /// Fills a buffer in the sample type.
    pub fn load<S: Measured>(self, buffer: &mut [S; LENGTH]) {
        match self {
            Self::Paper => {
                let mut noise = Pcg32::new(1, 1);
                for (i, sample) in buffer.iter_mut().enumerate() {
                    let uniform = f64::from(noise.next_u32()) / 4_294_967_296.0;
                    *sample =
                        S::from_f64((clean(0.01 * (i + 1) as f64) - 0.5 * uniform) * S::UNITS);
                }
            }
            Self::Flight => {
                for (sample, record) in buffer.iter_mut().zip(records(&FLIGHT)) {
                    *sample = S::from_f64(f64::from(record.channels[0]) * S::UNITS);
                }
            }
        }
    }
}

/// The paper's signal at a time in seconds, without its noise.
fn clean(time: f64) -> f64 {
    2.0 * libm::sin(2.0 * PI * time) - 0.5 * libm::cos(0.5 * PI * time)
        + 0.75 * libm::sin(10.0 * PI * time)
}

/// A sample type that is measured.
pub trait Measured: Sample + Plain + InC {
    /// Units for 1 of the signal.
    const UNITS: f64 = 1.0;
}

impl Measured for f32 {}
impl Measured for FixedI32<U16> {}
impl Measured for FixedI16<U8> {}

/// Counts, about as fine as a sensor's.
impl Measured for i16 {
    const UNITS: f64 = 1000.0;
}
