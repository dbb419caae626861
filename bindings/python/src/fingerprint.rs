//! The hash of spikes and decoded values that the firmware prints.

use numpy::PyReadonlyArray1;
use pyo3::prelude::*;

/// FNV-1a over the spikes and the decoded bits of each sample in turn, from a hash on.
///
/// A spike is its neuron and its sub-timestep, 16 bits each, and a byte for its direction; a byte 255 ends those of a
/// sample, and its value follows as a double. All are little endian.
#[pyfunction]
pub(crate) fn fingerprint(
    cells: PyReadonlyArray1<i8>,
    values: PyReadonlyArray1<f64>,
    neurons: usize,
    slots: usize,
    mut hash: u64,
) -> PyResult<u64> {
    let mut put = |bytes: &[u8]| {
        for &byte in bytes {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    };
    let rows = cells.as_slice()?.chunks_exact(neurons * slots);
    for (row, value) in rows.zip(values.as_slice()?) {
        for neuron in 0..neurons {
            for slot in 0..slots {
                let cell = row[slot * neurons + neuron];
                for _ in 0..cell.unsigned_abs() {
                    put(&(neuron as u16).to_le_bytes());
                    put(&(slot as u16).to_le_bytes());
                    put(&[u8::from(cell > 0)]);
                }
            }
        }
        put(&[0xff]);
        put(&value.to_bits().to_le_bytes());
    }
    Ok(hash)
}
