//! Samples of `NumPy` arrays as they lie in memory, and decoded values.

use std::ops::Range;

use catalogue::run::{self, Codec, SampleType};
use numpy::ndarray::{ArrayView1, ArrayViewD, Axis, Ix1, Ix2, Slice};
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

    /// The first sample.
    pub(crate) fn first(&self) -> Option<f64> {
        match self {
            Self::F32(lane) => lane.first().copied().map(f64::from),
            Self::F64(lane) => lane.first().copied(),
            Self::I16(lane) => lane.first().copied().map(f64::from),
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

    /// The samples, if they are neighbours in memory.
    pub(crate) fn in_memory(&self) -> Option<run::Samples<'_>> {
        match self {
            Self::F32(lane) => lane.as_slice().map(run::Samples::F32),
            Self::F64(lane) => lane.as_slice().map(run::Samples::F64),
            Self::I16(lane) => lane.as_slice().map(run::Samples::I16),
        }
    }

    /// Encodes the samples, which are good, into rows of cells, and returns how many rows that made.
    pub(crate) fn encode(&self, codec: &mut Codec, cells: &mut [i8]) -> usize {
        match (self.in_memory(), self) {
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
                let place = match lane.as_slice() {
                    Some(samples) => first_bad(samples, |value| value.is_finite()),
                    None => lane.iter().position(|value| !value.is_finite()),
                }?;
                Some(Bad { sample: place, what: format!("{} is not finite", lane[place]) })
            }
            Self::F64(lane) => {
                let is_good = is_good(sample);
                let place = match lane.as_slice() {
                    Some(samples) => first_bad(samples, is_good),
                    None => lane.iter().position(|value| !is_good(value)),
                }?;
                let value = lane[place];
                let what = if value.is_finite() { "beyond f32" } else { "not finite" };
                Some(Bad { sample: place, what: format!("{value:?} is {what}") })
            }
            Self::I16(_) => None,
        }
    }
}

/// Copies of neighbouring channels whose samples lie apart in memory.
pub(crate) enum Gathered {
    F32(Vec<f32>),
    F64(Vec<f64>),
    I16(Vec<i16>),
    /// The samples are used where they are.
    None,
}

impl Gathered {
    /// Copies the channels if their samples lie apart, and if there are no more than `most` of all channels. `whole` are
    /// all samples of the array in the order in which they lie in memory, if nothing lies between them.
    pub(crate) fn new(lanes: &[Lane], whole: Option<run::Samples>, most: usize) -> Self {
        let length = lanes.first().map_or(0, Lane::len);
        macro_rules! gathered {
            ($kind:ident) => {{
                let mut all = Vec::with_capacity(lanes.len());
                for lane in lanes {
                    match lane {
                        Lane::$kind(lane) if lane.as_slice().is_none() => all.push(lane.view()),
                        _ => return Self::None,
                    }
                }
                let whole = match whole {
                    Some(run::Samples::$kind(whole)) => whole,
                    _ => &[],
                };
                Self::$kind(transposed(&all, whole, length))
            }};
        }
        if lanes.len() < 2 || lanes.len() * length > most {
            return Self::None;
        }
        match lanes.first() {
            Some(Lane::F32(_)) => gathered!(F32),
            Some(Lane::F64(_)) => gathered!(F64),
            Some(Lane::I16(_)) => gathered!(I16),
            None => Self::None,
        }
    }

    /// The copy of a channel, if there is one.
    pub(crate) fn lane(&self, place: usize, length: usize) -> Option<run::Samples<'_>> {
        let range = place * length..(place + 1) * length;
        match self {
            Self::F32(all) => Some(run::Samples::F32(&all[range])),
            Self::F64(all) => Some(run::Samples::F64(&all[range])),
            Self::I16(all) => Some(run::Samples::I16(&all[range])),
            Self::None => None,
        }
    }
}

/// The samples of the channels, one channel after the other. `whole` may hold them, and more.
fn transposed<T: Copy + Default>(lanes: &[ArrayView1<T>], whole: &[T], length: usize) -> Vec<T> {
    let mut samples = vec![T::default(); lanes.len() * length];
    if let Some(rows) = rows(lanes, whole) {
        for (time, row) in rows.enumerate() {
            for (place, sample) in row.iter().enumerate() {
                samples[place * length + time] = *sample;
            }
        }
    } else {
        for (lane, samples) in lanes.iter().zip(samples.chunks_mut(length.max(1))) {
            samples.iter_mut().zip(lane).for_each(|(own, sample)| *own = *sample);
        }
    }
    samples
}

