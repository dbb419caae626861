//! A channel's codec on arrays, with words for what is wrong.

use catalogue::run::{Codec, SampleType, Values};

use crate::array::Lane;

/// What was wrong with which sample, counted from the first of the call.
pub(crate) struct Bad {
    /// The sample.
    pub sample: usize,
    /// What is wrong.
    pub what: String,
}

/// Encodes samples into rows of cells, which are all 0, and returns how many rows that made.
///
/// # Errors
/// A sample is not finite, or not so in the sample type.
pub(crate) fn encode(
    codec: &mut Codec,
    sample: SampleType,
    lane: Lane,
    cells: &mut [i8],
) -> Result<usize, Bad> {
    lane.bad(sample).map_or_else(|| Ok(lane.encode(codec, cells)), Err)
}

/// Decodes as many rows of cells as there is room for values.
///
/// # Errors
/// No encoder makes such a row.
pub(crate) fn decode(codec: &mut Codec, cells: &[i8], values: &mut Values) -> Result<(), Bad> {
    let shape = codec.shape();
    codec.decode_cells(cells, values).map_err(|sample| {
        let row = cells.chunks_exact(shape.neurons * shape.slots).nth(sample).unwrap_or_default();
        Bad { sample, what: format!("{row:?} is no code of a sample") }
    })
}
