//! Options for the update rule of a network's neurons: the order of decay, firing and reset, which a NIR file does not
//! contain.

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use lab::network::{Asked, Current, Decay, Fires, Framework, Numbers, Reset};

/// Options for the update rule of a network's neurons, which a NIR file does not contain.
#[derive(Args, Debug)]
pub(crate) struct RuleOptions {
    /// Framework whose update rule the network follows. A NIR file needs this option or --reset. On the controller, a
    /// NIR file needs this option or all of the options below
    #[arg(long = "as", value_name = "FRAMEWORK", value_parser = of(&FRAMEWORKS))]
    framework: Option<Framework>,
    /// Reset mode: the effect of a spike on its neuron's potential. Give one mode for all layers, or a comma-separated
    /// list with a mode for each layer that fires
    #[arg(long = "reset", value_delimiter = ',', value_parser = of(&RESETS))]
    resets: Vec<Reset>,
    /// Whether a neuron fires only if its potential is above its threshold, or also if the two are equal
    #[arg(long, value_parser = of(&FIRES))]
    fires: Option<Fires>,
    /// Formula that converts a time constant to the factor by which potentials and currents decay in each step
    #[arg(long, value_parser = of(&DECAYS))]
    decay: Option<Decay>,
    /// Synaptic current that drives a neuron's potential in a step: the current of this step, or the current of the
    /// step before. Only for neurons with synaptic currents
    #[arg(long, value_parser = of(&CURRENTS))]
    current: Option<Current>,
    /// Number type of the network on the controller
    #[arg(long, default_value = "f32", value_parser = of(&NUMBERS))]
    pub(crate) numbers: Numbers,
}

impl RuleOptions {
    /// Converts these options to [`Asked`], the type that the library takes. `dt` is the length of a simulation step in
    /// seconds.
    pub(crate) fn asked(&self, dt: Option<f64>) -> Asked {
        let &Self { framework, fires, decay, current, .. } = self;
        Asked { framework, resets: self.resets.clone(), fires, decay, current, dt }
    }
}

/// Name of the reset mode that has the alias `zero`.
const ZERO: &str = Reset::ToValue.name();

type Choices<T> = [(&'static str, T, &'static str)];

/// Returns a parser that maps each name in `choices` to its value. The third item of each choice is its help text.
fn of<T: Copy + Send + Sync + 'static>(
    choices: &'static Choices<T>,
) -> impl TypedValueParser<Value = T> {
    let values = choices.iter().map(|(name, _, help)| {
        let value = PossibleValue::new(*name).help(*help);
        if *name == ZERO { value.alias("zero") } else { value }
    });
    PossibleValuesParser::new(values.collect::<Vec<_>>()).try_map(|asked| {
        let asked = if asked == "zero" { ZERO } else { &asked };
        let found = choices.iter().find(|(name, ..)| *name == asked);
        found.map(|(_, choice, _)| *choice).ok_or("no such choice")
    })
}

const FRAMEWORKS: [(&str, Framework, &str); 6] = [
    (Framework::SnnTorch.name(), Framework::SnnTorch, "needs --reset; steps of 1e-4 s"),
    (Framework::Norse.name(), Framework::Norse, "needs --dt, and --current of neurons with one"),
    (Framework::SpikingJelly.name(), Framework::SpikingJelly, "steps of 1e-4 s"),
    (Framework::Rockpool.name(), Framework::Rockpool, "needs --dt and --fires"),
    (Framework::Sinabs.name(), Framework::Sinabs, "needs --dt and --fires"),
    (Framework::Nir.name(), Framework::Nir, "NIR's own reference program; needs --dt and --reset"),
];

const RESETS: [(&str, Reset, &str); 7] = [
    (ZERO, Reset::ToValue, "sets the potential to v_reset, or 0, at once"),
    (Reset::ToValueLate.name(), Reset::ToValueLate, "sets it a step late"),
    (Reset::ToValueHeld.name(), Reset::ToValueHeld, "holds it there through the next step"),
    (Reset::Subtract.name(), Reset::Subtract, "subtracts the threshold at once"),
    (Reset::SubtractLate.name(), Reset::SubtractLate, "subtracts it a step late"),
    (Reset::SubtractNoDelay.name(), Reset::SubtractNoDelay, "as snnTorch with reset_delay=False"),
    (Reset::NoReset.name(), Reset::NoReset, "leaves the potential as it is"),
];

const FIRES: [(&str, Fires, &str); 2] = [
    (Fires::Above.name(), Fires::Above, "v > threshold"),
    (Fires::At.name(), Fires::At, "v >= threshold"),
];

const DECAYS: [(&str, Decay, &str); 2] = [
    (Decay::Euler.name(), Decay::Euler, "1 - dt / tau"),
    (Decay::Exponential.name(), Decay::Exponential, "e to the -dt / tau"),
];

const CURRENTS: [(&str, Current, &str); 3] = [
    (Current::New.name(), Current::New, "that of this step"),
    (Current::Old.name(), Current::Old, "that of the step before"),
    (
        Current::Whole.name(),
        Current::Whole,
        "that of this step, to which a spike adds its whole weight: LIFCell of Norse",
    ),
];

const NUMBERS: [(&str, Numbers, &str); 2] = [
    ("f32", Numbers::Float, "for cores with a floating-point unit"),
    ("i8", Numbers::Integer, "weights of 8 bits, for other cores and less flash"),
];