/// The samples of each moment, if those of neighbouring channels are neighbours in memory.
fn rows<'a, T>(lanes: &[ArrayView1<T>], whole: &'a [T]) -> Option<impl Iterator<Item = &'a [T]>> {
    let first = lanes.first()?;
    let step = usize::try_from(first.strides()[0]).ok().filter(|step| *step >= lanes.len())?;
    let place = |lane: &ArrayView1<T>| lane.as_ptr().addr() / size_of::<T>();
    let is_next = |(at, lane): (usize, &ArrayView1<T>)| {
        place(lane) == place(first) + at && lane.strides() == first.strides()
    };
    let start = place(first).checked_sub(whole.as_ptr().addr() / size_of::<T>())?;
    if !lanes.iter().enumerate().all(is_next) {
        return None;
    }
    let rest = whole.get(start..)?;
    Some(rest.chunks(step).map(|row| &row[..lanes.len().min(row.len())]).take(first.len()))
}

/// Returns the place of the first sample that is not good. Looks at blocks at first, without branches within.
fn first_bad<T>(samples: &[T], is_good: impl Fn(&T) -> bool) -> Option<usize> {
    const BLOCK: usize = 64;
    let mut blocks = samples.chunks(BLOCK);
    let block = blocks.position(|own| !own.iter().fold(true, |all, own| all & is_good(own)))?;
    let start = block * BLOCK;
    Some(start + samples[start..].iter().position(|own| !is_good(own))?)
}

/// Returns the test for doubles that an encoder of this type takes: they are finite, in `f32` after rounding too.
fn is_good(sample: SampleType) -> fn(&f64) -> bool {
    if sample == SampleType::F32 {
        |value| (*value as f32).is_finite()
    } else {
        |value| value.is_finite()
    }
}

/// The first sample that an encoder of this type does not take, and its channel. `whole` are the samples of all
/// channels in any order, where they can be had so.
pub(crate) fn bad(
    whole: Option<run::Samples>,
    lanes: &[Lane],
    sample: SampleType,
) -> Option<(usize, Bad)> {
    let are_good = match whole {
        Some(run::Samples::F32(all)) => first_bad(all, |value| value.is_finite()).is_none(),
        Some(run::Samples::F64(all)) => first_bad(all, is_good(sample)).is_none(),
        Some(run::Samples::I16(_)) => true,
        None => false,
    };
    let mut lanes = lanes.iter().enumerate().filter(|_| !are_good);
    lanes.find_map(|(channel, lane)| Some((channel, lane.bad(sample)?)))
}

impl Samples<'_> {
    /// All samples in the order in which they lie in memory, if nothing lies between them.
    pub(crate) fn in_memory(&self) -> Option<run::Samples<'_>> {
        match self {
            Self::F32(all) => all.as_array().to_slice_memory_order().map(run::Samples::F32),
            Self::F64(all) => all.as_array().to_slice_memory_order().map(run::Samples::F64),
            Self::I16(all) => all.as_array().to_slice_memory_order().map(run::Samples::I16),
        }
    }

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
    let mut rows =
        Vec::with_capacity(view.len() / view.shape().last().map_or(1, |own| (*own).max(1)));
    append(view, &mut rows);
    rows
}

/// Appends the rows. A view of two axes is kept in fixed room, where a row costs little.
fn append<'a, T>(view: ArrayViewD<'a, T>, rows: &mut Vec<ArrayView1<'a, T>>) {
    let length = view.len_of(Axis(0));
    match view.ndim() {
        1 => rows.extend(view.into_dimensionality::<Ix1>()),
        2 => {
            let Ok(view) = view.into_dimensionality::<Ix2>() else { return };
            rows.extend((0..length).map(|row| view.index_axis_move(Axis(0), row)));
        }
        _ => (0..length).for_each(|part| append(view.clone().index_axis_move(Axis(0), part), rows)),
    }
}
