//! Weights in flash.

use crate::checksum::Checksum;
use crate::error::{ParameterError, unwrap};
use crate::integer::{self, Packed};
use crate::number::{LARGEST, Number};

/// The weights from `IN` inputs to `OUT` neurons, with a row for each input. Put them in a `static`: they are read from
/// where they are stored.
///
/// `Weights<f32, …>` takes 4 bytes for each weight, `Weights<i32, …>` one: its weights have 8 bits, and its potentials
/// 32.
#[derive(Clone, Copy, Debug)]
pub struct Weights<V: Number, const IN: usize, const OUT: usize> {
    pub(crate) rows: [V::Row<OUT>; IN],
    pub(crate) scale: V::Scale,
}

impl<V: Number, const IN: usize, const OUT: usize> Weights<V, IN, OUT> {
    pub(crate) fn add_to(&self, sum: &mut Checksum) {
        V::add_rows(&self.rows, self.scale, sum);
    }
}

impl<const IN: usize, const OUT: usize> Weights<f32, IN, OUT> {
    /// Makes weights from rows by input. (A NIR file has rows by neuron: transpose them.)
    ///
    /// # Panics
    /// Panics if a weight is not finite or beyond ±10¹⁵; at compile time where it initialises a constant.
    pub const fn new(rows: &[[f32; OUT]; IN]) -> Self {
        unwrap(Self::try_new(rows))
    }

    /// Makes weights from rows by input.
    ///
    /// # Errors
    /// Returns an error if a weight is not finite or beyond ±10¹⁵.
    #[expect(clippy::indexing_slicing, reason = "below the arrays' lengths")]
    pub const fn try_new(rows: &[[f32; OUT]; IN]) -> Result<Self, ParameterError> {
        let mut row = 0;
        while row < IN {
            let mut column = 0;
            while column < OUT {
                let value = rows[row][column];
                if !(value >= -LARGEST && value <= LARGEST) {
                    let place = (row, column);
                    let (parameter, min, max) = ("weight", -LARGEST, LARGEST);
                    return Err(ParameterError { parameter, place, value, min, max });
                }
                column += 1;
            }
            row += 1;
        }
        Ok(Self { rows: *rows, scale: () })
    }
}

impl<const IN: usize, const OUT: usize> Weights<i32, IN, OUT> {
    /// Makes 8-bit weights from rows of up to 4096 inputs. A sum of weights is multiplied by 2 to the power of `shift`, 0 to 10,
    /// before it is added to a potential, so that potentials are finer than weights. A sum of weights times values is
    /// divided by it instead.
    ///
    /// # Panics
    /// Panics if the shift is above 10; at compile time where it initialises a constant.
    #[expect(clippy::indexing_slicing, reason = "below the arrays' lengths")]
    pub const fn packed(rows: &[[i8; OUT]; IN], shift: u32) -> Self {
        const {
            assert!(
                IN <= <i32 as Number>::MOST_SPIKES,
                "8-bit weights have 4096 inputs at most, so that sums of them fit 32 bits"
            );
        };
        assert!(shift <= integer::MOST_SHIFT, "a shift is 10 at most");
        let mut packed = [Packed::new(&[0; OUT]); IN];
        let mut row = 0;
        while row < IN {
            packed[row] = Packed::new(&rows[row]);
            row += 1;
        }
        Self { rows: packed, scale: 1 << shift }
    }
}
