//! Samples of `NumPy` arrays as they lie in memory, and decoded values.

use std::ops::Range;

use catalogue::run::{self, Codec, SampleType};
use numpy::ndarray::{ArrayView1, ArrayViewD, Axis, Ix1, Slice};
use numpy::{PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::channel::Bad;
use crate::error::value;

/// Samples; time runs along the last axis, and what is before it are channels.
#[derive(FromPyObject)]
pub(crate) enum Samples<'py> {
    /// `float32`.
    F32(PyReadonlyArrayDyn<'py, f32>),
    /// `float64`.
    F64(PyReadonlyArrayDyn<'py, f64>),
    /// `int16`.
    I16(PyReadonlyArrayDyn<'py, i16>),
}

/// The samples of one channel, perhaps with others between them.
#[derive(Clone, Copy)]
pub(crate) enum Lane<'a> {
    /// `float32`.
    F32(ArrayView1<'a, f32>),
    /// `float64`.
    F64(ArrayView1<'a, f64>),
    /// `int16`.
    I16(ArrayView1<'a, i16>),
}

impl Lane<'_> {
    /// How many samples there are.
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::F32(lane) => lane.len(),
            Self::F64(lane) => lane.len(),
            Self::I16(lane) => lane.len(),
        }
    }

    /// Some of the samples.
    pub(crate) fn part(&self, range: Range<usize>) -> Lane<'_> {
        let part = Slice::from(range);
        match self {
            Self::F32(lane) => Lane::F32(lane.slice_axis(Axis(0), part)),
            Self::F64(lane) => Lane::F64(lane.slice_axis(Axis(0), part)),
            Self::I16(lane) => Lane::I16(lane.slice_axis(Axis(0), part)),
        }
    }

    /// The samples as doubles, exactly.
    pub(crate) fn to_vec(self) -> Vec<f64> {
        match self {
            Self::F32(lane) => lane.iter().copied().map(f64::from).collect(),
            Self::F64(lane) => lane.to_vec(),
            Self::I16(lane) => lane.iter().copied().map(f64::from).collect(),
        }
    }

    /// Encodes the samples, which are good, into rows of cells, and returns how many rows that made.
    pub(crate) fn encode(&self, codec: &mut Codec, cells: &mut [i8]) -> usize {
        let samples = match self {
            Self::F32(lane) => lane.as_slice().map(run::Samples::F32),
            Self::F64(lane) => lane.as_slice().map(run::Samples::F64),
            Self::I16(lane) => lane.as_slice().map(run::Samples::I16),
        };
        match (samples, self) {
            (Some(samples), _) => codec.encode_cells(samples, cells),
            (None, Self::F32(lane)) => codec.encode_cells(run::Samples::F32(&lane.to_vec()), cells),
            (None, lane) => codec.encode_cells(run::Samples::F64(&lane.to_vec()), cells),
        }
    }

    /// How many samples lie outside the range of this type.
    fn beyond(&self, sample: SampleType) -> usize {
        let (low, high) = sample.range();
        let is_beyond = |value: f64| value < low || value > high;
        match self {
            Self::F32(lane) => lane.iter().filter(|value| is_beyond(f64::from(**value))).count(),
            Self::F64(lane) => lane.iter().filter(|value| is_beyond(**value)).count(),
            Self::I16(lane) => lane.iter().filter(|value| is_beyond(f64::from(**value))).count(),
        }
    }

    /// The first sample that an encoder of this type does not take: it is not finite, or becomes so in the type.
    pub(crate) fn bad(&self, sample: SampleType) -> Option<Bad> {
        match self {
            Self::F32(lane) => {
                let place = lane.iter().position(|value| !value.is_finite())?;
                Some(Bad { sample: place, what: format!("{} is not finite", lane[place]) })
            }
            Self::F64(lane) => {
                let is_single = sample == SampleType::F32;
                let is_good = |value: &f64| {
                    if is_single { (*value as f32).is_finite() } else { value.is_finite() }
                };
                let place = lane.iter().position(|value| !is_good(value))?;
                let value = lane[place];
                let what = if value.is_finite() { "beyond f32" } else { "not finite" };
                Some(Bad { sample: place, what: format!("{value:?} is {what}") })
            }
            Self::I16(_) => None,
        }
    }
}

impl Samples<'_> {
    /// The lengths of its axes.
    pub(crate) fn shape(&self) -> &[usize] {
        match self {
            Self::F32(array) => array.shape(),
            Self::F64(array) => array.shape(),
            Self::I16(array) => array.shape(),
        }
    }

    /// The channels, in the order of a C array. There is an axis at least.
    pub(crate) fn lanes(&self) -> Vec<Lane<'_>> {
        match self {
            Self::F32(array) => split(array.as_array()).into_iter().map(Lane::F32).collect(),
            Self::F64(array) => split(array.as_array()).into_iter().map(Lane::F64).collect(),
            Self::I16(array) => split(array.as_array()).into_iter().map(Lane::I16).collect(),
        }
    }
}

/// Says how many samples were cut to the range of the sample type, if any. Fixed point cuts; beyond `f32` is an error.
#[pyfunction]
pub(crate) fn cut(py: Python, sample: &str, samples: Samples) -> PyResult<Option<String>> {
    let sample: SampleType = sample.parse().map_err(value)?;
    if sample == SampleType::F32 {
        return Ok(None);
    }
    let lanes = samples.lanes();
    let count: usize = py.detach(|| lanes.iter().map(|lane| lane.beyond(sample)).sum());
    Ok(lab::fit::cut(sample, count as u64))
}

/// The rows along the last axis.
fn split<T>(view: ArrayViewD<'_, T>) -> Vec<ArrayView1<'_, T>> {
    let rows = view.len_of(Axis(0));
    match view.clone().into_dimensionality::<Ix1>() {
        Ok(row) => vec![row],
        Err(_) => {
            (0..rows).flat_map(|row| split(view.clone().index_axis_move(Axis(0), row))).collect()
        }
    }
}
