//! Writes docs/bits.csv: spike counts, and a mark for each board whose bits agree.

use crate::{common::paths, figures::names::full_name};
use anyhow::{Context, Result, ensure};
use std::fs;

const FIGURES: &str = "docs/bits.csv";
/// The mark of a board whose bits are the host's.
const AGREES: &str = "=";

/// Formats a row for each scheme and a column for each sample type, from lines such as `sf f32 spikes=2074 …` with
/// their marks. A cell is the host's spike count, followed by one mark if all boards agree, or else by one for each.
pub fn table(flown: &[(String, String)]) -> String {
    let schemes = distinct(flown, 0);
    let samples = distinct(flown, 1);

    let heads = ["scheme"].iter().chain(&samples).map(ToString::to_string);
    let body = schemes.iter().map(|scheme| {
        let cells = samples.iter().map(|sample| {
            let start = format!("{scheme} {sample} spikes=");
            let cell = flown.iter().find_map(|(line, marks)| {
                let spikes = line.strip_prefix(&start)?.split(' ').next()?;
                let do_all_agree = marks.split(' ').all(|mark| mark == AGREES);
                Some(format!("{spikes} {}", if do_all_agree { AGREES } else { marks }))
            });
            cell.unwrap_or_default()
        });
        row([full_name(scheme).to_owned()].into_iter().chain(cells).collect())
    });
    [row(heads.collect())].into_iter().chain(body).collect()
}

fn row(cells: Vec<String>) -> String {
    cells.into_iter().map(quoted).collect::<Vec<_>>().join(",") + "\n"
}

/// Quotes a cell with a comma.
fn quoted(cell: String) -> String {
    if cell.contains(',') { format!("\"{cell}\"") } else { cell }
}

/// Writes the table into its file.
pub fn write(table: &str) -> Result<()> {
    fs::write(paths::root().join(FIGURES), table).context(FIGURES)?;
    println!("{FIGURES} is written.");
    Ok(())
}

/// Fails if the file has another table.
pub fn ensure_written(table: &str) -> Result<()> {
    let written = fs::read_to_string(paths::root().join(FIGURES)).context(FIGURES)?;
    ensure!(
        written == table,
        "{FIGURES} has other figures; `cargo xtask write bits` writes these:\n{table}"
    );
    Ok(())
}

/// Returns the words at one position of the lines, each once.
fn distinct(flown: &[(String, String)], place: usize) -> Vec<&str> {
    let mut words = Vec::new();
    for word in flown.iter().filter_map(|(line, _)| line.split(' ').nth(place)) {
        if !words.contains(&word) {
            words.push(word);
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn schemes_in_rows_and_samples_in_columns() {
        let lines = [
            ("sf f32 spikes=7 x", "= ="),
            ("hsa f32 spikes=8 x", "= DIFF"),
            ("sf i16 spikes=9 x", "= ="),
            ("hsa i16 spikes=10 x", "= ="),
        ];
        let flown = lines.map(|(line, marks)| (line.to_owned(), marks.to_owned()));
        let expected = "\
            scheme,f32,i16\n\
            step forward (SF),7 =,9 =\n\
            Hough spiker (HSA),8 = DIFF,10 =\n";
        assert_eq!(table(&flown), expected);
    }
}
