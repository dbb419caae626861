//! Measures the table of sizes in the library's README: the header's constants, and what each codec adds to a program.

use super::{archive, compiler, declared, include};
use crate::common::{paths, shell};
use crate::figures::markdown;
use crate::programs::boards::Board;
use anyhow::{Context, Result};
use std::{fmt::Write, fs};

const PAGE: &str = "bindings/c/README.md";
const MARKER: &str = "sizes";

/// Every size, of which the page shows a few.
const FIGURES: &str = "bindings/c/sizes.csv";
/// The codecs on the page.
const SHOWN: [&str; 8] = [
    "temporal_contrast",
    "step_forward",
    "send_on_delta_4",
    "threshold_hough_15",
    "sigma_delta",
    "position_20",
    "slots_15_10",
    "weighted_phase_8",
];

/// Writes the table into the README, and every size beside it.
pub fn write() -> Result<()> {
    let rows = rows()?;
    fs::write(paths::root().join(FIGURES), csv(&rows))?;
    markdown::write(PAGE, MARKER, &table(&rows))
}

/// The sizes of a codec in bytes: each pair in `f32` and in `int16_t`.
struct Sizes {
    codec: String,
    parameters: [usize; 2],
    encoder: [usize; 2],
    decoder: [usize; 2],
    code: usize,
    flash: [u32; 2],
}

fn table(rows: &[Sizes]) -> String {
    let mut table = String::from(
        "\n| scheme | parameters | encoder | decoder | code, a sample | flash, Cortex-M4F |\n|---|---|---|---|---|---|\n",
    );
    for Sizes { codec, parameters, encoder, decoder, code, flash } in
        rows.iter().filter(|row| SHOWN.contains(&row.codec.as_str()))
    {
        let [parameters, encoder, decoder] =
            [parameters, encoder, decoder].map(|[floats, counts]| format!("{floats}, {counts}"));
        let [floats, counts] = flash;
        let _ = writeln!(
            table,
            "| `{codec}` | {parameters} | {encoder} | {decoder} | {code} | {floats}, {counts} |"
        );
    }
    table + "\n"
}

fn csv(rows: &[Sizes]) -> String {
    let mut text = String::from(
        "scheme,parameters_f32,parameters_i16,encoder_f32,encoder_i16,decoder_f32,decoder_i16,code,flash_f32,flash_i16\n",
    );
    for Sizes { codec, parameters, encoder, decoder, code, flash } in rows {
        let [parameters, encoder, decoder] =
            [parameters, encoder, decoder].map(|[floats, counts]| format!("{floats},{counts}"));
        let [floats, counts] = flash;
        let _ = writeln!(text, "{codec},{parameters},{encoder},{decoder},{code},{floats},{counts}");
    }
    text
}

/// Measures each codec in `f32`, with its `int16_t` variant beside it.
fn rows() -> Result<Vec<Sizes>> {
    let board = Board::with("M4F")?;
    let archive = archive(board)?;
    let text = |defined: &[&str]| -> Result<u32> {
        let program = compiler::for_board("size", board, &archive, defined)?;
        let printed = shell::output(shell::command("arm-none-eabi-size").arg(program))?;
        let text = printed.lines().nth(1).and_then(|line| line.split_whitespace().next());
        Ok(text.context("arm-none-eabi-size prints no text")?.parse()?)
    };
    let nothing = text(&[])?;
    let flown = declared::flown();
    let mut rows: Vec<Sizes> = Vec::new();
    for line in flown.lines().filter(|line| line.starts_with("FLY(") && line.contains("_f32,")) {
        let words: Vec<&str> = line.trim_start_matches("FLY(").split(", ").collect();
        let (name, init) = (words[0].trim_end_matches("_f32"), words[4]);
        if rows.last().is_some_and(|last| last.codec == name) {
            continue;
        }
        let header = fs::read_to_string(include()?.join(format!("spikewire/{name}.h")))?;
        let pair = |part: &str, more: usize| -> Result<[usize; 2]> {
            let padded = |sample: &str| {
                size(&header, &format!("{name}_{sample}{part}"))
                    .map(|own| (own + more).next_multiple_of(4))
            };
            Ok([padded("f32")?, padded("i16")?])
        };
        let flash = |sample: &str| {
            let defined = [format!("CODEC={name}_{sample}"), format!("MAKE={init}")];
            anyhow::Ok(text(&[&defined[0], &defined[1]])? - nothing)
        };
        rows.push(Sizes {
            codec: name.to_owned(),
            parameters: pair("", 0)?,
            encoder: pair("_encoder_state", 4)?,
            decoder: pair("_decoder_state", 4)?,
            code: size(&header, &format!("{name}_f32_code")).unwrap_or(1),
            flash: [flash("f32")?, flash("i16")?],
        });
    }
    Ok(rows)
}

/// Returns the value of a size's macro.
fn size(header: &str, name: &str) -> Result<usize> {
    let start = format!("#define SW_{}_SIZE ", name.to_uppercase());
    let line = header.lines().find_map(|line| line.strip_prefix(&start));
    line.and_then(|size| size.strip_suffix('u')?.parse().ok()).with_context(|| start.clone())
}
