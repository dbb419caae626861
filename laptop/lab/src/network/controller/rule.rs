//! The rule by which neurons decay, fire and reset. A NIR file does not contain the whole rule.

use super::open::Choice;
use crate::network::fault::{NetworkKind, Result};
use catalogue::run::Spell;
use serde::{Deserialize, Serialize};
use std::fmt::{self, Display};

/// The training framework whose rule a network follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Framework {
    /// The framework snnTorch. It trains with several kinds of reset, and a file does not say which kind was used.
    SnnTorch,
    /// The framework Norse.
    Norse,
    /// The framework `SpikingJelly`.
    SpikingJelly,
    /// The framework Rockpool.
    Rockpool,
    /// The framework Sinabs.
    Sinabs,
    /// The reference program of the NIR project.
    Nir,
}

/// How a spike resets its neuron's potential. The variants have the names of the types in `spikewire-network`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
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
    /// Subtracts the threshold in the same step, as snnTorch does with `reset_delay=False`. A neuron whose potential is
    /// above the threshold before a step must exceed twice the threshold to fire in the step.
    SubtractNoDelay,
    /// Leaves the potential as it is.
    #[serde(rename = "none")]
    NoReset,
}

/// Whether a neuron fires at its threshold, or only above it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fires {
    /// The neuron fires only above the threshold.
    Above,
    /// The neuron fires at or above the threshold.
    At,
}

/// How a time constant `tau` becomes the factor by which a step of length `dt` multiplies a potential or current.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Decay {
    /// The factor is 1 - dt / tau.
    Euler,
    /// The factor is e to the power of -dt / tau.
    Exponential,
}

/// The synaptic current that a step adds to the potential: the current of this step, or of the step before. The choice
/// matters only for neurons that have a synaptic current.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Current {
    /// The current after this step's inputs were added to it.
    New,
    /// The current before this step's decay and inputs.
    Old,
    /// Like [`New`](Self::New), but a spike adds its whole weight to the current, as in Norse's `LIFCell`. With `New`,
    /// a spike adds its weight times `dt / tau`.
    Whole,
}

/// The parts of the rule for decay, firing and reset that the user gave. Parts that the user did not give are `None` or
/// empty; the framework may imply some of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Asked {
    /// The training framework. It may imply parts of the rule that the user did not give.
    pub framework: Option<Framework>,
    /// The ways in which a spike resets its neuron. A single entry applies to all layers. Otherwise, there is
    /// one entry for each layer that fires. Empty if the user gave none.
    pub resets: Vec<Reset>,
    /// Whether a neuron fires at its threshold, or only above it.
    pub fires: Option<Fires>,
    /// How a time constant becomes the factor by which a step multiplies a potential or current.
    pub decay: Option<Decay>,
    /// The synaptic current that a step adds to the potential: the current of this step, or of the step before.
    pub current: Option<Current>,
    /// Duration of a step, in seconds.
    pub dt: Option<f64>,
}

/// The complete rule by which a layer's neurons decay, fire and reset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// The training framework, if the user gave one.
    pub framework: Option<Framework>,
    /// How a spike resets its neuron's potential.
    pub reset: Reset,
    /// Whether a neuron fires at its threshold, or only above it.
    pub fires: Fires,
    /// How a time constant becomes the factor by which a step multiplies a potential or current.
    pub decay: Decay,
    /// The synaptic current that a step adds to the potential: the current of this step, or of the step before.
    pub current: Current,
    /// Duration of a step, in seconds.
    pub dt: f64,
}

/// The rule that the neurons of a network in JSON follow. A neuron fires if its potential is above its threshold. The
/// spike sets the potential to 0 in the same step. `decay` and `dt` play no role, because the parameters in JSON apply
/// to one step.
pub(super) const PLAIN: Rule = Rule {
    framework: None,
    reset: Reset::ToValue,
    fires: Fires::Above,
    decay: Decay::Euler,
    current: Current::New,
    dt: 1.0,
};

/// Duration of a step, in seconds, that snnTorch and `SpikingJelly` assume by default when they write a NIR file.
const WRITTEN: f64 = 1e-4;

/// Properties of a network that decide which parts of a rule must be known.
#[derive(Clone, Copy)]
pub(super) struct Needs {
    /// Whether the network has neurons that fire.
    pub fires: bool,
    /// Whether the network has neurons with a current.
    pub current: bool,
    /// Whether the network has time constants.
    pub time: bool,
}

impl Framework {
    /// Returns the name by which the command line selects the framework.
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

