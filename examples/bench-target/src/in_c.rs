//! The encoders of `plain.c`.

use core::ffi::c_void;

use board::stopwatch::{Count, counted};
use catalogue::Scaled;
use fixed::types::{I8F8, I16F16};
use spikewire::{Sample, temporal::TemporalContrast};

/// An encoder: samples, their number, parameters and spikes.
type Encode = unsafe extern "C" fn(*mut c_void, usize, *const c_void, *mut i8);

/// A sample type for which `plain.c` is compiled.
pub trait InC {
    /// Every encoder by the name that the catalogue has for its codec.
    const ENCODERS: &'static [(&'static str, Encode)];
}

macro_rules! in_c {
    ($([$sample:ty] $($name:literal $encode:ident),*;)*) => {
        #[cfg(target_os = "none")]
        unsafe extern "C" {
            $($(fn $encode(x: *mut c_void, n: usize, p: *const c_void, out: *mut i8);)*)*
        }
        $(in_c!(@ $sample, &[$(#[cfg(target_os = "none")] ($name, $encode)),*]);)*
    };
    (@ $sample:ty, $encoders:expr) => {
        impl InC for $sample {
            const ENCODERS: &'static [(&'static str, Encode)] = $encoders;
        }
    };
}

in_c! {
    [f32] "tbr" plain_tbr_float, "sf" plain_sf_float, "sod-4" plain_sod_float,
        "mw-5" plain_mw_float, "if" plain_if_float, "lif" plain_lif_float,
        "sigma-delta" plain_sigma_delta_float, "weighted-phase-8" plain_weighted_phase_float,
        "hsa-15" plain_hsa_float;
    [I16F16] "tbr" plain_tbr_int32_t, "sf" plain_sf_int32_t, "sod-4" plain_sod_int32_t,
        "mw-5" plain_mw_int32_t, "if" plain_if_int32_t, "lif" plain_lif_int32_t,
        "sigma-delta" plain_sigma_delta_int32_t, "weighted-phase-8" plain_weighted_phase_int32_t,
        "hsa-15" plain_hsa_int32_t;
    [i16] "tbr" plain_tbr_int16_t, "sf" plain_sf_int16_t, "sod-4" plain_sod_int16_t,
        "mw-5" plain_mw_int16_t, "if" plain_if_int16_t, "lif" plain_lif_int16_t,
        "sigma-delta" plain_sigma_delta_int16_t, "weighted-phase-8" plain_weighted_phase_int16_t,
        "hsa-15" plain_hsa_int16_t;
    [I8F8];
}

/// Encodes with the parameters of the catalogue's instance, and returns what that cost.
pub fn encode<S: Sample + InC>(
    codec: &str,
    scaled: &Scaled<S>,
    taps: &[S],
    samples: &mut [S],
    spikes: &mut [i8],
) -> Option<Count> {
    let (_, encode) = S::ENCODERS.iter().find(|(name, _)| *name == codec)?;
    let threshold = match codec {
        "tbr" => TemporalContrast::from_magnitudes(&scaled.calibration, 0.5).ok()?.threshold(),
        "mw-5" => scaled.part(0.25),
        "sf" | "sod-4" => scaled.part(0.5),
        _ => scaled.part(1.0),
    };
    let parameters: &[S] = match codec {
        "hsa-15" => taps,
        "sigma-delta" | "weighted-phase-8" => &[scaled.min, scaled.max],
        _ => &[threshold],
    };
    let (length, samples, spikes) =
        (samples.len().min(spikes.len()), samples.as_mut_ptr().cast(), spikes.as_mut_ptr());
    let parameters = parameters.as_ptr().cast();
    // SAFETY: there are `length` samples and spikes, and HSA's instance has the 15 taps that it takes.
    Some(counted(|| unsafe { encode(samples, length, parameters, spikes) }))
}
