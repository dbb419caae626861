//! What is known of a scheme without running it.

/// A scheme's names, words and parameters.
#[derive(Clone, Copy, Debug)]
pub struct Info {
    /// What options and files call it.
    pub name: &'static str,
    /// What the paper's tables call it.
    pub title: &'static str,
    /// Its name in words.
    pub words: &'static str,
    /// What it is good for, in a few words.
    pub good_for: &'static str,
    /// Whether its spikes have a direction.
    pub is_signed: bool,
    /// Whether its decoder adds up steps from a first value.
    pub has_first_value: bool,
    /// The options that it takes, in the order in which a file of spikes lists them.
    pub parameters: &'static [Parameter],
}

/// A parameter of a scheme.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// What options and files call it.
    pub name: &'static str,
    /// What values it takes.
    pub kind: Kind,
    /// What a 1 of it is.
    pub unit: Unit,
    /// What it means, in a line.
    pub help: &'static str,
    /// The paper's setting.
    pub paper: Paper,
    /// Whether it stands in the place of what a calibration finds out.
    pub is_calibrated: bool,
}

/// What values a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A number.
    Number,
    /// A whole number, 0 or more.
    Count,
    /// One of these words.
    Choice(&'static [&'static str]),
    /// Present or not.
    Flag,
    /// A word or a list, as its help says.
    Text,
}

/// What a 1 of a parameter is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A pure number.
    None,
    /// The signal's unit.
    Signal,
    /// A sample.
    Samples,
}

/// The paper's setting of a parameter.
#[derive(Clone, Copy, Debug)]
pub enum Paper {
    /// The paper has none.
    None,
    /// As it stands.
    Text(&'static str),
    /// In the unit of the paper's signal, whose range is 5.8: scaled to that of another.
    Signal(f64),
    /// A filter of this shape, whose peak is scaled as a number is.
    Filter(&'static str),
}

impl Parameter {
    /// A parameter without a preset.
    pub const fn new(name: &'static str, kind: Kind, unit: Unit, help: &'static str) -> Self {
        Self { name, kind, unit, help, paper: Paper::None, is_calibrated: false }
    }

    /// With the paper's setting.
    #[must_use]
    pub const fn with_paper(self, paper: Paper) -> Self {
        Self { paper, ..self }
    }

    /// In the place of what a calibration finds out.
    #[must_use]
    pub const fn calibrated(self) -> Self {
        Self { is_calibrated: true, ..self }
    }

    /// The value before the first sample, of schemes whose decoders add up steps.
    pub const START: Self = Self::new(
        "start",
        Kind::Number,
        Unit::Signal,
        "the value before the first sample; unless given, the first sample is where the decoder starts",
    )
    .calibrated();

    /// The signal's minimum, of the rate codes.
    pub const SHIFT: Self = Self::new(
        "shift",
        Kind::Number,
        Unit::Signal,
        "what the filters add up on: the signal's minimum",
    )
    .calibrated();

    /// The lower end of a population's range.
    pub const MIN: Self =
        Self::new("min", Kind::Number, Unit::Signal, "lower end of the neurons' range: the signal's minimum")
            .calibrated();

    /// The upper end of a population's range.
    pub const MAX: Self =
        Self::new("max", Kind::Number, Unit::Signal, "upper end of the neurons' range: the signal's maximum")
            .calibrated();

    /// How wide receptive fields are.
    pub const BETA: Self = Self::new(
        "beta",
        Kind::Number,
        Unit::None,
        "the smaller, the wider the fields, above 0; 1.5 unless given",
    );

    /// How many neurons there are.
    pub const fn neurons(paper: &'static str) -> Self {
        Self::new("neurons", Kind::Count, Unit::None, "how many neurons, 3 to 1024")
            .with_paper(Paper::Text(paper))
    }

    /// The filter of a rate code.
    pub const fn filter(paper: &'static str) -> Self {
        Self::new(
            "filter",
            Kind::Text,
            Unit::Signal,
            "`triang:15`, `hann:24`, `gauss:15`, `gauss:15:2.5` (with alpha), or a FILE of taps; \
             `,peak=2` or `,sum=1` after a shape scales it",
        )
        .with_paper(Paper::Filter(paper))
    }

    /// A threshold in the signal's unit.
    pub const fn threshold(help: &'static str, paper: f64) -> Self {
        Self::new("threshold", Kind::Number, Unit::Signal, help).with_paper(Paper::Signal(paper))
    }
}
