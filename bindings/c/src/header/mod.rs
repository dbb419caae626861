//! Writes the header. Not by cbindgen: the functions come out of a macro, which it does not expand without a nightly
//! compiler, and sizes it does not know at all.

use std::fmt::Write;

use spikewire::link::{MAX_FRAME, Transmitter};

use crate::argument::{CSample, Declared, Number};
use crate::calibration::Calibrating;
use crate::describe::{Constructor, Description, Layout};
use crate::link::CReader;
use crate::{Flight, Kept, Queue, Status};

/// Bytes of a reader's storage on any machine.
const READER: usize = 512;
const _: () = assert!(size_of::<Kept<CReader>>() <= READER);
const _: () = assert!(size_of::<Kept<Queue>>() == 6 * size_of::<usize>());

/// What all codecs share: `spikewire.h`.
pub fn core() -> String {
    let writer = Layout::of::<Kept<Transmitter>>();
    let calibrations = [
        calibration::<f32>(),
        calibration::<i16>(),
        calibration::<fixed::types::I8F8>(),
        calibration::<fixed::types::I16F16>(),
    ];
    let part = |text: &str| text.parse::<u32>().unwrap_or_default();
    let number = 10_000 * part(env!("CARGO_PKG_VERSION_MAJOR"))
        + 100 * part(env!("CARGO_PKG_VERSION_MINOR"))
        + part(env!("CARGO_PKG_VERSION_PATCH"));
    include_str!("core.h")
        .replace("@VERSION@", env!("CARGO_PKG_VERSION"))
        .replace("@VERSION_NUMBER@", &number.to_string())
        .replace("@STATUSES@", &statuses())
        .replace("@MAX_FRAME@", &MAX_FRAME.to_string())
        .replace("@WRITER_SIZE@", &writer.size.to_string())
        .replace("@WRITER_ALIGN@", &writer.align.to_string())
        .replace("@WRITER_BITS@", &(8 * writer.align).to_string())
        .replace("@READER_SIZE@", &READER.to_string())
        .replace("@CALIBRATIONS@", &calibrations.concat())
}

fn statuses() -> String {
    let line = |(name, number, text): &(&str, i32, &std::ffi::CStr)| {
        format!("#define SW_{name} ((sw_status){number}) /* {} */\n", text.to_string_lossy())
    };
    Status::ALL.iter().map(line).collect()
}

fn calibration<S: CSample>() -> String {
    let (suffix, sample) = (S::SUFFIX, <S as Number>::TYPE);
    let Layout { size, align } = Layout::of::<Calibrating<S>>();
    let (bits, upper) = (8 * align, suffix.to_uppercase());
    format!(
        "#define SW_CALIBRATION_{upper}_SIZE {size}u\n\
         typedef struct sw_calibration_{suffix} {{\n    \
             uint{bits}_t storage[SW_CALIBRATION_{upper}_SIZE / {align}u];\n\
         }} sw_calibration_{suffix};\n\
         sw_status sw_calibration_{suffix}_init(sw_calibration_{suffix} *calibration);\n\
         sw_status sw_calibration_{suffix}_observe(sw_calibration_{suffix} *calibration, const {sample} *samples, size_t count);\n\
         sw_status sw_calibration_{suffix}_range(const sw_calibration_{suffix} *calibration, {sample} *min, {sample} *max);\n\
         sw_status sw_calibration_{suffix}_threshold(const sw_calibration_{suffix} *calibration, float factor, uint8_t of_magnitudes, {sample} *threshold);\n\
         sw_status sw_calibration_{suffix}_counts(const sw_calibration_{suffix} *calibration, sw_calibration_counts *counts);\n\n"
    )
}

/// A header of codecs, by its name without the ending.
pub fn file(name: &str, codecs: &[Description]) -> String {
    let guard = format!("SPIKEWIRE_{}_H", name.to_uppercase());
    let mut said = String::new();
    let mut declared = String::new();
    for described in codecs {
        // Once for all sample types.
        let words = words(described);
        if words != said {
            declared += &words;
            said = words;
        }
        declared += &codec(described);
    }
    format!(
        "/* Written from the catalogue of spikewire; spikewire.h says what the functions do. */\n\
         #ifndef {guard}\n#define {guard}\n\n#include \"spikewire.h\"\n\n\
         #if defined(__cplusplus)\nextern \"C\" {{\n#endif\n\n\
         {declared}\
         #if defined(__cplusplus)\n}}\n#endif\n\n#endif\n"
    )
}

