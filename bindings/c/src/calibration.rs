//! Calibration of each sample type.

use fixed::FixedI16;
use fixed::FixedI32;
use fixed::types::extra::{U8, U16};
use spikewire::{Calibration, Sample};

use crate::kept::Kept;
use crate::{Status, pointer};

pub(crate) type Calibrating<S> = Kept<Calibration<S>>;

/// What a calibration has seen.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct CalibrationCounts {
    /// Finite samples that its results are taken from.
    pub seen: u32,
    /// Samples after those that it can count.
    pub ignored: u32,
    /// Samples that were not finite.
    pub rejected: u32,
}

/// # Safety
/// C's promise of [`pointer`].
unsafe fn observe<S: Sample>(
    calibration: *mut Calibrating<S>,
    samples: *const S,
    count: usize,
) -> Result<Status, Status> {
    // SAFETY: C's promise; any bytes are samples.
    let (calibration, samples) =
        unsafe { (Kept::exclusive(calibration)?, pointer::slice(samples, count)?) };
    for sample in samples {
        calibration.observe(*sample);
    }
    Ok(Status::OK)
}

/// # Safety
/// C's promise of [`pointer`].
unsafe fn range<S: Sample>(
    calibration: *const Calibrating<S>,
    min: *mut S,
    max: *mut S,
) -> Result<Status, Status> {
    // SAFETY: C's promise.
    let calibration = unsafe { Kept::shared(calibration) }?;
    // SAFETY: C's promise.
    let (min, max) = unsafe { (pointer::place(min)?, pointer::place(max)?) };
    let (Some(least), Some(largest)) = (calibration.min(), calibration.max()) else {
        return Err(Status::TOO_FEW_SAMPLES);
    };
    min.write(least);
    max.write(largest);
    Ok(Status::OK)
}

/// # Safety
/// C's promise of [`pointer`].
unsafe fn threshold<S: Sample>(
    calibration: *const Calibrating<S>,
    factor: f32,
    of_magnitudes: u8,
    threshold: *mut S,
) -> Result<Status, Status> {
    // SAFETY: C's promise.
    let (calibration, place) = unsafe { (Kept::shared(calibration)?, pointer::place(threshold)?) };
    let differences =
        if of_magnitudes == 0 { calibration.differences() } else { calibration.magnitudes() };
    let threshold = differences.and_then(|differences| differences.threshold(factor));
    place.write(S::from_f64(threshold.map_err(|error| crate::Error::from(error).status)?));
    Ok(Status::OK)
}

/// # Safety
/// C's promise of [`pointer`].
unsafe fn counts<S: Sample>(
    calibration: *const Calibrating<S>,
    counts: *mut CalibrationCounts,
) -> Result<Status, Status> {
    // SAFETY: C's promise.
    let (calibration, counts) = unsafe { (Kept::shared(calibration)?, pointer::place(counts)?) };
    counts.write(CalibrationCounts {
        seen: calibration.seen(),
        ignored: calibration.ignored(),
        rejected: calibration.rejected(),
    });
    Ok(Status::OK)
}

macro_rules! exported {
    ($($name:ident: $sample:ty;)*) => {
        $(
            mod $name {
                use super::*;

                #[unsafe(export_name = concat!("sw_calibration_", stringify!($name), "_init"))]
                unsafe extern "C" fn init(calibration: *mut Calibrating<$sample>) -> Status {
                    // SAFETY: C's promise.
                    unsafe { Kept::keep(calibration, Calibration::new()) }.into()
                }

                #[unsafe(export_name = concat!("sw_calibration_", stringify!($name), "_observe"))]
                unsafe extern "C" fn observed(
                    calibration: *mut Calibrating<$sample>,
                    samples: *const $sample,
                    count: usize,
                ) -> Status {
                    // SAFETY: C's promise.
                    unsafe { observe(calibration, samples, count) }.into()
                }

                #[unsafe(export_name = concat!("sw_calibration_", stringify!($name), "_range"))]
                unsafe extern "C" fn ranged(
                    calibration: *const Calibrating<$sample>,
                    min: *mut $sample,
                    max: *mut $sample,
                ) -> Status {
                    // SAFETY: C's promise.
                    unsafe { range(calibration, min, max) }.into()
                }

                #[unsafe(export_name = concat!("sw_calibration_", stringify!($name), "_threshold"))]
                unsafe extern "C" fn parted(
                    calibration: *const Calibrating<$sample>,
                    factor: f32,
                    of_magnitudes: u8,
                    at: *mut $sample,
                ) -> Status {
                    // SAFETY: C's promise.
                    unsafe { threshold(calibration, factor, of_magnitudes, at) }.into()
                }

                #[unsafe(export_name = concat!("sw_calibration_", stringify!($name), "_counts"))]
                unsafe extern "C" fn counted(
                    calibration: *const Calibrating<$sample>,
                    into: *mut CalibrationCounts,
                ) -> Status {
                    // SAFETY: C's promise.
                    unsafe { counts(calibration, into) }.into()
                }
            }
        )*
    };
}

exported! {
    f32: f32;
    i16: i16;
    q8_8: FixedI16<U8>;
    q16_16: FixedI32<U16>;
}
