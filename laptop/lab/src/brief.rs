//! Formats parameters in a short form, for tables and pictures.

use catalogue::run::Value;

/// Formats parameters as `threshold=0.1, start=0.001`. Taps are shortened to their number and sum. Any other list of
/// more than four numbers is shortened to its first number, last number and length.
pub fn brief(parameters: &[(&'static str, Value)]) -> String {
    let words = parameters.iter().map(|(key, value)| match list(value) {
        Some(taps) if *key == "taps" => {
            format!("{} taps, sum {}", taps.len(), short(taps.iter().sum()))
        }
        Some(many) if many.len() > 4 => {
            format!("{key}={},..,{} ({})", short(many[0]), short(many[many.len() - 1]), many.len())
        }
        Some(few) => format!("{key}={}", few.into_iter().map(short).collect::<Vec<_>>().join(",")),
        None => format!("{key}={value}"),
    });
    words.collect::<Vec<_>>().join(", ")
}

fn list(value: &Value) -> Option<Vec<f64>> {
    value.number().map(|number| vec![number]).or_else(|| value.numbers().map(<[f64]>::to_vec))
}

/// Formats a number with at most six significant digits.
pub fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{}", value + 0.0);
    }
    let decimals = (5 - value.abs().log10().floor() as i32).clamp(0, 17) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// Converts a parameter's value to JSON: a number, a list of numbers, or a word.
pub(crate) fn json(value: &Value) -> serde_json::Value {
    let text = value.to_string();
    let numbers: Option<Vec<serde_json::Value>> =
        text.split(',').map(|number| serde_json::from_str(number).ok()).collect();
    match numbers.as_deref() {
        Some([number]) => number.clone(),
        Some(numbers) => numbers.into(),
        None => text.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::{brief, short};

    #[test]
    fn numbers_and_lists_are_short() {
        for (value, text) in [
            (0.1, "0.1"),
            (0.000_965_071_8, "0.000965072"),
            (1_234_567.0, "1234567"),
            (-0.5, "-0.5"),
            (0.0, "0"),
            (100.0, "100"),
        ] {
            assert_eq!(short(value), text);
        }
        let parameters = [
            ("taps", vec![0.5, 1.0, 0.5].into()),
            ("form", "toolbox".into()),
            ("seed", 7_u64.into()),
        ];
        assert_eq!(brief(&parameters), "3 taps, sum 2, form=toolbox, seed=7");
    }
}
