//! Parameters with which any scheme can be tried.

use crate::Info;

/// The parameters of a scheme for a signal between -2.5 and 2.5, as pairs of TOML: those that have no default.
pub fn example(info: &Info) -> String {
    let open = info.parameters.iter().filter(|own| own.is_recorded && own.default.is_none());
    let given = open.filter_map(|own| match own.name {
        "min" | "shift" => Some(format!("{} = -2.5", own.name)),
        "max" => Some("max = 2.5".to_owned()),
        "start" => None,
        name if own.example.parse::<f64>().is_ok() => Some(format!("{name} = {}", own.example)),
        _ if own.example.is_empty() => None,
        name => Some(format!("{name} = \"{}\"", own.example)),
    });
    given.collect::<Vec<_>>().join(", ")
}
