//! The description of a scheme as data.

/// A scheme's names, words and parameters.
#[derive(Clone, Copy, Debug)]
pub struct Info {
    /// Name in options and files.
    pub name: &'static str,
    /// Name of its class in bindings to other languages: that of its type in the crate, if it has one of its own.
    pub type_name: &'static str,
    /// Name in the paper's tables.
    pub title: &'static str,
    /// Name in words.
    pub words: &'static str,
    /// What it is good for, in a few words.
    pub good_for: &'static str,
    /// Whether its spikes have a direction.
    pub is_signed: bool,
    /// Whether the errors of its steps add up, if its decoder adds up steps from a first value.
    pub steps: StepErrors,
    /// Name of the parameter that limits how far the decoded value can move in one sample, if there is such a limit.
    pub climbs_by: Option<&'static str>,
    /// Whether it appears in the paper's first figure.
    pub is_drawn: bool,
    /// Colour in pictures: red, green and blue.
    pub colour: [u8; 3],
    /// The parameters, in the order in which a file of spikes lists them.
    pub parameters: &'static [Parameter],
}

impl Info {
    /// A template for descriptions: spikes without direction, and a decoder that adds up no steps.
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

    /// Returns whether the decoder adds up steps from a first value.
    pub const fn has_first_value(&self) -> bool {
        !matches!(self.steps, StepErrors::None)
    }

    /// Returns whether errors of its steps add up in the decoder until a keyframe arrives, even if every spike arrives.
    pub const fn drifts(&self) -> bool {
        matches!(self.steps, StepErrors::Drifting)
    }

    /// Returns whether the encoder has a baseline that a spike moves by a step, so that a start puts the baseline on a
    /// grid.
    pub const fn has_baseline(&self) -> bool {
        matches!(self.steps, StepErrors::Held)
    }

    /// Returns the parameter of this name.
    pub fn parameter(&self, name: &str) -> Option<&'static Parameter> {
        self.parameters.iter().find(|own| own.name == name)
    }
}

/// Whether the errors of a code's steps add up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepErrors {
    /// The code has no steps: its decoder has no first value.
    None,
    /// The encoder tracks what the decoder holds, so that errors of steps do not add up.
    Held,
    /// The errors of all steps add up in the decoder until a keyframe comes.
    Drifting,
}

/// A parameter of a scheme.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Name in options and files.
    pub name: &'static str,
    /// Kind of its values.
    pub kind: Kind,
    /// Unit of its values.
    pub unit: Unit,
    /// Meaning, in one line.
    pub help: &'static str,
    /// Value in the paper.
    pub paper: Paper,
    /// Default value, if it comes neither from a preset nor from the signal.
    pub default: Option<&'static str>,
    /// Figure of the signal that is the default.
    pub found: Option<Found>,
    /// Whether a file of spikes contains it, so that the file can be decoded by itself.
    pub is_recorded: bool,
    /// Whether only the encoder needs it.
    pub is_of_encoder: bool,
    /// An example of a value.
    pub example: &'static str,
    /// Range in which a good value is searched; `None` if it keeps its default.
    pub search: Option<Search>,
}

/// The range in which a good value of a parameter is searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Search {
    /// A number between these, searched by its logarithm. For a parameter in the signal's unit they are fractions of
    /// the signal's range.
    Log(f64, f64),
    /// The ratio `beta` between these, searched by the logarithm of the number of receptive fields that fire in a sample,
    /// which slots and floor change, too.
    Fields(f64, f64),
    /// An offset between these from a figure of the signal, as fractions of the signal's range.
    Around(f64, f64),
    /// A number between these, as fractions of the filter's sum.
    OfFilter(f64, f64),
    /// A multiple of the threshold between these, such as `2x`.
    Thresholds(f64, f64),
    /// An integer between these.
    Whole(u32, u32),
    /// An integer between these that is an upper limit, such as that of spikes in a sample. Raising it above what a
    /// signal needs changes nothing.
    Most(u32, u32),
    /// One of these words.
    Words(&'static [&'static str]),
    /// A filter: its shape, its length up to this number of taps, and its sum between these fractions of the signal's
    /// range.
    Filter(u32, f64, f64),
}

/// The kind of a parameter's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A number.
    Number,
    /// An integer, 0 or more.
    Count,
    /// One of these words.
    Choice(&'static [&'static str]),
    /// A flag, which is given or not.
    Flag,
    /// A word or a list; its help says which.
    Text,
    /// A filter. A file of spikes contains its taps, as `taps`.
    Filter,
}

/// A figure of a signal that may serve as a parameter's default.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Found {
    /// The first sample.
    First,
    /// The smallest sample.
    Min,
    /// The largest sample.
    Max,
}

/// The unit of a parameter's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A pure number.
    None,
    /// The signal's unit.
    Signal,
    /// Samples.
    Samples,
}

