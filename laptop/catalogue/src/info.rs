//! The description of a scheme, without running it.

/// A scheme's names, words and parameters.
#[derive(Clone, Copy, Debug)]
pub struct Info {
    /// The name in options and files.
    pub name: &'static str,
    /// What its class is called in bindings to other languages: the name of its type in the crate, where it has one
    /// of its own.
    pub type_name: &'static str,
    /// The name in the paper's tables.
    pub title: &'static str,
    /// Its name in words.
    pub words: &'static str,
    /// The purpose, in a few words.
    pub good_for: &'static str,
    /// Whether its spikes have a direction.
    pub is_signed: bool,
    /// The errors of its steps, if its decoder adds up steps from a first value.
    pub steps: StepErrors,
    /// The parameter that limits how far the decoded value can move in one sample, if one does.
    pub climbs_by: Option<&'static str>,
    /// Whether it is in the paper's first figure.
    pub is_drawn: bool,
    /// Its colour in pictures: red, green and blue.
    pub colour: [u8; 3],
    /// The options that it takes, in the order in which a file of spikes lists them.
    pub parameters: &'static [Parameter],
}

impl Info {
    /// A description to fill in: spikes have no direction, and the decoder adds up no steps.
    pub(crate) const BLANK: Self = Self {
        name: "",
        type_name: "",
        title: "",
        words: "",
        good_for: "",
        is_signed: false,
        steps: StepErrors::None,
        climbs_by: None,
        is_drawn: false,
        colour: [0; 3],
        parameters: &[],
    };

    /// Returns whether its decoder adds up steps from a first value.
    pub const fn has_first_value(&self) -> bool {
        !matches!(self.steps, StepErrors::None)
    }

    /// Returns whether the errors of its steps add up in its decoder until a keyframe comes, though every spike arrives.
    pub const fn drifts(&self) -> bool {
        matches!(self.steps, StepErrors::Drifting)
    }

    /// The parameter of this name.
    pub fn parameter(&self, name: &str) -> Option<&'static Parameter> {
        self.parameters.iter().find(|own| own.name == name)
    }
}

/// The errors of a code's steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepErrors {
    /// The code has no steps: its decoder has no first value.
    None,
    /// The encoder holds what the decoder holds, so that the errors of steps do not add up.
    Held,
    /// The errors of all steps add up in the decoder until a keyframe comes.
    Drifting,
}

/// A parameter of a scheme.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// The name in options and files.
    pub name: &'static str,
    /// The values that it takes.
    pub kind: Kind,
    /// The unit of its values.
    pub unit: Unit,
    /// Its meaning, in a line.
    pub help: &'static str,
    /// The paper's setting.
    pub paper: Paper,
    /// The value unless given, if it is not a preset or found from the signal.
    pub default: Option<&'static str>,
    /// The figure of the signal that stands in its place unless it is given.
    pub found: Option<Found>,
    /// Whether a file of spikes holds it, so that the file decodes by itself.
    pub is_recorded: bool,
    /// Whether decoding does without it.
    pub is_of_encoder: bool,
    /// An example of a value.
    pub example: &'static str,
    /// The range in which a good value is looked for; `None` if it keeps its default.
    pub search: Option<Search>,
}

/// The range in which a good value of a parameter is looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Search {
    /// A number between these, as likely between 1 and 2 as between 10 and 20. Of a parameter in the signal's unit they
    /// are parts of the signal's range.
    Log(f64, f64),
    /// A number between these, counted from what the signal tells, in parts of the signal's range.
    Around(f64, f64),
    /// A number between these, in parts of the filter's sum.
    OfFilter(f64, f64),
    /// Between these, in thresholds: `2x`.
    Thresholds(f64, f64),
    /// A whole number between these.
    Whole(u32, u32),
    /// A most that settings allow, a whole number between these. More than a signal ever comes to changes nothing.
    Most(u32, u32),
    /// One of these words.
    Words(&'static [&'static str]),
    /// Shape and length of a filter of at most so many taps, and its sum in parts of the signal's range.
    Filter(u32, f64, f64),
}

/// The values that a parameter takes.
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
    /// A filter; a file of spikes holds its taps, as `taps`.
    Filter,
}

/// A figure of a signal that may stand in the place of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Found {
    /// Its first sample.
    First,
    /// Its smallest sample.
    Min,
    /// Its largest sample.
    Max,
}

