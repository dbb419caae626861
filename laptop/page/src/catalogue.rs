//! The catalogue for a page: names, words, and what a field and a slider of each parameter are like.

use catalogue::{Kind, Parameter, Search, Unit};
use lab::advise::verdict;
use lab::scheme::Scheme;
use serde_json::{Value, json};
use spikewire_flight::UnitSize;

/// Units among which a user chooses for a gyroscope and for an accelerometer.
const UNITS: [&[&str]; 2] = [&["rad/s", "deg/s"], &["m/s²", "g"]];

/// All schemes, and the units of sensors.
pub(crate) fn all() -> Value {
    let schemes = Scheme::all().map(|scheme| {
        let info = scheme.info();
        let parameters: Vec<Value> = info.parameters.iter().map(parameter).collect();
        json!({
            "name": info.name,
            "title": info.title,
            "words": info.words,
            "goodFor": info.good_for,
            "isSigned": info.is_signed,
            "flown": verdict(info.name),
            "parameters": parameters,
        })
    });
    let units = UNITS.map(|units| units.iter().map(|name| unit(name)).collect::<Vec<_>>());
    json!({ "schemes": schemes.collect::<Vec<_>>(), "units": units })
}

/// Returns a unit as the page takes it: with the number of it that are 1 rad/s or 1 m/s², if it is a unit of turn rates or
/// accelerations.
pub(crate) fn unit(name: &str) -> Value {
    let size = UnitSize::of(name);
    let rate = size.and_then(UnitSize::rate);
    let per_si = rate.or(size.and_then(UnitSize::acceleration)).map(f64::recip);
    json!({ "name": name, "perSi": per_si, "isRate": rate.is_some() })
}

fn parameter(own: &Parameter) -> Value {
    let (kind, words): (&str, &[&str]) = match own.kind {
        Kind::Number => ("number", &[]),
        Kind::Count => ("count", &[]),
        Kind::Choice(words) => ("choice", words),
        Kind::Flag => ("flag", &[]),
        Kind::Text => ("text", &[]),
        Kind::Filter => ("filter", &[]),
    };
    let unit = match own.unit {
        Unit::None => "",
        Unit::Signal => "signal",
        Unit::Samples => "samples",
    };
    json!({
        "name": own.name,
        "key": own.key(),
        "kind": kind,
        "words": words,
        "unit": unit,
        "help": own.help,
        "example": own.example,
        "slider": own.search.and_then(slider),
    })
}

/// Between which numbers a slider goes: `of` says what they are parts of.
fn slider(search: Search) -> Option<Value> {
    let (of, low, high, is_log) = match search {
        Search::Log(low, high) | Search::Fields(low, high) => ("unit", low, high, true),
        Search::Around(low, high) => ("around", low, high, false),
        Search::Whole(low, high) | Search::Most(low, high) => {
            ("whole", low.into(), high.into(), false)
        }
        Search::OfFilter(..) | Search::Thresholds(..) | Search::Words(_) | Search::Filter(..) => {
            return None;
        }
    };
    Some(json!({ "of": of, "low": low, "high": high, "isLog": is_log }))
}
