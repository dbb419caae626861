//! Choices about the decay, firing and reset of neurons. If a network's file and its framework leave such a choice
//! open, a text asks the user to make it.

use super::Framework;
use catalogue::run::Spell;
use std::fmt::Write as _;

/// A choice about how neurons decay, fire and reset. The network's file or the training framework may settle the
/// choice. Otherwise, the user must decide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Choice {
    /// How a spike resets its neuron.
    Reset,
    /// Whether a neuron fires at its threshold or only above it.
    Fires,
    /// The formula that turns a time constant into the factor by which a step multiplies a potential.
    Decay,
    /// The synaptic current that a step adds to the potential: the current of this step, or of the step before.
    Current,
    /// The duration of a step, in seconds.
    Step,
}

/// Returns a text that asks the user to make the choices in `open`. The text describes each choice on a new line, with
/// the name of its setting and the possible values. The function `spell` converts the name of a setting to the spelling
/// that the user knows.
pub(in super::super) fn words(
    spell: Spell,
    framework: Option<Framework>,
    open: &[Choice],
) -> String {
    let named = spell("as");
    let mut words = match framework {
        Some(framework) => format!("`{named} {}` leaves open", framework.name()),
        None => format!(
            "name the framework, `{named} snntorch|norse|spikingjelly|rockpool|sinabs|nir`, or say"
        ),
    };
    for choice in open {
        let (name, values) = choice.values(framework);
        _ = write!(words, "\n  {}{values}", spell(name));
    }
    words
}

impl Choice {
    /// Returns the name of the setting by which the user makes the choice, and a text that lists the possible values.
    const fn values(self, framework: Option<Framework>) -> (&'static str, &'static str) {
        match (self, framework) {
            (Self::Reset, Some(Framework::SnnTorch)) => (
                "reset",
                " subtract-late (its default), to-value-late (reset_mechanism=\"zero\"), subtract-no-delay \
                 (reset_delay=False), to-value (both, or a file that snnTorch has read), or none;\n    \
                 of each layer that fires, with commas between; in 1.0.0 RSynaptic does not heed reset_delay=False",
            ),
            (Self::Reset, Some(Framework::Nir)) => {
                ("reset", " to-value (NIR's definition) or subtract (its reference program)")
            }
            (Self::Reset, _) => (
                "reset",
                " to-value or subtract, to-value-late or subtract-late for a step late, none, or snnTorch's \
                 to-value-held and subtract-no-delay",
            ),
            (Self::Fires, _) => ("fires", " above (v > threshold) or at (v >= threshold)"),
            (Self::Decay, _) => {
                ("decay", " euler (1 - dt / tau) or exponential (e to the -dt / tau)")
            }
            (Self::Current, _) => (
                "current",
                " new (NIR's order, and how Norse reads a CubaLIF), whole (a spike adds its whole weight: Norse's \
                 LIFCell wrote it) or old (the current of the step before)",
            ),
            (Self::Step, _) => ("dt", " SECONDS: the step that it was trained with"),
        }
    }
}
