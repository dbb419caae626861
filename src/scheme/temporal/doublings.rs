//! The check of a step or a threshold that doubles, for the adaptive schemes.

use crate::error::{step, tri, within};
use crate::num::{largest_step, to_f64};
use crate::{ConfigError, Sample};

/// Checks a threshold and how often it doubles, at most `most` times.
///
/// # Errors
/// Returns an error if the threshold is not above 0, or not finite; there are more doublings; the threshold doubled
/// as often, which the error names `largest`, is more than the sample type holds, or above 10³¹ in `f32`.
pub(super) const fn check<S: Sample>(
    threshold: S,
    doublings: u8,
    most: u8,
    largest: &'static str,
) -> Result<(), ConfigError> {
    let smallest = to_f64(threshold);
    tri!(step("threshold", smallest));
    tri!(within("doublings", doublings as f64, 0.0, most as f32));
    let (value, max) = (smallest * (1_u64 << (doublings & 31)) as f64, largest_step::<S>());
    if value > max {
        let (value, min, max) = (value as f32, smallest as f32, max as f32);
        return Err(ConfigError::OutOfRange { parameter: largest, value, min, max });
    }
    Ok(())
}

/// The methods of an adaptive code's [`Scheme`](crate::Scheme) that do not step: its decoder holds a value, and a history
/// in this field, which is this one at rest.
macro_rules! hold_with_history {
    ($State:ident, $field:ident: $rest:expr) => {
        fn decoder_state(&self) -> $State<S> {
            $State { value: S::ZERO, $field: $rest }
        }

        #[inline]
        fn decode_slice(
            &self,
            state: &mut $State<S>,
            spikes: &[impl Copy + Into<Spike>],
            values: &mut [S],
        ) -> usize {
            crate::scheme::codec::decode_copied(self, state, spikes, values)
        }

        fn held(&self, state: &$State<S>) -> Option<S> {
            Some(state.value)
        }

        fn resync(&self, state: &mut $State<S>, value: S) {
            *state = $State { value, $field: $rest };
        }
    };
}
pub(super) use hold_with_history;
