//! The names of the schemes, and the parameters that each takes.

use clap::ValueEnum;

/// A scheme, by the name that options and files use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SchemeName {
    /// Temporal contrast.
    Tbr,
    /// Step forward.
    Sf,
    /// Moving window.
    Mw,
    /// Hough spiker.
    Hsa,
    /// Threshold Hough spiker.
    THsa,
    /// Ben's spiker.
    Bsa,
    /// Position coding.
    Position,
    /// Gaussian receptive fields, one spike a sample.
    Grf,
    /// Gaussian receptive fields with sub-timesteps.
    GrfSlots,
    /// Gaussian receptive fields with probabilistic spiking.
    GrfProb,
}

impl SchemeName {
    /// All schemes, in the paper's order.
    pub(crate) const ALL: [Self; 10] = [
        Self::Tbr,
        Self::Mw,
        Self::Sf,
        Self::Bsa,
        Self::Hsa,
        Self::THsa,
        Self::Position,
        Self::Grf,
        Self::GrfSlots,
        Self::GrfProb,
    ];

    /// The name.
    pub(crate) fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }

    /// The name as the paper prints it.
    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Tbr => "TBR",
            Self::Sf => "SF",
            Self::Mw => "MW",
            Self::Hsa => "HSA",
            Self::THsa => "T-HSA",
            Self::Bsa => "BSA",
            Self::Position => "Position",
            Self::Grf => "GRF",
            Self::GrfSlots => "GRF, slots",
            Self::GrfProb => "GRF, probabilistic",
        }
    }

    /// The options that it takes.
    pub(crate) fn options(self) -> &'static [&'static str] {
        match self {
            Self::Tbr => &["factor", "magnitudes", "threshold", "step", "start"],
            Self::Sf => &["threshold", "start"],
            Self::Mw => &["threshold", "window", "start"],
            Self::Hsa => &["filter", "shift"],
            Self::THsa => &["filter", "threshold", "shift"],
            Self::Bsa => &["filter", "threshold", "form", "criterion", "shift"],
            Self::Position => &["centres", "neurons", "min", "max"],
            Self::Grf => &["neurons", "min", "max"],
            Self::GrfSlots => &["neurons", "slots", "beta", "floor", "min", "max"],
            Self::GrfProb => &["neurons", "beta", "seed", "min", "max"],
        }
    }

    /// Whether its spikes have a direction.
    pub(crate) fn is_signed(self) -> bool {
        matches!(self, Self::Tbr | Self::Sf | Self::Mw)
    }
}
