//! Filters before a code.

use anyhow::{Result, bail};
use catalogue::for_sample_type;
use catalogue::run::SampleType;
use numpy::PyArray1;
use pyo3::prelude::*;
use spikewire::filter::{Biquad, BiquadState, Filter as _, FirstOrder, FirstOrderState};
use spikewire::{Fingerprint, Sample};

use crate::array::{Lane, Samples};
use crate::coder::told;
use crate::error::value;

/// Filters in a row, by their corners.
#[derive(Clone)]
#[pyclass(frozen, from_py_object, module = "spikewire._native")]
pub(crate) struct Filter(Vec<Stage>);

#[derive(Clone, Copy)]
enum Stage {
    FirstOrder { corner: f32, rate: f32 },
    LowPass { corner: f32, rate: f32, q: Option<f32> },
    Notch { centre: f32, rate: f32, q: f32 },
}

#[pymethods]
impl Filter {
    #[staticmethod]
    fn first_order(corner: f32, rate: f32) -> PyResult<Self> {
        Self::checked(Stage::FirstOrder { corner, rate })
    }

    #[staticmethod]
    #[pyo3(signature = (corner, rate, q=None))]
    fn low_pass(corner: f32, rate: f32, q: Option<f32>) -> PyResult<Self> {
        Self::checked(Stage::LowPass { corner, rate, q })
    }

    #[staticmethod]
    fn notch(centre: f32, rate: f32, q: f32) -> PyResult<Self> {
        Self::checked(Stage::Notch { centre, rate, q })
    }

    /// This filter, and another after it.
    fn then(&self, other: &Self) -> Self {
        Self([&self.0[..], &other.0].concat())
    }

    /// By how many samples a slow signal comes late.
    fn delay(&self) -> PyResult<f32> {
        self.build::<f32>().map(|chain| chain.delay()).map_err(value)
    }

    /// Filters samples in a sample type, each channel by itself: one channel after the other.
    fn filter<'py>(
        &self,
        py: Python<'py>,
        samples: Samples,
        sample: &str,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let sample: SampleType = sample.parse().map_err(value)?;
        let samples = samples.view();
        if let Some((channel, bad)) = samples.bad(sample) {
            return Err(value(told(channel, 0, &bad)));
        }
        let lanes = samples.lanes();
        let filtered =
            py.detach(|| for_sample_type!(sample, S => self.filtered::<S>(&lanes, sample.one())));
        Ok(PyArray1::from_vec(py, filtered.map_err(value)?))
    }
}

impl Filter {
    /// Filters channels in units of the sample type, which has `one` of them for 1.
    fn filtered<S: Sample>(&self, lanes: &[Lane], one: f64) -> Result<Vec<f64>> {
        let mut filtered = Vec::new();
        for lane in lanes {
            let mut chain = self.build::<S>()?;
            for value in lane.to_vec() {
                filtered.push(chain.next(S::from_f64(value * one)).to_f64() / one);
            }
        }
        Ok(filtered)
    }

    fn checked(stage: Stage) -> PyResult<Self> {
        let own = Self(vec![stage]);
        own.build::<f32>().map_err(value)?;
        Ok(own)
    }

    /// The filters in a sample type, before their first sample.
    ///
    /// # Errors
    /// Returns an error if a corner or `q` is out of range.
    pub(crate) fn build<S: Sample>(&self) -> Result<Chain<S>> {
        self.0.iter().map(|stage| stage.build()).collect::<Result<_>>().map(Chain)
    }
}

impl Stage {
    fn build<S: Sample>(self) -> Result<Running<S>> {
        let built = match self {
            Self::FirstOrder { corner, rate } => FirstOrder::try_low_pass(corner, rate)
                .map(|filter| Running::FirstOrder(filter, FirstOrder::START)),
            Self::LowPass { corner, rate, q: None } => Biquad::try_low_pass(corner, rate)
                .map(|filter| Running::Biquad(filter, Biquad::START)),
            Self::LowPass { corner, rate, q: Some(q) } => {
                Biquad::try_low_pass_with_q(corner, rate, q)
                    .map(|filter| Running::Biquad(filter, Biquad::START))
            }
            Self::Notch { centre, rate, q } => Biquad::try_notch(centre, rate, q)
                .map(|filter| Running::Biquad(filter, Biquad::START)),
        };
        match built {
            Ok(running) => Ok(running),
            Err(error) => bail!("{error}"),
        }
    }
}

/// Filters in a row with their states; none of them lets every sample pass.
pub(crate) struct Chain<S: Sample>(Vec<Running<S>>);

enum Running<S: Sample> {
    Biquad(Biquad<S>, BiquadState<S>),
    FirstOrder(FirstOrder<S>, FirstOrderState<S>),
}

impl<S: Sample> Chain<S> {
    pub(crate) const fn none() -> Self {
        Self(Vec::new())
    }

    pub(crate) fn next(&mut self, sample: S) -> S {
        self.0.iter_mut().fold(sample, |sample, own| match own {
            Running::Biquad(filter, state) => filter.filter(state, sample),
            Running::FirstOrder(filter, state) => filter.filter(state, sample),
        })
    }

    /// The fingerprint of a scheme behind these filters.
    pub(crate) fn before(&self, scheme: Fingerprint) -> Fingerprint {
        let stages = self.0.iter().rev();
        stages.fold(scheme, |scheme, own| match own {
            Running::Biquad(filter, _) => filter.fingerprint().and(scheme),
            Running::FirstOrder(filter, _) => filter.fingerprint().and(scheme),
        })
    }

    fn delay(&self) -> f32 {
        let each = self.0.iter().map(|own| match own {
            Running::Biquad(filter, _) => filter.delay(),
            Running::FirstOrder(filter, _) => filter.delay(),
        });
        each.sum()
    }
}