/// The header of a flight.
pub fn flight(flight: &Flight) -> String {
    let Flight { name, sample, names, counts, period, keyframe_every, bank, receiver } = flight;
    let list = |items: Vec<String>| items.join(", ");
    let (names, counts) = (
        list(names.iter().map(|name| literal(name)).collect()),
        list(counts.iter().map(|own| format!("{own:?}")).collect()),
    );
    let words = |layout: &Layout| layout.size.div_ceil(8).to_string();
    include_str!("flight.h")
        .replace("@NAME@", name)
        .replace("@UPPER@", &name.to_uppercase())
        .replace("@SAMPLE@", sample)
        .replace("@CHANNELS@", &flight.names.len().to_string())
        .replace("@PERIOD@", &period.to_string())
        .replace("@KEYFRAME_EVERY@", &keyframe_every.to_string())
        .replace("@BANK@", &words(bank))
        .replace("@RECEIVER@", &words(receiver))
        .replace("@NAMES@", &names)
        .replace("@COUNTS@", &counts)
}

/// A string literal in C and C++: letters beyond ASCII byte by byte, as the names of letters differ between versions of
/// the languages; and no `?`, two of which may begin a trigraph.
fn literal(text: &str) -> String {
    let mut literal = String::from("\"");
    for byte in text.bytes() {
        match byte {
            b'"' | b'\\' | b'?' => {
                let _ = write!(literal, "\\{}", char::from(byte));
            }
            b' '..=b'~' => literal.push(char::from(byte)),
            // Three digits, so that no digit after them is taken for one of them.
            byte => {
                let _ = write!(literal, "\\{byte:03o}");
            }
        }
    }
    literal + "\""
}

/// Rust that fails to compile for a target on which an end of a flight needs more storage than its header gives.
pub fn flight_sizes(flights: &[Flight]) -> String {
    let mut text = "//! The header's sizes, checked on each target as it is compiled. Written with the header.\n".to_owned();
    for Flight { name, bank, receiver, .. } in flights {
        for (end, layout) in [("Near", bank), ("Far", receiver)] {
            let _ = write!(
                text,
                "\nconst _: () = assert!(size_of::<crate::flights::{name}::{end}>() <= {});\n\
                 const _: () = assert!(align_of::<crate::flights::{name}::{end}>() <= 8);\n",
                8 * layout.size.div_ceil(8)
            );
        }
    }
    text
}

/// A header that includes others of its directory.
pub fn all<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let mut includes = String::new();
    for name in names {
        let _ = writeln!(includes, "#include \"{name}.h\"");
    }
    format!(
        "/* Every codec. */\n#ifndef SPIKEWIRE_ALL_H\n#define SPIKEWIRE_ALL_H\n\n{includes}\n#endif\n"
    )
}

/// A struct that holds storage of this layout, and the macro of its size.
fn storage(name: &str, pointer: &str, size: &str, layout: Layout) -> String {
    let Layout { size: bytes, align } = layout;
    let bits = 8 * align;
    format!(
        "#define {size} {bytes}u\n\
         typedef struct {name} {{\n{pointer}    uint{bits}_t storage[{size} / {align}u];\n}} {name};\n"
    )
}

/// The comment above a codec.
fn words(Description { words, latency, neurons, slots, .. }: &Description) -> String {
    let words = words.join("\n");
    comment(&format!(
        "{words}\n\nLatency: {latency} samples. Neurons of a channel: {neurons}. Sub-timesteps of a sample: {slots}."
    ))
}

