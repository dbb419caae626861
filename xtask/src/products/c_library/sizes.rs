//! Measures the table of sizes in the library's README: the header's constants, and what each codec adds to a program.

use super::{archive, compiler, declared, include};
use crate::common::shell;
use crate::figures::markdown;
use crate::programs::boards::Board;
use anyhow::{Context, Result};
use std::{fmt::Write, fs};

const PAGE: &str = "bindings/c/README.md";
const MARKER: &str = "sizes";

/// Writes the table into the README.
pub fn write() -> Result<()> {
    markdown::write(PAGE, MARKER, &format!("\n{}\n", table()?))
}

/// Formats a row for each codec in `f32`, with its `int16_t` variant beside it.
fn table() -> Result<String> {
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
    let mut table = String::from(
        "| codec | parameters | encoder | decoder | code, a sample | flash, Cortex-M4F |\n|---|---|---|---|---|---|\n",
    );
    let mut last = String::new();
    for line in flown.lines().filter(|line| line.starts_with("FLY(") && line.contains("_f32,")) {
        let words: Vec<&str> = line.trim_start_matches("FLY(").split(", ").collect();
        let (name, init) = (words[0].trim_end_matches("_f32"), words[4]);
        if name == last {
            continue;
        }
        name.clone_into(&mut last);
        let header = fs::read_to_string(include()?.join(format!("spikewire/{name}.h")))?;
        let pair = |part: &str, more: usize| -> Result<String> {
            let of = |sample: &str| {
                size(&header, &format!("{name}_{sample}{part}"))
                    .map(|own| (own + more).next_multiple_of(4))
            };
            Ok(format!("{}, {}", of("f32")?, of("i16")?))
        };
        let mut flash = Vec::new();
        for sample in ["f32", "i16"] {
            let defined = [format!("CODEC={name}_{sample}"), format!("MAKE={init}")];
            flash.push((text(&[&defined[0], &defined[1]])? - nothing).to_string());
        }
        let code = size(&header, &format!("{name}_f32_code")).unwrap_or(1);
        let _ = writeln!(
            table,
            "| `{name}` | {} | {} | {} | {code} | {} |",
            pair("", 0)?,
            pair("_encoder_state", 4)?,
            pair("_decoder_state", 4)?,
            flash.join(", ")
        );
    }
    Ok(table)
}

/// Returns the value of a size's macro.
fn size(header: &str, name: &str) -> Result<usize> {
    let start = format!("#define SW_{}_SIZE ", name.to_uppercase());
    let line = header.lines().find_map(|line| line.strip_prefix(&start));
    line.and_then(|size| size.strip_suffix('u')?.parse().ok()).with_context(|| start.clone())
}