/// The unit of a parameter's values.
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
        Self {
            name,
            kind,
            unit,
            help,
            paper: Paper::None,
            default: None,
            found: None,
            is_recorded: true,
            is_of_encoder: false,
            example: "",
            search: None,
        }
    }

    /// A whole number without a unit and without a preset.
    pub const fn count(name: &'static str, help: &'static str) -> Self {
        Self::new(name, Kind::Count, Unit::None, help)
    }

    /// With the place where a good value is looked for.
    #[must_use]
    pub const fn searched(self, search: Search) -> Self {
        Self { search: Some(search), ..self }
    }

    /// With the paper's setting.
    #[must_use]
    pub const fn with_paper(self, paper: Paper) -> Self {
        Self { paper, ..self }
    }

    /// With what it is unless given.
    #[must_use]
    pub const fn with_default(self, default: &'static str) -> Self {
        Self { default: Some(default), ..self }
    }

    /// With an example of what one may give.
    #[must_use]
    pub const fn with_example(self, example: &'static str) -> Self {
        Self { example, ..self }
    }

    /// In the place of what the signal tells.
    #[must_use]
    pub const fn in_place_of(self, found: Found) -> Self {
        Self { found: Some(found), ..self }
    }

    /// Marks a parameter from which another one is made, and which a file of spikes does not hold.
    #[must_use]
    pub const fn unrecorded(self) -> Self {
        Self { is_recorded: false, ..self }
    }

    /// Marks a parameter that decoding does not need.
    #[must_use]
    pub const fn of_encoder(self) -> Self {
        Self { is_of_encoder: true, ..self }
    }

    /// The name in a file of spikes.
    pub const fn key(&self) -> &'static str {
        if matches!(self.kind, Kind::Filter) { "taps" } else { self.name }
    }

    /// The value before the first sample, of schemes whose decoders add up steps.
    pub const START: Self = Self::new(
        "start",
        Kind::Number,
        Unit::Signal,
        "the value before the first sample, whose spike then counts; unless given, the first sample is where \
         the decoder starts",
    )
    .with_example("0")
    .in_place_of(Found::First);

    /// The signal's minimum, of the rate codes.
    pub const SHIFT: Self = Self::new(
        "shift",
        Kind::Number,
        Unit::Signal,
        "what the filters add up on, the signal's minimum; samples below it cannot be coded",
    )
    .with_example("-2.5")
    .in_place_of(Found::Min)
    .searched(Search::Around(-0.25, 0.25));

    /// The lower end of a population's range.
    pub const MIN: Self = Self::new(
        "min",
        Kind::Number,
        Unit::Signal,
        "lower end of the neurons' range: the signal's minimum",
    )
    .with_example("-2.5")
    .in_place_of(Found::Min)
    .searched(Search::Around(-0.1, 0.3));

    /// The upper end of a population's range.
    pub const MAX: Self = Self::new(
        "max",
        Kind::Number,
        Unit::Signal,
        "upper end of the neurons' range: the signal's maximum",
    )
    .with_example("2.5")
    .in_place_of(Found::Max)
    .searched(Search::Around(-0.3, 0.1));

    /// How wide receptive fields are.
    pub const BETA: Self = Self::new(
        "beta",
        Kind::Number,
        Unit::None,
        "distance of the centres in widths of a field, so the smaller, the wider, above 0",
    )
    .with_default("1.5")
    .searched(Search::Log(0.3, 4.0));

    /// How many sub-timesteps receptive fields fire in.
    pub const SLOTS: Self = Self::count("slots", "sub-timesteps a sample, 2 to 256")
        .with_paper(Paper::Text("10"))
        .with_example("10")
        .searched(Search::Whole(2, 32));

    /// The lowest level of receptive fields that fires.
    pub const FLOOR: Self =
        Self::count("floor", "neurons below this level of the slots are silent")
            .with_default("1")
            .searched(Search::Whole(1, 2));

    /// How the mean of spikes is taken.
    pub const MEAN: Self = Self::new(
        "mean",
        Kind::Choice(&["average", "window"]),
        Unit::None,
        "how the decoder takes the mean of spikes: an `average` that forgets, or a `window`",
    )
    .with_default("average")
    .searched(Search::Words(&["average", "window"]));

    /// Over how many samples the mean of spikes is taken.
    pub const POWER: Self = Self::count(
        "power",
        "the mean is over about 2^POWER samples: 1 to 15, of a window 0 to 12",
    )
    .with_default("4")
    .searched(Search::Whole(1, 8));

    /// The seed of chance.
    pub const SEED: Self = Self::count(
        "seed",
        "where the generator starts; each channel draws from a stream of its own",
    )
    .with_default("0");

    /// Most spikes a sample.
    pub const SPIKES: Self = Self::count("spikes", "most spikes a sample, 1 to 127")
        .with_example("4")
        .with_paper(Paper::Text("4"))
        .searched(Search::Most(1, 127));

    /// How many neurons there are.
    pub const fn neurons(paper: &'static str) -> Self {
        Self::count("neurons", "how many neurons share the range, 3 to 1024")
            .with_paper(Paper::Text(paper))
            .with_example("20")
            .searched(Search::Whole(3, 64))
    }

    /// The filter of a rate code.
    pub const fn filter(paper: &'static str) -> Self {
        Self::new(
            "filter",
            Kind::Filter,
            Unit::Signal,
            "`triang:15`, `hann:24`, `gauss:15`, `gauss:15:2.5` (with alpha), taps as in `0.5,1,0.5`, or a FILE of them, 1 to 4096; \
             `,peak=2` or `,sum=1` after a shape scales it",
        )
        .with_paper(Paper::Filter(paper))
        .with_example("triang:15,peak=2")
        .searched(Search::Filter(64, 0.3, 8.0))
    }

    /// A threshold in the signal's unit.
    pub const fn threshold(help: &'static str, paper: f64) -> Self {
        Self::new("threshold", Kind::Number, Unit::Signal, help)
            .with_paper(Paper::Signal(paper))
            .with_example("0.1")
            .searched(Search::Log(1e-4, 0.5))
    }
}