/// The declarations of a codec.
fn codec(codec: &Description) -> String {
    let Description { name, sample, latency, neurons, slots, .. } = codec;
    let upper = name.to_uppercase();
    let mut text = String::new();
    let _ = write!(
        text,
        "\
         #define SW_{upper}_LATENCY {latency}u\n\
         #define SW_{upper}_NEURONS {neurons}u\n\
         #define SW_{upper}_SLOTS {slots}u\n"
    );
    let pointer = format!("    const struct sw_{name} *codec;\n");
    text += &storage(&format!("sw_{name}"), "", &format!("SW_{upper}_SIZE"), codec.codec);
    for (part, layout) in [("encoder", codec.encoder), ("decoder", codec.decoder)] {
        let size = format!("SW_{upper}_{}_STATE_SIZE", part.to_uppercase());
        text += &storage(&format!("sw_{name}_{part}"), &pointer, &size, layout);
    }
    let code = format!("sw_{name}_code");
    if codec.is_byte {
        let _ = writeln!(text, "typedef int8_t {code};");
    } else {
        text += &storage(&code, "", &format!("SW_{upper}_CODE_SIZE"), codec.code);
    }
    let _ = writeln!(
        text,
        "SW_STATIC_ASSERT({name}, sizeof(sw_{name}) == SW_{upper}_SIZE);\n\
         SW_STATIC_ASSERT({name}_code, sizeof({code}) == {}u);",
        codec.code.size
    );
    if codec.constructors.is_empty() {
        let _ = writeln!(
            text,
            "/* Its parameters, in flash. */\nextern const sw_{name} sw_{name}_codec;"
        );
    }
    for init in codec.constructors {
        text += &constructor(name, init);
    }
    let _ = writeln!(text, "SW_CODEC({name}, {sample});");
    text + "\n"
}

/// A comment in lines that a terminal holds; none of no words.
fn comment(text: &str) -> String {
    const WIDTH: usize = 116;
    let mut lines = Vec::new();
    for paragraph in text.lines() {
        let mut line = String::new();
        for word in paragraph.split_whitespace() {
            if !line.is_empty() && line.len() + 1 + word.len() > WIDTH {
                lines.push(std::mem::take(&mut line));
            }
            line += if line.is_empty() { "" } else { " " };
            line += word;
        }
        lines.push(line);
    }
    if lines.is_empty() {
        return String::new();
    }
    format!("/* {} */\n", lines.join("\n * ")).replace("* \n", "*\n")
}

/// A prototype; the arguments each in its line where one is too short for all.
fn prototype(function: &str) -> String {
    let line = format!("sw_status sw_{function};\n");
    if line.len() <= 120 {
        return line;
    }
    line.replacen('(', "(\n    ", 1).replace(", ", ",\n    ")
}

fn constructor(name: &str, init: &Constructor) -> String {
    let text = comment(&init.words.join("\n"));
    let mut function = format!("{name}_{}(sw_{name} *codec", init.name);
    for (argument, declared) in init.arguments {
        let _ = match declared {
            Declared::Number(kind) => write!(function, ", {kind} {argument}"),
            Declared::List(kind, length) => write!(function, ", const {kind} {argument}[{length}]"),
            Declared::Calibration(suffix) => {
                write!(function, ", const sw_calibration_{suffix} *{argument}")
            }
        };
    }
    text + &prototype(&(function + ", sw_error *error)"))
}

/// Rust that fails to compile for a target on which a size differs from the header's. The library's name is `crate` in
/// the library itself.
pub fn sizes<'a>(library: &str, codecs: impl Iterator<Item = &'a [Description]>) -> String {
    let mut text = format!(
        "//! The header's sizes, checked on each target as it is compiled. Written with the header.\n\n\
         #[allow(unused_imports)]\nuse fixed::types::{{I8F8, I16F16}};\n\
         #[allow(unused_imports)]\nuse spikewire::{{population, rate, temporal, timing}};\n\n\
         {library}::sized! {{\n"
    );
    for types in codecs {
        let Some(Description { rust: (scheme, _), .. }) = types.first() else { continue };
        let lines: Vec<String> = types.iter().map(sizes_of).collect();
        let _ = writeln!(text, "    {scheme}: {};", lines.join(", "));
    }
    text + "}\n"
}

/// `f32 => (8, 4) (8, 4) (4, 4) (1, 1)`.
fn sizes_of(codec: &Description) -> String {
    let parts = [codec.codec, codec.encoder, codec.decoder, codec.code];
    let parts = parts.map(|Layout { size, align }| format!("({size}, {align})"));
    format!("{} => {}", codec.rust.1, parts.join(" "))
}

