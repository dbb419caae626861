//! Every scheme of the crate once.
//!
//! A scheme's file under `schemes` says its names, its parameters with their units and the paper's presets, which
//! instances of it the firmware flies and counts, its plain transcription, and, with the feature `run`, how to build it
//! from options. Firmware, tests, instruction counts and the laptop program are visitors: they ask for all entries and
//! know none by name.
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
pub use state::State;

/// Calls a function that is not inlined: a small board has room for one scheme at a time on its stack.
#[inline(never)]
fn apart<R>(call: impl FnOnce() -> R) -> R {
    call()
}

/// Declares the modules of the schemes, and what runs over all of them.
macro_rules! schemes {
    ($($module:ident),* $(,)?) => {
        /// The entries, a file each.
        #[allow(clippy::needless_range_loop)] // transcriptions go index by index, as pseudo-code does
        pub mod schemes {
            $(pub mod $module;)*
        }

        /// The description of every scheme, in the order of the catalogue.
        pub const INFO: &[Info] = &[$(<schemes::$module::Scheme as Entry>::INFO),*];

        /// The forms in C of every scheme, in the order of the catalogue.
        pub const IN_C: &[(&Info, &[InC])] =
            &[$((&<schemes::$module::Scheme as Entry>::INFO, <schemes::$module::Scheme as Entry>::IN_C)),*];

        /// Hands every flown instance of every scheme to a visitor.
        ///
        /// # Errors
        /// Those of the visitor, and parameters that a channel's calibration makes bad.
        pub fn fly<V: Flight>(
            channel: &Channel<V::Sample>,
            visitor: &mut V,
        ) -> Result<(), V::Error> {
            $(apart(|| <schemes::$module::Scheme as Entry>::fly(channel, visitor))?;)*
            Ok(())
        }

        /// Hands every counted instance of every scheme of a part, with its plain transcription, to a visitor.
        ///
        /// # Errors
        /// Those of the visitor, and parameters that the signal makes bad.
        pub fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
            $(
                if Number::$module as usize * V::PARTS / INFO.len() == V::PART {
                    apart(|| <schemes::$module::Scheme as Entry>::count(signal, visitor))?;
                }
            )*
            Ok(())
        }

        /// The place of a scheme in the catalogue.
        #[allow(non_camel_case_types)]
        enum Number {
            $($module),*
        }

        /// Every scheme, to be chosen at run time.
        #[cfg(feature = "run")]
        pub static ALL: &[&dyn run::RunTime] = &[$(&schemes::$module::Scheme),*];

        /// Builds the scheme of this name in a sample type and hands it to a visitor.
        ///
        /// # Errors
        /// Returns an error if there is no such scheme, a parameter makes no sense, or the visitor returns one.
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
