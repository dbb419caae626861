//! What is written from the catalogue: the library's declarations, and the flight of the tests.

use catalogue::{Argument, Flown, IN_C, InC, Info, Made};
use std::fmt::Write;

/// The sample types: in Rust, and how names end in C.
const SAMPLES: [(&str, &str); 4] =
    [("f32", "f32"), ("i16", "i16"), ("I8F8", "q8_8"), ("I16F16", "q16_16")];

/// `c/src/codecs.rs`.
pub fn codecs() -> String {
    let mut text = String::from(
        "//! Every scheme of the catalogue in its usual shapes. Written by `cargo xtask write c`.\n\n\
         use fixed::types::{I8F8, I16F16};\n\
         use spikewire::{Calibration, population, rate, temporal, timing};\n\n\
         crate::codecs! {\n",
    );
    for (info, codec, shape, (rust, suffix)) in all() {
        let filled = |words: &str| filled(words, shape, rust);
        let words = format!("{}: {}.", capitalised(info.words), info.good_for);
        let _ = writeln!(text, "    /// {words}");
        let _ = writeln!(text, "    {}: {} {{", name(codec, shape, suffix), filled(codec.scheme));
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

/// `c/tests/flown.h`: a line for each codec that flies.
pub fn flown() -> String {
    let mut text = String::from(
        "/* The codecs that fly, as the catalogue flies them. Written by `cargo xtask write c`. */\n",
    );
    // In two halves, for a flash that has no room for more.
    for (sample, half) in SAMPLES.into_iter().flat_map(|sample| [(sample, 0), (sample, 1)]) {
        let suffix = sample.1;
        let _ = writeln!(text, "#if defined(FLY_{suffix}) && (!defined(HALF) || (HALF == {half}))");
        let own: Vec<_> = all().filter(|(.., own)| *own == sample).collect();
        let (first, second) = own.split_at(own.len() / 2);
        for (_, codec, shape, _) in [first, second][half] {
            let name = name(codec, shape, suffix);
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

/// Each codec in its first shape, in each sample type.
fn all()
-> impl Iterator<Item = (&'static Info, &'static InC, &'static [usize], (&'static str, &'static str))>
{
    IN_C.iter().flat_map(|(info, codecs)| codecs.iter().map(move |codec| (*info, codec))).flat_map(
        |(info, codec)| {
            let shapes =
                codec.shapes.iter().flat_map(|shape| SAMPLES.map(|sample| (*shape, sample)));
            shapes.map(move |(shape, sample)| (info, codec, shape, sample))
        },
    )
}

/// `threshold_hough_15_f32`.
fn name(codec: &InC, shape: &[usize], suffix: &str) -> String {
    let shape: String = shape.iter().map(|number| format!("_{number}")).collect();
    format!("{}{shape}_{suffix}", codec.name)
}

/// With the shape's numbers and the sample type in their places.
fn filled(text: &str, shape: &[usize], sample: &str) -> String {
    let mut text = text.to_owned();
    for (place, number) in shape.iter().enumerate() {
        text = text.replace(&format!("{{{place}}}"), &number.to_string());
    }
    let word = |c: char| c.is_alphanumeric() || c == '_';
    // `S` as a word of its own.
    let mut filled = String::new();
    let mut rest = text.as_str();
    while let Some(at) = rest.find('S') {
        let (before, after) = (&rest[..at], &rest[at + 1..]);
        filled += before;
        let is_word = !before.ends_with(word) && !after.starts_with(word);
        filled += if is_word { sample } else { "S" };
        rest = after;
    }
    filled + rest
}

/// The arguments of an initialisation on the flight, as C writes them.
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
    fn shapes_and_samples_take_their_places() {
        assert_eq!(
            filled("rate::Slots<S, {0}, {1}>", &[15, 10], "f32"),
            "rate::Slots<f32, 15, 10>"
        );
        assert_eq!(filled("rate::Shape", &[], "f32"), "rate::Shape");
        assert_eq!(filled("[S; {0}]", &[9], "i16"), "[i16; 9]");
    }

    /// What the recording flies in Rust, C has, but for what draws from a generator.
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
