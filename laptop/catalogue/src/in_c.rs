//! The forms of a scheme in C.
//!
//! The C library's declarations are generated from this. Types and values are written in Rust, with `S` for the sample
//! type and `{0}` for the first number of the shape.

/// A scheme as a codec of the C library, in several shapes.
#[derive(Clone, Copy, Debug)]
pub struct InC {
    /// The name in C, without the shape and the sample type: `threshold_hough`.
    pub name: &'static str,
    /// The scheme's type: `rate::ThresholdHough<S, {0}>`.
    pub scheme: &'static str,
    /// The shapes; the first of them flies.
    pub shapes: &'static [&'static [usize]],
    /// The functions that initialise it.
    pub made: &'static [Made],
}

/// A function that initialises a codec.
#[derive(Clone, Copy, Debug)]
pub struct Made {
    /// Ending of the function's name: `init`.
    pub name: &'static str,
    /// The arguments in words, in one line.
    pub words: &'static str,
    /// The arguments.
    pub arguments: &'static [Argument],
    /// Rust expression for a `Result` of the scheme or a `ConfigError`; it may use `?`.
    pub value: &'static str,
    /// Name under which it flies the recorded flight, if it does.
    pub flies: Option<&'static str>,
}

/// An argument of a function that initialises a codec.
#[derive(Clone, Copy, Debug)]
pub struct Argument {
    /// Name of the argument.
    pub name: &'static str,
    /// Type in Rust.
    pub kind: &'static str,
    /// Value for the recorded flight.
    pub flown: Flown,
}

/// The value of an argument on the recorded flight, from the channel's calibration.
#[derive(Clone, Copy, Debug)]
pub enum Flown {
    /// None: the function is not used on the flight.
    Not,
    /// A fraction of the channel's range.
    Fraction(f64),
    /// The channel's smallest sample.
    Min,
    /// The channel's largest sample.
    Max,
    /// This number.
    Number(f64),
    /// The channel's calibration.
    Calibration,
}

impl Argument {
    /// Makes an argument of a function that is not used on the flight.
    pub const fn new(name: &'static str, kind: &'static str) -> Self {
        Self { name, kind, flown: Flown::Not }
    }

    /// Makes an argument that is a sample.
    pub const fn sample(name: &'static str, flown: Flown) -> Self {
        Self { name, kind: "S", flown }
    }

    /// Makes an argument that is a number of this type.
    pub const fn number(name: &'static str, kind: &'static str, flown: f64) -> Self {
        Self { name, kind, flown: Flown::Number(flown) }
    }

    /// The range's lower end.
    pub const MIN: Self = Self::sample("min", Flown::Min);
    /// The range's upper end.
    pub const MAX: Self = Self::sample("max", Flown::Max);
    /// The number that a rate code subtracts from the samples.
    pub const SHIFT: Self = Self::sample("shift", Flown::Min);
    /// Taps of a filter, as many as the shape says.
    pub const TAPS: Self = Self::new("taps", "[S; {0}]");
    /// Centres, as many as the shape says.
    pub const CENTRES: Self = Self::new("centres", "[S; {0}]");
    /// The triangular shape of a filter.
    pub const TRIANGULAR: Self = Self::number("shape", "rate::Shape", 0.0);
    /// The shape of a Hann window.
    pub const HANN: Self = Self::number("shape", "rate::Shape", 1.0);
}
