//! Errors and notes in the words of the page, where some settings are boxes with a label.

use anyhow::Error;
use catalogue::run::{Worded, quoted};
use lab::ErrorKind;
use lab::tune::RequestKind;
use serde_json::{Value, json};

/// The label of a setting's box; parameters of schemes have boxes by their names.
pub(crate) fn label(name: &str) -> String {
    match name {
        "accept_cut" => "“take the whole messages of a damaged log”".to_owned(),
        "skip_non_finite" => "“pass over missing values”".to_owned(),
        "rate" => "“samples a second”".to_owned(),
        "time_unit" => "“unit of time”".to_owned(),
        "header" => "“header line”".to_owned(),
        "topic" => "a topic".to_owned(),
        "field" => "a field".to_owned(),
        name => quoted(name),
    }
}

/// An error for the page: its words, the setting to mark, the file, and the setting that would go on over it.
pub(crate) fn of(error: &Error) -> Value {
    let mut words = Vec::new();
    for cause in error.chain() {
        if let Some(own) = cause.downcast_ref::<lab::Error>() {
            words.push(of_lab(own));
            return json!({
                "message": words.join(": "),
                "parameter": own.parameter.as_ref().map(|own| &own.name),
                "file": own.file(),
                "remedy": own.remedy(),
            });
        }
        if let Some(own) = cause.downcast_ref::<catalogue::run::Error>() {
            words.push(own.spelled(label).to_string());
            let parameter = own.parameter.as_ref().map(|own| &own.name);
            return json!({ "message": words.join(": "), "parameter": parameter });
        }
        words.push(cause.to_string());
    }
    json!({ "message": words.join(": ") })
}

/// An error of the library; the page holds out what it does, and no box changes that.
fn of_lab(error: &lab::Error) -> String {
    match *error.kind {
        ErrorKind::Request(RequestKind::TooShort { samples, enough }) => format!(
            "{}{samples} samples are too few to tune on some and hold out others; {enough} would do",
            error.place
        ),
        _ => error.spelled(label).to_string(),
    }
}
