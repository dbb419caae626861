//! Reasons for which a request cannot be met.

use crate::error::room;
use catalogue::kinds;
use catalogue::run::{Needs, Worded};

kinds! {
    /// The reason for which a request cannot be met.
    pub enum RequestKind by spell of subject {
        // Values out of their range.
        NotAboveZero => ("{subject} must be above 0"),
        NotPositive => ("{subject} must be above 0 and finite"),
        NotAPart => ("{subject} must be 0 or more and below 1"),
        TooFewBlocks => ("{subject} must be 2 or more"),
        AboveHundred => ("{subject} must be 100 or less"),
        TooFast { most: String, recording: String, rate: String, fewest: f64 } => (
            "{subject} must be {most} or less: {recording} has {rate} samples a second, and a loop acts on {fewest} or \
             more in a period of its bandwidth"
        ),
        NotFlown { most: f64 } => ("{subject} must be 0 to {most} percent: more was not flown"),
        NoPeriod => ("{subject} has no period of 1 µs to 16 777 215 µs, which a frame of the link can tell"),
        OneAChannel { values: usize, channels: usize } =>
            ("{subject} has {values} values for {channels} channels: it takes one for all or one for each"),
        SeveralUnits { one: String, other: String } =>
            ("{subject} cannot be that of {one} and of {other}: it takes a value for each channel, in their order"),
        BankNeedsRate => ("a bank needs the rate of its channels"),
        SeveralSchemes => ("a flight has one scheme for all channels: {} names it", spell("scheme")),
        NeedsRate { recording: String } => ("{subject} needs the rate of {recording}"),
        LeavesNone { blocks: usize } =>
            ("{subject} of {blocks} blocks leaves none to tune on or none to check on"),
        NoCore { name: String, cores: String } => ("no measured core `{name}`; there are {cores}"),
        // Searches.
        NoSchemes => ("there is no scheme"),
        NoRecording => ("there is no recording"),
        NoSamples => ("there are no samples"),
        SeveralSearchAll => ("several schemes search all parameters; with one scheme those given stay"),
        NoGoal => (
            "several schemes need one goal for all: {}, {} or {}",
            spell("min_efficiency"),
            spell("max_rmse"),
            spell("front")
        ),
        NoPaper => ("the paper has no such setting; give a goal"),
        NothingToSearch { why: String } => ("{why} ({} searches all the same)", spell("anyway")),
        OtherChannels { one: String, other: String } => ("the logs have other channels: {one}, {other}"),
        TooShort { samples: usize, enough: usize } => (
            "{samples} samples are too few to tune on some and hold out others; {enough} would do, or {} 0 with nothing \
             to check the settings on",
            spell("hold_out")
        ),
        NotDecoded { scheme: &'static str, sample: u64 } => ("{scheme}: sample {sample} does not decode"),
        NotHeld { why: String, error: Box<crate::Error> } => ("{why}: {}", error.spelled(spell)),
        // Encoding and decoding.
        RangeAtEnd =>
            ("messages tell the signal's range, which a pipe or standard input gives only at its end"),
        ReadOnce { scheme: &'static str, needs: Needs } => (
            "{scheme} calibrates over the whole signal, which a pipe or standard input gives only once; give {}",
            needs.spelled(spell)
        ),
        Addresses { channels: usize, neurons: usize } =>
            ("{channels} channels of {neurons} neurons are too many addresses"),
        Channels { channels: usize, scheme: &'static str, most: usize } =>
            ("{channels} channels are too many: {scheme} has 1 to {most} channels"),
        Differ => ("channels of one scheme differ in more than numbers"),
        NoChannel => ("a receiver has at least one channel"),
        // Sources for firmware, and files of settings.
        TwoCodecs { name: String } =>
            ("there are two called `{name}`: a codec and a flight have the name of their file"),
        Draws { scheme: &'static str } =>
            ("{scheme} draws from a generator, which the library for C has not"),
        NotToml { error: toml::de::Error } => ("no TOML: {error}"),
        NoSchemeNamed => ("`scheme = \"...\"` is missing"),
        NotAText => ("{subject} must be a text"),
        NotANumber => ("{subject}: must be a number"),
        NeitherNumberNorText => ("{subject}: must be a number or a text"),
    }
}
room!(RequestKind, Request);
