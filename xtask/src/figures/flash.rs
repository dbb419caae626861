//! Measures the flash that one codec takes when linked.

use super::markdown;
use crate::{
    programs::{boards::Board, image, size},
    setup::needs,
};
use anyhow::{Result, ensure};
use std::fmt::Write;

const CORES: [&str; 2] = ["M4F", "M0"];
const CALLS: [&str; 2] = ["sample", "slice"];

/// The paper's codes, and the promised maximum for encoder and decoder by samples, if there is one.
const CODECS: [(&str, Option<u32>); 7] = [
    ("TBR", None),
    ("MW, W = 5", None),
    ("SF", Some(600)),
    ("BSA, 24 taps", None),
    ("HSA, 15 taps", Some(3 * 1024)),
    ("T-HSA, 15 taps", None),
    ("GRF, 20 neurons", None),
];

const PAGE: &str = "docs/costs.md";
const MARKER: &str = "flash";

pub fn write() -> Result<()> {
    needs::ensure_met()?;
    markdown::write(PAGE, MARKER, &table()?)
}

/// Fails if a codec takes more than promised, or if the documentation has other figures.
pub fn verify() -> Result<()> {
    markdown::ensure_written(PAGE, MARKER, &table()?, "cargo xtask write flash")
}

/// Formats a row for each codec.
fn table() -> Result<String> {
    let mut table =
        "\n| scheme, both ways | M4F, by samples | by slices | M0, by samples | by slices |\n\
         |---|---:|---:|---:|---:|\n"
            .to_owned();
    let linked = |board: &Board, codec: &str| {
        size::flash(&image::build_with("flash", board, &[("CODEC", codec)])?)
    };
    let mut cores = Vec::new();
    for core in CORES {
        let board = Board::with(core)?;
        cores.push((board, linked(board, "")?));
    }
    for (codec, most) in CODECS {
        write!(table, "| {codec} |")?;
        for (board, empty) in &cores {
            for calls in CALLS {
                let bytes = linked(board, &format!("{calls}/{codec}"))? - empty;
                ensure!(bytes > 0, "{codec} is not linked");
                ensure!(
                    calls != "sample" || most.is_none_or(|most| bytes <= most),
                    "{}: {codec} takes {bytes} bytes by samples, where {most:?} are promised",
                    board.core
                );
                write!(table, " {bytes} |")?;
            }
        }
        table.push('\n');
    }
    table.push('\n');
    Ok(table)
}
