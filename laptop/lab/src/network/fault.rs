//! The reasons for which a network cannot be read, or cannot be brought onto a chip or the controller.

use super::controller::{Choice, Framework};
use crate::error::{At, room};
use crate::{Error, Place, Spot};
use catalogue::kinds;

pub(super) use crate::Result;

kinds! {
    /// The reason for which a network cannot be read, or does not fit its target.
    pub enum NetworkKind by spell of subject {
        Fault { what: String } => ("{what}"),
        OpenRule { framework: Option<Framework>, open: Vec<Choice> } => (
            "the file does not say by which rule its neurons step: {}",
            super::controller::words(spell, *framework, open)
        ),
        NoNetwork => ("neither a NIR graph, which is an HDF5 file, nor a network in JSON"),
        NotAnInput { word: String } => ("`{word}` is not the number of an input"),
        NoInputs { inputs: usize, step: Vec<u16> } =>
            ("the network has {inputs} inputs, and not those of {step:?}"),
        ShorterThanStep { tau: f64, step: f64 } => (
            "a time constant of {tau:e} s is shorter than a step of {step} s; {} gives the step that the network was \
             trained with",
            spell("dt")
        ),
        NorsesTime { tau: f64, step: f64, meant: f64 } => (
            "a time constant of {tau:e} s is shorter than a step of {step} s; Norse writes time constants times the dt \
             that it was called with (0.001 unless told): if that was {step} s, they are right with {} {meant}",
            spell("dt")
        ),
    }
}
room!(NetworkKind, Network);

/// Returns an error whose text is for people; programs can tell no more than that the network does not fit.
pub(super) fn fault(what: impl Into<String>) -> Error {
    NetworkKind::Fault { what: what.into() }.into()
}

/// Returns from the calling function with a [`NetworkKind::Fault`] whose text is formatted from the arguments.
macro_rules! bail {
    ($($words:tt)+) => {
        return Err($crate::network::fault::fault(format!($($words)+)))
    };
}
pub(super) use bail;

/// Returns from the calling function with a [`NetworkKind::Fault`] unless the condition holds.
macro_rules! ensure {
    ($condition:expr, $($words:tt)+) => {
        let holds: bool = $condition;
        if !holds {
            $crate::network::fault::bail!($($words)+);
        }
    };
}
pub(super) use ensure;

/// Adds to an error the part of the network in which it occurred, such as a layer; turns `None` into an error.
pub(super) trait Context<T> {
    fn context(self, part: impl Into<String>) -> Result<T>;

    fn with_context<S: Into<String>>(self, part: impl FnOnce() -> S) -> Result<T>;
}

impl<T, E: Into<Error>> Context<T> for Result<T, E> {
    fn context(self, part: impl Into<String>) -> Result<T> {
        self.at(|| Place::from(Spot::Part(part.into())))
    }

    fn with_context<S: Into<String>>(self, part: impl FnOnce() -> S) -> Result<T> {
        self.at(|| Place::from(Spot::Part(part().into())))
    }
}

impl<T> Context<T> for Option<T> {
    fn context(self, what: impl Into<String>) -> Result<T> {
        self.ok_or_else(|| fault(what))
    }

    fn with_context<S: Into<String>>(self, what: impl FnOnce() -> S) -> Result<T> {
        self.ok_or_else(|| fault(what()))
    }
}
