//! Generates from the catalogue: the library's declarations, and the flight of the tests.

use catalogue::{Argument, Flown, IN_C, InC, Info, Made};
use std::fmt::Write;

/// The sample types: in Rust, and as endings of names in C.
const SAMPLES: [(&str, &str); 4] =
    [("f32", "f32"), ("i16", "i16"), ("I8F8", "q8_8"), ("I16F16", "q16_16")];

/// Generates `bindings/c/src/codecs.rs`.
pub fn codecs() -> String {
    let samples = SAMPLES.map(|(rust, suffix)| format!("{suffix}: {rust}")).join(", ");
    let mut text = format!(
        "//! Every scheme of the catalogue in its usual shapes. Written by `cargo xtask write c`.\n\n\
         use fixed::types::{{I8F8, I16F16}};\n\
         use spikewire::{{Calibration, population, rate, temporal, timing}};\n\n\
         crate::codecs! {{\n    for [{samples}];\n",
    );
    for (info, codec, shape) in shapes() {
        let filled = |words: &str| filled(words, shape);
        let words = format!("{}: {}.", capitalised(info.words), info.good_for);
        let _ = writeln!(text, "    /// {words}");
        let _ = writeln!(text, "    {}: {} {{", stem(codec, shape), filled(codec.scheme));
        for made in codec.made {
            let _ = writeln!(text, "        /// {}", made.words);
            let arguments: Vec<String> = made
                .arguments
                .iter()
                .map(|argument| format!("{}: {}", argument.name, filled(argument.kind)))
                .collect();
            let (init, arguments) = (made.name, arguments.join(", "));
            let _ = writeln!(text, "        made {init}({arguments}) = {};", filled(made.value));
        }
        text += "    }\n";
    }
    text + "}\n"
}

/// Generates `flown.h` of the tests, with a line for each codec that flies.
pub fn flown() -> String {
    let mut text = String::from("/* The codecs that fly, as the catalogue flies them. */\n");
    // In two halves, for a flash that has no room for more.
    let samples = SAMPLES.into_iter().map(|(_, suffix)| suffix);
    for (suffix, half) in samples.flat_map(|suffix| [(suffix, 0), (suffix, 1)]) {
        let _ = writeln!(text, "#if defined(FLY_{suffix}) && (!defined(HALF) || (HALF == {half}))");
        let own: Vec<_> = shapes().collect();
        let (first, second) = own.split_at(own.len() / 2);
        for (_, codec, shape) in [first, second][half] {
            let name = format!("{}_{suffix}", stem(codec, shape));
            for (label, made) in codec.made.iter().filter_map(|made| Some((made.flies?, made))) {
                let _ = writeln!(
                    text,
                    "FLY({name}, SW_{}_LATENCY, {suffix}, \"{label}\", {}, {})",
                    name.to_uppercase(),
                    made.name,
                    arguments(made, suffix)
                );
            }
        }
        text += "#endif\n";
    }
    text
}

/// Returns each codec in each of its shapes.
fn shapes() -> impl Iterator<Item = (&'static Info, &'static InC, &'static [usize])> {
    let codecs = IN_C.iter().flat_map(|(info, codecs)| codecs.iter().map(|codec| (*info, codec)));
    codecs.flat_map(|(info, codec)| codec.shapes.iter().map(move |shape| (info, codec, *shape)))
}

/// Returns the stem of a codec's names, such as `threshold_hough_15`.
fn stem(codec: &InC, shape: &[usize]) -> String {
    let shape: String = shape.iter().map(|number| format!("_{number}")).collect();
    format!("{}{shape}", codec.name)
}

/// Fills the shape's numbers into a text.
fn filled(text: &str, shape: &[usize]) -> String {
    let mut text = text.to_owned();
    for (place, number) in shape.iter().enumerate() {
        text = text.replace(&format!("{{{place}}}"), &number.to_string());
    }
    text
}

/// Writes the arguments of an initialisation for the flight, in C.
fn arguments(made: &Made, suffix: &str) -> String {
    let argument = |Argument { flown, kind, .. }: &Argument| match flown {
        Flown::Not => "NOT_FLOWN".to_owned(),
        Flown::Fraction(part) => format!("fraction_{suffix}(channel, {part:?})"),
        Flown::Min => "channel->min".to_owned(),
        Flown::Max => "channel->max".to_owned(),
        Flown::Number(number) if *kind == "f32" => format!("{number:?}f"),
        Flown::Number(number) => format!("{number}"),
        Flown::Calibration => "&channel->calibration".to_owned(),
    };
    made.arguments.iter().map(argument).collect::<Vec<_>>().join(", ")
}

fn capitalised(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_take_their_places() {
        assert_eq!(filled("rate::Slots<S, {0}, {1}>", &[15, 10]), "rate::Slots<S, 15, 10>");
    }

    /// C has every codec that flies the recording in Rust, except those that need a random generator.
    #[test]
    fn every_scheme_has_a_codec_unless_it_draws() {
        for (info, codecs) in IN_C {
            let draws = ["bernoulli", "grf-prob"].contains(&info.name);
            assert_eq!(codecs.is_empty(), draws, "{}", info.name);
            let flies = |codec: &InC| codec.made.iter().any(|made| made.flies.is_some());
            assert!(codecs.iter().all(flies), "{}", info.name);
        }
    }
}
