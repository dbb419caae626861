//! Population codes: which neuron of `M` fires tells the value.

mod cells;
mod centres;
mod fields;
mod gaussian;
mod position;
#[cfg(feature = "rand")]
mod probabilistic;
mod search;
mod slots;
mod spaced;

pub use centres::Centres;
pub use fields::ReceptiveFields;
pub use gaussian::Gaussian;
pub use position::{Neuron, Position, PositionDecoder, PositionEncoder};
#[cfg(feature = "rand")]
pub use probabilistic::{Pattern, Probabilistic, ProbabilisticDecoder, ProbabilisticEncoder};
pub use slots::{Slots, SlotsDecoder, SlotsEncoder, Volley};
pub(crate) use spaced::Spaced;