#[cfg(test)]
mod tests {
    use super::{Flight, Layout, core, flight, literal};
    use std::path::Path;
    use std::process::Command;
    use std::{env, fs};

    /// Names that a compiler may take for something else, each with its literal.
    const NAMES: [(&str, &str); 7] = [
        ("gyro_x", r#""gyro_x""#),
        ("e\u{301}1", r#""e\314\2011""#),
        ("a\u{85}b", r#""a\302\205b""#),
        ("\u{202e}x", r#""\342\200\256x""#),
        ("x??/", r#""x\?\?/""#),
        ("a\"\\\n%s", r#""a\"\\\012%s""#),
        ("*/ /* // \u{1f681}", r#""*/ /* // \360\237\232\201""#),
    ];

    const CHANNELS: [&str; NAMES.len()] = {
        let mut channels = [""; NAMES.len()];
        let mut place = 0;
        while place < NAMES.len() {
            channels[place] = NAMES[place].0;
            place += 1;
        }
        channels
    };

    /// Compilers, each with its arguments. All but the first may be missing.
    const COMPILERS: [&[&str]; 4] = [
        &["gcc", "-x", "c", "-std=c99", "-trigraphs"],
        &["clang", "-x", "c", "-std=c99", "-trigraphs"],
        &["g++", "-x", "c++", "-std=c++11", "-trigraphs"],
        &["clang++", "-x", "c++", "-std=c++11", "-trigraphs"],
    ];

    /// Writes each name, and a byte of 0 after it.
    const PROGRAM: &str = "#include \"odd.h\"\n#include <stdio.h>\n\
        static const char *const names[SW_ODD_CHANNELS] = SW_ODD_NAMES;\n\
        int main(void) {\n    unsigned i;\n    for (i = 0; i < SW_ODD_CHANNELS; ++i) {\n        \
        if (printf(\"%s\", names[i]) < 0 || putchar(0) == EOF) {\n            return 1;\n        }\n    }\n    return 0;\n}\n";

    #[test]
    fn names_are_literals_of_c() {
        for (name, written) in NAMES {
            assert_eq!(literal(name), written);
        }
    }

    /// Compilers read the names in a flight's header as they are in its file.
    #[test]
    fn compilers_read_any_name() {
        let directory = env::temp_dir().join(format!("spikewire-c-names-{}", std::process::id()));
        fs::create_dir_all(&directory).unwrap();
        let layout = Layout { size: 8, align: 8 };
        let header = flight(&Flight {
            name: "odd",
            sample: "float",
            names: &CHANNELS,
            counts: &[1.0; NAMES.len()],
            period: 2_000,
            keyframe_every: 10,
            bank: layout,
            receiver: layout,
        });
        for (file, text) in [("odd.h", &*header), ("spikewire.h", &*core()), ("odd.c", PROGRAM)] {
            fs::write(directory.join(file), text).unwrap();
        }
        for (place, arguments) in COMPILERS.into_iter().enumerate() {
            let printed = printed(&directory, arguments);
            assert!(printed.is_some() || place > 0, "{} is not installed", arguments[0]);
            let Some(printed) = printed else {
                println!("{} is not installed", arguments[0]);
                continue;
            };
            let expected: String = NAMES.iter().map(|(name, _)| format!("{name}\0")).collect();
            assert_eq!(String::from_utf8(printed).unwrap(), expected, "{arguments:?}");
        }
        fs::remove_dir_all(directory).unwrap();
    }

    /// Compiles and runs the program; `None` if the compiler is not installed.
    fn printed(directory: &Path, arguments: &[&str]) -> Option<Vec<u8>> {
        let program = directory.join(arguments[0]);
        let mut compiler = Command::new(arguments[0]);
        compiler.args(&arguments[1..]).args(["-Wall", "-Wextra", "-Werror"]);
        compiler.arg(directory.join("odd.c")).arg("-o").arg(&program);
        let compiled = compiler.output().ok()?;
        let words = String::from_utf8_lossy(&compiled.stderr);
        assert!(compiled.status.success(), "{arguments:?}: {words}");
        Some(Command::new(program).output().unwrap().stdout)
    }
}
