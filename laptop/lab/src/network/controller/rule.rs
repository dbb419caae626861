//! The rule by which neurons decay, fire and reset, which a NIR file does not contain.

use super::open::Choice;
use crate::network::fault::{NetworkKind, Result};
use std::fmt::{self, Display};

/// The framework whose rule a network follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Framework {
    /// snnTorch, which trains with five kinds of reset and writes none of them into its files.
    SnnTorch,
    /// Norse.
    Norse,
    /// `SpikingJelly`.
    SpikingJelly,
    /// Rockpool.
    Rockpool,
    /// Sinabs.
    Sinabs,
    /// NIR's own reference program.
    Nir,
}

/// What a spike does to its neuron's potential; the names are those of the types in `spikewire-network`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reset {
    /// Sets the potential to `v_reset` in the same step.
    ToValue,
    /// Sets the potential to `v_reset` at the beginning of the next step.
    ToValueLate,
    /// Holds the potential at `v_reset` through the next step.
    ToValueHeld,
    /// Subtracts the threshold in the same step.
    Subtract,
    /// Subtracts the threshold in the next step.
    SubtractLate,
    /// snnTorch's subtraction with `reset_delay=False`.
    SubtractNoDelay,
    /// Leaves the potential as it is.
    NoReset,
}

/// How the potential is compared with the threshold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fires {
    /// Fires above the threshold.
    Above,
    /// Fires at or above the threshold.
    At,
}

/// How a time constant `tau` becomes the factor of a step of length `dt`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decay {
    /// 1 - dt / tau.
    Euler,
    /// e to the power of -dt / tau.
    Exponential,
}

/// Which current drives the potential, for neurons that have both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Current {
    /// The current of this step.
    New,
    /// The current of the step before.
    Old,
    /// The current of this step, to which a spike adds its whole weight, as in Norse's `LIFCell`.
    Whole,
}

/// The parts of a rule that a user gave.
#[derive(Clone, Debug, Default)]
pub struct Asked {
    /// The framework, which implies some of the others.
    pub framework: Option<Framework>,
    /// What a spike does: one entry for all layers, or one for each layer that fires; empty if not given.
    pub resets: Vec<Reset>,
    /// How potentials are compared with thresholds.
    pub fires: Option<Fires>,
    /// How potentials and currents decay.
    pub decay: Option<Decay>,
    /// Which current drives the potential.
    pub current: Option<Current>,
    /// Length of a step, in seconds.
    pub dt: Option<f64>,
}

/// The complete rule of a layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// The framework, if it was named.
    pub framework: Option<Framework>,
    /// What a spike does to its neuron's potential.
    pub reset: Reset,
    /// How potentials are compared with thresholds.
    pub fires: Fires,
    /// How potentials and currents decay.
    pub decay: Decay,
    /// Which current drives the potential.
    pub current: Current,
    /// Length of a step, in seconds.
    pub dt: f64,
}

/// The rule of networks in JSON, whose numbers are for a step: fires above the threshold, and sets to 0 at once.
pub(super) const PLAIN: Rule = Rule {
    framework: None,
    reset: Reset::ToValue,
    fires: Fires::Above,
    decay: Decay::Euler,
    current: Current::New,
    dt: 1.0,
};

/// Length of the step, in seconds, with which snnTorch and `SpikingJelly` write files by default.
const WRITTEN: f64 = 1e-4;

/// Which parts of a rule a network needs.
#[derive(Clone, Copy)]
pub(super) struct Needs {
    /// Whether it has neurons that fire.
    pub fires: bool,
    /// Whether it has neurons with a current.
    pub current: bool,
    /// Whether it has time constants.
    pub time: bool,
}

impl Framework {
    /// Returns the name by which users choose the framework.
    pub const fn name(self) -> &'static str {
        match self {
            Self::SnnTorch => "snntorch",
            Self::Norse => "norse",
            Self::SpikingJelly => "spikingjelly",
            Self::Rockpool => "rockpool",
            Self::Sinabs => "sinabs",
            Self::Nir => "nir",
        }
    }

    /// Returns the parts of the rule that the framework implies.
    fn says(self) -> Asked {
        use {Current as C, Decay as D, Fires as F, Framework as W, Reset as R};
        let (reset, fires, decay, current, dt) = match self {
            W::SnnTorch => (None, Some(F::Above), D::Euler, Some(C::New), Some(WRITTEN)),
            W::Norse => (Some(R::ToValue), Some(F::Above), D::Euler, None, None),
            W::SpikingJelly => {
                (Some(R::ToValue), Some(F::At), D::Euler, Some(C::New), Some(WRITTEN))
            }
            W::Rockpool | W::Sinabs => (Some(R::Subtract), None, D::Exponential, None, None),
            W::Nir => (None, Some(F::Above), D::Euler, Some(C::Old), None),
        };
        let resets = reset.into_iter().collect();
        Asked { framework: Some(self), resets, fires, decay: Some(decay), current, dt }
    }

    /// Returns whether gains near 1 in the framework's files are meant to be exactly 1.
    pub(super) const fn means_ones(self) -> bool {
        matches!(self, Self::SnnTorch | Self::SpikingJelly)
    }
}

