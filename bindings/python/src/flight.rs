//! A flight's file.

use lab::flight::{Channel, Filter, Flight};
use pyo3::prelude::*;

use crate::error::value;
use crate::values::{Given, keywords};

/// A channel: name, source, unit, counts a unit, keywords of its scheme.
type Heard = (String, String, String, f64, Vec<(&'static str, Given)>);

/// A filter: its kind, its corner or centre in Hz, and a notch's `q`.
type Filtering = (&'static str, f32, Option<f32>);

/// Settings that the sender alone decides: bits of step numbers, the time in µs that events wait for others, and the time
/// from one full frame to the next.
type Sends = (u8, u32, u32);

/// A flight: scheme, sample type, period in µs, samples from keyframe to keyframe, error of the clock in millionths, label,
/// fingerprint, filter, channels, parameters that the sample type changes, and what the sender decides.
type FlightFields = (
    &'static str,
    String,
    u32,
    u32,
    u32,
    String,
    u32,
    Option<Filtering>,
    Vec<Heard>,
    Vec<String>,
    Sends,
);

/// Reads a flight's file.
#[pyfunction]
pub(crate) fn flight(path: &str) -> PyResult<FlightFields> {
    let flight = Flight::read(path).map_err(value)?;
    let filter = flight.filter.map(|own| match own {
        Filter::FirstOrder { corner } => ("first_order", corner, None),
        Filter::LowPass { corner } => ("low_pass", corner, None),
        Filter::Notch { centre, q } => ("notch", centre, Some(q)),
    });
    let channels = flight.channels.iter().enumerate().map(|(index, own)| {
        let Channel { name, source, unit, counts, .. } = own.clone();
        (name, source, unit, counts, keywords(&flight.asked_as_flown(index)))
    });
    Ok((
        flight.scheme.name,
        flight.sample.to_string(),
        flight.period.get(),
        flight.keyframe_every,
        flight.clock_ppm,
        flight.label(),
        flight.fingerprint().bits(),
        filter,
        channels.collect(),
        flight.rounded().iter().map(ToString::to_string).collect(),
        (flight.step_bits, flight.gathering, flight.full_every),
    ))
}