    /// Returns the parts of the rule for decay, firing and reset that this framework implies.
    pub(super) fn says(self) -> Asked {
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

    /// Returns whether a gain near 1 in this framework's files differs from 1 only by a rounding error. A gain is a
    /// factor for the weights that lead to a neuron.
    pub(super) const fn means_ones(self) -> bool {
        matches!(self, Self::SnnTorch | Self::SpikingJelly)
    }
}

impl Asked {
    /// Returns the settings that give this rule, as the user writes them. The function `spell` converts the name of a
    /// setting to the spelling that the user knows.
    pub(in super::super) fn settings(&self, spell: Spell) -> String {
        let mut settings = Vec::new();
        if let Some(framework) = self.framework {
            settings.push(format!("{} {}", spell("as"), framework.name()));
        }
        if !self.resets.is_empty() {
            let resets: Vec<_> = self.resets.iter().map(|reset| reset.name()).collect();
            settings.push(format!("{} {}", spell("reset"), resets.join(",")));
        }
        if let Some(fires) = self.fires {
            settings.push(format!("{} {}", spell("fires"), fires.name()));
        }
        let says = self.framework.map(Framework::says).unwrap_or_default();
        if let Some(decay) = self.decay
            && says.decay != self.decay
        {
            settings.push(format!("{} {}", spell("decay"), decay.name()));
        }
        if let Some(current) = self.current
            && says.current != self.current
        {
            settings.push(format!("{} {}", spell("current"), current.name()));
        }
        if let Some(dt) = self.dt
            && says.dt != self.dt
        {
            settings.push(format!("{} {dt}", spell("dt")));
        }
        settings.join(" ")
    }

    /// Returns the complete rule, from the parts that the user gave and those that the framework implies.
    ///
    /// # Errors
    /// Returns an error that lists all parts of the rule that the network needs, but that neither the user nor the
    /// framework gives.
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

    /// Returns the rule of a network in JSON. This is [`PLAIN`], unless the user or the framework gives another reset
    /// or another condition for firing.
    pub(in super::super) fn or_plain(&self) -> Rule {
        let says = self.framework.map(Framework::says).unwrap_or_default();
        Rule {
            framework: self.framework,
            reset: self.reset(&says).unwrap_or(PLAIN.reset),
            fires: self.fires.or(says.fires).unwrap_or(PLAIN.fires),
            ..PLAIN
        }
    }

    /// Returns a copy with defaults for a network on a chip: [`Fires::Above`], [`Decay::Euler`], [`Current::New`], and
    /// steps of `seconds`. A default is used if neither the user nor the framework gives this part of the rule. The
    /// reset has no default.
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

    /// Returns the first reset that the user gave. If the user gave none, returns the first reset in `says`, which
    /// contains the parts of the rule that the framework implies.
    fn reset(&self, says: &Self) -> Option<Reset> {
        self.resets.iter().chain(&says.resets).next().copied()
    }
}

impl Fires {
    /// Returns the name by which the user selects the comparison.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Above => "above",
            Self::At => "at",
        }
    }
}

impl Decay {
    /// Returns the name by which the user selects the formula.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Euler => "euler",
            Self::Exponential => "exponential",
        }
    }
}

impl Current {
    /// Returns the name by which the user selects the current.
    pub const fn name(self) -> &'static str {
        match self {
            Self::New => "new",
            Self::Old => "old",
            Self::Whole => "whole",
        }
    }
}

impl Reset {
    /// Returns the name by which the user selects the reset.
    pub const fn name(self) -> &'static str {
        match self {
            Self::ToValue => "to-value",
            Self::ToValueLate => "to-value-late",
            Self::ToValueHeld => "to-value-held",
            Self::Subtract => "subtract",
            Self::SubtractLate => "subtract-late",
            Self::SubtractNoDelay => "subtract-no-delay",
            Self::NoReset => "none",
        }
    }

    /// Returns the name of the type in `spikewire-network` that resets in this way.
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

    /// Returns whether a spike subtracts the threshold from the potential, instead of setting the potential to a value
    /// or leaving it as it is.
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

#[cfg(test)]
mod tests {
    use super::{Current, Decay, Fires, Framework, Reset};
    use serde::de::DeserializeOwned;

    fn reads<T: DeserializeOwned + PartialEq>(name: &str, value: &T) -> bool {
        serde_json::from_value::<T>(name.into()).is_ok_and(|read| read == *value)
    }

    /// A network's file and the Python package read the names by which the command line selects a part of the rule.
    #[test]
    fn files_read_the_names_of_the_command_line() {
        use {Framework as W, Reset as R};
        for framework in [W::SnnTorch, W::Norse, W::SpikingJelly, W::Rockpool, W::Sinabs, W::Nir] {
            assert!(reads(framework.name(), &framework), "{framework:?}");
        }
        let subtracting = [R::Subtract, R::SubtractLate, R::SubtractNoDelay];
        for reset in
            [R::ToValue, R::ToValueLate, R::ToValueHeld, R::NoReset].iter().chain(&subtracting)
        {
            assert!(reads(reset.name(), reset), "{reset:?}");
        }
        for fires in [Fires::Above, Fires::At] {
            assert!(reads(fires.name(), &fires), "{fires:?}");
        }
        for decay in [Decay::Euler, Decay::Exponential] {
            assert!(reads(decay.name(), &decay), "{decay:?}");
        }
        for current in [Current::New, Current::Old, Current::Whole] {
            assert!(reads(current.name(), &current), "{current:?}");
        }
    }
}