impl Asked {
    /// Returns the complete rule.
    ///
    /// # Errors
    /// Returns an error that lists all missing parts which the network needs.
    pub(super) fn rule(&self, needs: Needs) -> Result<Rule> {
        let says = self.framework.map(Framework::says).unwrap_or_default();
        let (reset, fires) = (self.reset(&says), self.fires.or(says.fires));
        let (current, dt) = (self.current.or(says.current), self.dt.or(says.dt));
        let decay = self.decay.or(says.decay);
        let open: Vec<Choice> = [
            (Choice::Reset, needs.fires && reset.is_none()),
            (Choice::Fires, needs.fires && fires.is_none()),
            (Choice::Decay, needs.time && decay.is_none()),
            (Choice::Current, needs.current && current.is_none()),
            (Choice::Step, needs.time && dt.is_none()),
        ]
        .into_iter()
        .filter_map(|(choice, is_open)| is_open.then_some(choice))
        .collect();
        if !open.is_empty() {
            return Err(NetworkKind::OpenRule { framework: self.framework, open }.into());
        }
        Ok(Rule {
            framework: self.framework,
            reset: reset.unwrap_or(PLAIN.reset),
            fires: fires.unwrap_or(PLAIN.fires),
            decay: decay.unwrap_or(PLAIN.decay),
            current: current.unwrap_or(PLAIN.current),
            dt: dt.unwrap_or(PLAIN.dt),
        })
    }

    /// Returns the rule of a network in JSON, changed by what was asked for.
    pub(in super::super) fn or_plain(&self) -> Rule {
        let says = self.framework.map(Framework::says).unwrap_or_default();
        Rule {
            framework: self.framework,
            reset: self.reset(&says).unwrap_or(PLAIN.reset),
            fires: self.fires.or(says.fires).unwrap_or(PLAIN.fires),
            ..PLAIN
        }
    }

    /// Completes the rule with what holds for every chip, and with `seconds`, the step of a recording.
    pub(in super::super) fn on_chip(&self, seconds: Option<f64>) -> Self {
        let says = self.framework.map(Framework::says).unwrap_or_default();
        Self {
            fires: self.fires.or(says.fires).or(Some(Fires::Above)),
            decay: self.decay.or(says.decay).or(Some(Decay::Euler)),
            current: self.current.or(says.current).or(Some(Current::New)),
            dt: self.dt.or(says.dt).or(seconds),
            ..self.clone()
        }
    }

    /// Returns the first layer's reset: the one asked for, or the framework's.
    fn reset(&self, says: &Self) -> Option<Reset> {
        self.resets.iter().chain(&says.resets).next().copied()
    }
}

impl Reset {
    /// Returns the name of the type in `spikewire-network`.
    pub(super) const fn type_name(self) -> &'static str {
        match self {
            Self::ToValue => "ToValue",
            Self::ToValueLate => "ToValueLate",
            Self::ToValueHeld => "ToValueHeld",
            Self::Subtract => "Subtract",
            Self::SubtractLate => "SubtractLate",
            Self::SubtractNoDelay => "SubtractNoDelay",
            Self::NoReset => "NoReset",
        }
    }

    /// Returns whether a spike subtracts the threshold, rather than setting the potential.
    pub const fn subtracts(self) -> bool {
        matches!(self, Self::Subtract | Self::SubtractLate | Self::SubtractNoDelay)
    }
}

impl Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let fires = if self.fires == Fires::At { "at" } else { "above" };
        let reset = match self.reset {
            Reset::ToValue => "is set to its reset value at once",
            Reset::ToValueLate => "is set to its reset value a step late",
            Reset::ToValueHeld => "is held at its reset value through the next step",
            Reset::Subtract => "loses its threshold at once",
            Reset::SubtractLate => "loses its threshold a step late",
            Reset::SubtractNoDelay => "loses its threshold as snnTorch's reset_delay=False has it",
            Reset::NoReset => "keeps its potential",
        };
        write!(f, "fires {fires} its threshold, and then {reset}")
    }
}
