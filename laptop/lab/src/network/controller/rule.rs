//! The rule by which neurons step, which a NIR file does not say.

use super::open::Choice;
use crate::network::fault::{NetworkKind, Result};
use std::fmt::{self, Display};

/// The framework whose rule a network follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Framework {
    /// snnTorch, which trains with five kinds of reset and writes none of them.
    SnnTorch,
    /// Norse.
    Norse,
    /// `SpikingJelly`.
    SpikingJelly,
    /// Rockpool.
    Rockpool,
    /// Sinabs.
    Sinabs,
    /// The reference program of NIR itself.
    Nir,
}

/// What a spike does to its neuron, by the crate's types of these names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reset {
    /// Sets the potential to `v_reset` in the same step.
    ToValue,
    /// Sets it at the beginning of the next step.
    ToValueLate,
    /// Holds it at `v_reset` through the next step.
    ToValueHeld,
    /// Subtracts the threshold in the same step.
    Subtract,
    /// Subtracts it in the next step.
    SubtractLate,
    /// snnTorch's subtraction with `reset_delay=False`.
    SubtractNoDelay,
}

/// The potential at which a neuron fires.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fires {
    /// Above the threshold.
    Above,
    /// At the threshold already.
    At,
}

/// The share of a potential that a step leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decay {
    /// 1 - dt / tau.
    Euler,
    /// e to the -dt / tau.
    Exponential,
}

/// The current that a potential takes, of neurons with both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Current {
    /// That of this step.
    New,
    /// That of the step before.
    Old,
    /// That of this step, to which a spike adds its whole weight, as in Norse's `LIFCell`.
    Whole,
}

/// The choices as far as they are said.
#[derive(Clone, Debug, Default)]
pub struct Asked {
    /// The framework, which says some of the others.
    pub framework: Option<Framework>,
    /// What a spike does: of all neurons, or of each layer that fires; nothing if it is not said.
    pub resets: Vec<Reset>,
    /// When a neuron fires.
    pub fires: Option<Fires>,
    /// How potentials and currents decay.
    pub decay: Option<Decay>,
    /// Which current is taken.
    pub current: Option<Current>,
    /// Seconds of a step.
    pub dt: Option<f64>,
}

/// The whole rule of a layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// The framework, if it was named.
    pub framework: Option<Framework>,
    /// What a spike does.
    pub reset: Reset,
    /// When a neuron fires.
    pub fires: Fires,
    /// How potentials and currents decay.
    pub decay: Decay,
    /// Which current is taken.
    pub current: Current,
    /// Seconds of a step.
    pub dt: f64,
}

/// The rule of networks in JSON, whose numbers are by step: above the threshold, to 0, at once.
pub(super) const PLAIN: Rule = Rule {
    framework: None,
    reset: Reset::ToValue,
    fires: Fires::Above,
    decay: Decay::Euler,
    current: Current::New,
    dt: 1.0,
};

/// The step that snnTorch and `SpikingJelly` write with, unless they are told another.
const WRITTEN: f64 = 1e-4;

/// The parts of a network that need a choice.
#[derive(Clone, Copy)]
pub(super) struct Needs {
    /// Neurons that fire.
    pub fires: bool,
    /// Neurons with a current.
    pub current: bool,
    /// Time constants.
    pub time: bool,
}

impl Framework {
    /// Its name, as it is asked for.
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

    /// What it says by itself.
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

    /// Whether its files mean gains of 1, which rounding leaves beside 1.
    pub(super) const fn means_ones(self) -> bool {
        matches!(self, Self::SnnTorch | Self::SpikingJelly)
    }
}

impl Asked {
    /// The whole rule.
    ///
    /// # Errors
    /// A choice that the network needs is not said; the error lists all of them.
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

    /// The rule of a network in JSON, which says it unless something else is asked for.
    pub(in super::super) fn or_plain(&self) -> Rule {
        let says = self.framework.map(Framework::says).unwrap_or_default();
        Rule {
            framework: self.framework,
            reset: self.reset(&says).unwrap_or(PLAIN.reset),
            fires: self.fires.or(says.fires).unwrap_or(PLAIN.fires),
            ..PLAIN
        }
    }

    /// The same, with what every chip has where nothing is said, and with a recording's time of a step.
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

    /// The first layer's reset, by what is asked for or what the framework says.
    fn reset(&self, says: &Self) -> Option<Reset> {
        self.resets.iter().chain(&says.resets).next().copied()
    }
}

impl Reset {
    /// The crate's type.
    pub(super) const fn type_name(self) -> &'static str {
        match self {
            Self::ToValue => "ToValue",
            Self::ToValueLate => "ToValueLate",
            Self::ToValueHeld => "ToValueHeld",
            Self::Subtract => "Subtract",
            Self::SubtractLate => "SubtractLate",
            Self::SubtractNoDelay => "SubtractNoDelay",
        }
    }

    /// Whether a spike subtracts the threshold, rather than set the potential.
    pub const fn subtracts(self) -> bool {
        !matches!(self, Self::ToValue | Self::ToValueLate | Self::ToValueHeld)
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
        };
        write!(f, "fires {fires} its threshold, and then {reset}")
    }
}
