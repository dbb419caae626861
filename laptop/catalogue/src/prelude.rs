//! The items that a scheme's file imports.

pub(crate) use spikewire::{Sample, Start};

pub(crate) use crate::entry::spike_of;
pub(crate) use crate::plain::{self, Plain};
pub(crate) use crate::{
    Argument, Channel, Count, Entry, Flight, Flown, InC, Info, Kind, Made, Paper, Parameter,
    Scaled, Search, StepErrors, Unit,
};

#[cfg(feature = "run")]
pub(crate) use {
    crate::run::{
        Asked, Build, Constant, Counted, Error, ErrorKind, FEW, Given, Needs, Outcome, Outcomes,
        Parabola, Piece, Resolve, Result, Rust, Settings, Shape, Value, Visit, above, below, costs,
        lengthened, missing, outcomes, population, state,
    },
    spikewire::dynamic,
};
