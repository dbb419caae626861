//! A description of every scheme of the crate, as data.
//!
//! A scheme's file under `schemes` contains its names, its parameters with their units and the paper's values, the
//! instances that the firmware flies and counts, a plain transcription of its pseudo-code and, with the feature `run`,
//! how to build it from options. Firmware, tests, instruction counts and the laptop program are visitors: they ask for
//! all entries, and none of them names a scheme.
//!
//! To add a scheme: write its file in the crate, its file under `schemes`, and its line in the list below.

#![cfg_attr(not(any(feature = "run", test)), no_std)]

mod channel;
mod entry;
mod in_c;
mod info;
pub mod plain;
mod prelude;
#[cfg(feature = "run")]
pub mod run;
mod signal;
mod state;
pub mod toolbox;

pub use channel::Channel;
pub use entry::{Count, Entry, Flight};
pub use in_c::{Argument, Flown, InC, Made};
pub use info::{Found, Info, Kind, Paper, Parameter, Search, StepErrors, Unit};
pub use signal::Scaled;
pub use state::{State, Storable};

/// Calls a function without inlining it: a small board's stack has room for only one scheme at a time.
#[inline(never)]
fn apart<R>(call: impl FnOnce() -> R) -> R {
    call()
}

/// Declares the modules of the schemes, and the functions that visit all of them.
macro_rules! schemes {
    ($($module:ident),* $(,)?) => {
        /// The entries, one in each file.
        #[allow(clippy::needless_range_loop)] // transcriptions go index by index, as pseudo-code does
        pub mod schemes {
            $(pub mod $module;)*
        }

        /// Descriptions of all schemes, in the order of the catalogue.
        pub const INFO: &[Info] = &[$(<schemes::$module::Scheme as Entry>::INFO),*];

        /// Forms in C of all schemes, in the order of the catalogue.
        pub const IN_C: &[(&Info, &[InC])] =
            &[$((&<schemes::$module::Scheme as Entry>::INFO, <schemes::$module::Scheme as Entry>::IN_C)),*];

        /// Passes every instance of every scheme that flies to a visitor.
        ///
        /// # Errors
        /// Returns the visitor's errors, and an error if a channel's calibration gives an invalid parameter.
        pub fn fly<V: Flight>(
            channel: &Channel<V::Sample>,
            visitor: &mut V,
        ) -> Result<(), V::Error> {
            $(apart(|| <schemes::$module::Scheme as Entry>::fly(channel, visitor))?;)*
            Ok(())
        }

        /// Passes every counted instance of the visitor's part of the catalogue, with its plain transcription, to the
        /// visitor.
        ///
        /// # Errors
        /// Returns the visitor's errors, and an error if the signal gives an invalid parameter.
        pub fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
            $(
                if Number::$module as usize * V::PARTS / INFO.len() == V::PART {
                    apart(|| <schemes::$module::Scheme as Entry>::count(signal, visitor))?;
                }
            )*
            Ok(())
        }

        /// The index of a scheme in the catalogue.
        #[allow(non_camel_case_types)]
        enum Number {
            $($module),*
        }

        /// All schemes, for choosing one at run time.
        #[cfg(feature = "run")]
        pub static ALL: &[&dyn run::RunTime] = &[$(&schemes::$module::Scheme),*];

        /// Builds the scheme of this name in a sample type, and passes it to a visitor.
        ///
        /// # Errors
        /// Returns an error if there is no such scheme, if a parameter is invalid, or if the visitor returns one.
        #[cfg(feature = "run")]
        pub fn visit<S: spikewire::Sample, V: run::Visit<S>>(
            name: &str,
            settings: &run::Settings,
            visitor: V,
        ) -> run::Result<V::Output> {
            $(
                if name == <schemes::$module::Scheme as Entry>::INFO.name {
                    return <schemes::$module::Scheme as run::Build>::build(settings, visitor);
                }
            )*
            Err(run::Error::no_scheme(name))
        }
    };
}

schemes![
    tbr,
    atbr,
    mw,
    sf,
    sod,
    asf,
    bsa,
    hsa,
    t_hsa,
    integrate,
    lif,
    sigma_delta,
    bernoulli,
    burst_weighted,
    position,
    grf,
    grf_slots,
    grf_prob,
    grf_nonlinear,
    grf_nonlinear_slots,
    rank_order,
    ttfs,
    latency_phase,
    weighted_phase,
    burst,
];
