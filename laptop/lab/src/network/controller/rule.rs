//! The rule by which neurons step, which a NIR file does not say.

use crate::network::fault::{Result, bail};
use std::fmt::{self, Display, Write as _};

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
        let own = self.framework.map(Framework::says).unwrap_or_default();
        let (reset, fires) = (self.reset(&own), self.fires.or(own.fires));
        let (current, dt) = (self.current.or(own.current), self.dt.or(own.dt));
        let decay = self.decay.or(own.decay);
        let mut open = String::new();
        let mut line = |words: &str| _ = write!(open, "\n  {words}");
        if needs.fires && reset.is_none() {
            line(self.resets());
        }
        if needs.fires && fires.is_none() {
            line(FIRES);
        }
        if needs.time && decay.is_none() {
            line("--decay euler (1 - dt / tau) or exponential (e to the -dt / tau)");
        }
        if needs.current && current.is_none() {
            line(CURRENT);
        }
        if needs.time && dt.is_none() {
            line("--dt SECONDS: the step that it was trained with");
        }
        if !open.is_empty() {
            let how = match self.framework {
                Some(framework) => format!("`--as {}` leaves open", framework.name()),
                None => format!("name the framework, {AS}, or say"),
            };
            bail!("the file does not say by which rule its neurons step: {how}{open}");
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
        let own = self.framework.map(Framework::says).unwrap_or_default();
        Rule {
            framework: self.framework,
            reset: self.reset(&own).unwrap_or(PLAIN.reset),
            fires: self.fires.or(own.fires).unwrap_or(PLAIN.fires),
            ..PLAIN
        }
    }

    /// The same, with what every chip has where nothing is said, and with a recording's time of a step.
    pub(in super::super) fn on_chip(&self, seconds: Option<f64>) -> Self {
        let own = self.framework.map(Framework::says).unwrap_or_default();
        Self {
            fires: self.fires.or(own.fires).or(Some(Fires::Above)),
            decay: self.decay.or(own.decay).or(Some(Decay::Euler)),
            current: self.current.or(own.current).or(Some(Current::New)),
            dt: self.dt.or(own.dt).or(seconds),
            ..self.clone()
        }
    }

    /// The first layer's reset, by what is asked for or what the framework says.
    fn reset(&self, own: &Self) -> Option<Reset> {
        self.resets.iter().chain(&own.resets).next().copied()
    }

    const fn resets(&self) -> &'static str {
        match self.framework {
            Some(Framework::SnnTorch) => SNNTORCH,
            Some(Framework::Nir) => {
                "--reset to-value (NIR's definition) or subtract (its reference program)"
            }
            _ => RESETS,
        }
    }
}

const AS: &str = "`--as snntorch|norse|spikingjelly|rockpool|sinabs|nir`";
const FIRES: &str = "--fires above (v > threshold) or at (v >= threshold)";
const CURRENT: &str = "--current new (NIR's order, and how Norse reads a CubaLIF), whole (a spike adds its whole weight: \
                       Norse's LIFCell wrote it) or old (the current of the step before)";
const RESETS: &str = "--reset to-value or subtract, to-value-late or subtract-late for a step late, or snnTorch's \
                      to-value-held and subtract-no-delay";
const SNNTORCH: &str = "--reset subtract-late (its default), to-value-late (reset_mechanism=\"zero\"), subtract-no-delay \
                        (reset_delay=False), or to-value (both, or a file that snnTorch has read);\n    \
                        of each layer that fires, with commas between; in 1.0.0 RSynaptic does not heed reset_delay=False";

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