/// The value of a parameter in the paper.
#[derive(Clone, Copy, Debug)]
pub enum Paper {
    /// The paper has none.
    None,
    /// This text.
    Text(&'static str),
    /// This number, in the unit of the paper's signal, whose range is 5.8; scaled to the range of another signal.
    Signal(f64),
    /// A filter of this shape, with its peak scaled to the range of the signal.
    Filter(&'static str),
}

impl Parameter {
    /// Makes a parameter without a value in the paper.
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

    /// Makes an integer parameter without a unit, and without a value in the paper.
    pub const fn count(name: &'static str, help: &'static str) -> Self {
        Self::new(name, Kind::Count, Unit::None, help)
    }

    /// Sets the range in which a good value is searched.
    #[must_use]
    pub const fn searched(self, search: Search) -> Self {
        Self { search: Some(search), ..self }
    }

    /// Sets the value in the paper.
    #[must_use]
    pub const fn with_paper(self, paper: Paper) -> Self {
        Self { paper, ..self }
    }

    /// Sets the default value.
    #[must_use]
    pub const fn with_default(self, default: &'static str) -> Self {
        Self { default: Some(default), ..self }
    }

    /// Sets an example of a value.
    #[must_use]
    pub const fn with_example(self, example: &'static str) -> Self {
        Self { example, ..self }
    }

    /// Sets the figure of the signal that is the default.
    #[must_use]
    pub const fn in_place_of(self, found: Found) -> Self {
        Self { found: Some(found), ..self }
    }

    /// Marks a parameter from which another one is derived, and which a file of spikes does not contain.
    #[must_use]
    pub const fn unrecorded(self) -> Self {
        Self { is_recorded: false, ..self }
    }

    /// Marks a parameter that decoding does not need.
    #[must_use]
    pub const fn of_encoder(self) -> Self {
        Self { is_of_encoder: true, ..self }
    }

    /// Returns the name in a file of spikes.
    pub const fn key(&self) -> &'static str {
        if matches!(self.kind, Kind::Filter) { "taps" } else { self.name }
    }

    /// Value before the first sample, for schemes whose decoders add up steps.
    pub const START: Self = Self::new(
        "start",
        Kind::Number,
        Unit::Signal,
        "the value before the first sample, whose spike then counts; unless given, the first sample is where \
         the decoder starts",
    )
    .with_example("0")
    .in_place_of(Found::First);

    /// Number that rate codes subtract from the samples; by default the signal's minimum.
    pub const SHIFT: Self = Self::new(
        "shift",
        Kind::Number,
        Unit::Signal,
        "what the filters add up on, the signal's minimum; samples below it cannot be coded",
    )
    .with_example("-2.5")
    .in_place_of(Found::Min)
    .searched(Search::Around(-0.25, 0.25));

    /// Lower end of a population's range.
    pub const MIN: Self = Self::new(
        "min",
        Kind::Number,
        Unit::Signal,
        "lower end of the neurons' range: the signal's minimum",
    )
    .with_example("-2.5")
    .in_place_of(Found::Min)
    .searched(Search::Around(-0.1, 0.3));

    /// Upper end of a population's range.
    pub const MAX: Self = Self::new(
        "max",
        Kind::Number,
        Unit::Signal,
        "upper end of the neurons' range: the signal's maximum",
    )
    .with_example("2.5")
    .in_place_of(Found::Max)
    .searched(Search::Around(-0.3, 0.1));

    /// Ratio of the distance between receptive fields to their width.
    pub const BETA: Self = Self::new(
        "beta",
        Kind::Number,
        Unit::None,
        "distance of the centres in widths of a field, so the smaller, the wider, above 0",
    )
    .with_default("1.5")
    .searched(Search::Log(0.3, 4.0));

    /// Number of sub-timesteps in which receptive fields fire.
    pub const SLOTS: Self = Self::count("slots", "sub-timesteps a sample, 2 to 256")
        .with_paper(Paper::Text("10"))
        .with_example("10")
        .searched(Search::Whole(2, 32));

    /// Lowest level at which receptive fields fire.
    pub const FLOOR: Self =
        Self::count("floor", "neurons below this level of the slots are silent")
            .with_default("1")
            .searched(Search::Whole(1, 2));

    /// How the decoder averages spikes.
    pub const MEAN: Self = Self::new(
        "mean",
        Kind::Choice(&["average", "window"]),
        Unit::None,
        "how the decoder takes the mean of spikes: an `average` that forgets, or a `window`",
    )
    .with_default("average")
    .searched(Search::Words(&["average", "window"]));

    /// Number of samples over which spikes are averaged, as a power of two.
    pub const POWER: Self = Self::count(
        "power",
        "the mean is over about 2^POWER samples: 1 to 15, of a window 0 to 12",
    )
    .with_default("4")
    .searched(Search::Whole(1, 8));

    /// Seed of the random generator.
    pub const SEED: Self = Self::count(
        "seed",
        "where the generator starts; each channel draws from a stream of its own",
    )
    .with_default("0");

    /// Maximum number of spikes in a sample.
    pub const SPIKES: Self = Self::count("spikes", "most spikes a sample, 1 to 127")
        .with_example("4")
        .with_paper(Paper::Text("4"))
        .searched(Search::Most(1, 127));

    /// Makes the parameter for the number of neurons.
    pub const fn neurons(paper: &'static str) -> Self {
        Self::count("neurons", "how many neurons share the range, 3 to 1024")
            .with_paper(Paper::Text(paper))
            .with_example("20")
            .searched(Search::Whole(3, 64))
    }

    /// Makes the parameter for the filter of a rate code.
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

    /// Makes the parameter for a threshold in the signal's unit.
    pub const fn threshold(help: &'static str, paper: f64) -> Self {
        Self::new("threshold", Kind::Number, Unit::Signal, help)
            .with_paper(Paper::Signal(paper))
            .with_example("0.1")
            .searched(Search::Log(1e-4, 0.5))
    }
}
