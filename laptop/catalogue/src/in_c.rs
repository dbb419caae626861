//! A scheme's forms in C.
//!
//! The library's declarations are written from this: types and values are Rust, in which `S` stands for the sample type
//! and `{0}` for the first number of the shape.

/// A scheme as a codec of C's library, in a few shapes.
#[derive(Clone, Copy, Debug)]
pub struct InC {
    /// The name in C, without the shape and the sample type: `threshold_hough`.
    pub name: &'static str,
    /// Its type: `rate::ThresholdHough<S, {0}>`.
    pub scheme: &'static str,
    /// Its shapes; the first flies.
    pub shapes: &'static [&'static [usize]],
    /// How it is initialised.
    pub made: &'static [Made],
}

/// A way to initialise a codec.
#[derive(Clone, Copy, Debug)]
pub struct Made {
    /// How the function's name ends: `init`.
    pub name: &'static str,
    /// Its arguments, in a line.
    pub words: &'static str,
    /// Its arguments.
    pub arguments: &'static [Argument],
    /// A `Result` of the scheme or a `ConfigError`; `?` works in it.
    pub value: &'static str,
    /// Under which name it flies the recorded flight.
    pub flies: Option<&'static str>,
}

/// An argument of an initialisation.
#[derive(Clone, Copy, Debug)]
pub struct Argument {
    /// Its name.
    pub name: &'static str,
    /// Its type in Rust.
    pub kind: &'static str,
    /// Its value on the recorded flight.
    pub flown: Flown,
}

/// The value of an argument on the recorded flight, from the channel's calibration.
#[derive(Clone, Copy, Debug)]
pub enum Flown {
    /// This initialisation does not fly.
    Not,
    /// A part of the channel's range.
    Fraction(f64),
    /// Its smallest sample.
    Min,
    /// Its largest sample.
    Max,
    /// This number.
    Number(f64),
    /// The calibration.
    Calibration,
}

impl Argument {
    /// One that does not fly.
    pub const fn new(name: &'static str, kind: &'static str) -> Self {
        Self { name, kind, flown: Flown::Not }
    }

    /// A sample.
    pub const fn sample(name: &'static str, flown: Flown) -> Self {
        Self { name, kind: "S", flown }
    }

    /// A number of this type.
    pub const fn number(name: &'static str, kind: &'static str, flown: f64) -> Self {
        Self { name, kind, flown: Flown::Number(flown) }
    }

    /// The range's lower end.
    pub const MIN: Self = Self::sample("min", Flown::Min);
    /// The range's upper end.
    pub const MAX: Self = Self::sample("max", Flown::Max);
    /// The number that a rate code subtracts from the samples.
    pub const SHIFT: Self = Self::sample("shift", Flown::Min);
    /// As many taps as the shape says.
    pub const TAPS: Self = Self::new("taps", "[S; {0}]");
    /// As many centres as the shape says.
    pub const CENTRES: Self = Self::new("centres", "[S; {0}]");
    /// The triangle of a filter.
    pub const TRIANGULAR: Self = Self::number("shape", "rate::Shape", 0.0);
    /// The Hann window of a filter.
    pub const HANN: Self = Self::number("shape", "rate::Shape", 1.0);
}
