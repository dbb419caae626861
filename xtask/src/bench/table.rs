//! The figures as tables to read.

use super::{Measured, Row, events};
use anyhow::{Context, Result};
use std::{fs, path::Path};

/// The cores of the README's tables.
pub const CORES: [&str; 2] = ["M4F", "M0"];

/// Between which comments a file has the tables.
const CODECS: &str = "bench-target";
const EVENTS: &str = "bench-target events";

/// What a line of a table tells: one codec, in one sample type, on one core and signal.
struct Line<'a> {
    encode: &'a Row,
    encode_sample: &'a Row,
    decode: &'a Row,
    decode_sample: &'a Row,
}

/// Each codec's rows as one line, in the order that they were measured in.
fn lines(rows: &[Row]) -> impl Iterator<Item = Line<'_>> {
    let of = |one: &Row, direction, form| {
        rows.iter().find(|row| {
            (row.core, &row.signal, &row.codec, &row.sample)
                == (one.core, &one.signal, &one.codec, &one.sample)
                && (row.direction.as_str(), row.form.as_str()) == (direction, form)
        })
    };
    rows.iter().filter(|row| row.direction == "encode" && row.form == "slice").filter_map(
        move |encode| {
            Some(Line {
                encode,
                encode_sample: of(encode, "encode", "sample")?,
                decode: of(encode, "decode", "slice")?,
                decode_sample: of(encode, "decode", "sample")?,
            })
        },
    )
}

impl Line<'_> {
    /// The plain transcription's mean, and how many times this codec's it is.
    fn plain(&self) -> (String, String) {
        match self.encode.plain_mean {
            Some(plain) => {
                let ratio = plain / self.encode.instructions_mean;
                (format!("{plain:.1}"), format!("{ratio:.1}"))
            }
            None => ("–".into(), "–".into()),
        }
    }
}

/// Every figure. Instructions are those of a sample, memory is in bytes.
pub fn text(rows: &[Row]) -> String {
    let mut text = String::new();
    let mut table = String::new();
    for line in lines(rows) {
        let Line { encode, encode_sample, decode, decode_sample } = &line;
        let title = format!("{}, {} signal, {}", encode.core, encode.signal, encode.sample);
        if title != table {
            text += &format!(
                "\n{title:18} {:>8} {:>8} {:>6} {:>8} {:>8} {:>6} {:>9} {:>6} {:>6} {:>8} {:>6} {:>5} {:>5} {:>5}\n",
                "encode",
                "1 sample",
                "worst",
                "decode",
                "1 sample",
                "worst",
                "plain",
                "ratio",
                "code",
                "1 sample",
                "decode",
                "state",
                "flash",
                "stack",
            );
            table = title;
        }
        let (plain, ratio) = line.plain();
        text += &format!(
            "{:24} {:>8.1} {:>8.1} {:>6} {:>8.1} {:>8.1} {:>6} {:>9} {:>6} {:>6} {:>8} {:>6} {:>5} {:>5} {:>5}\n",
            encode.codec,
            encode.instructions_mean,
            encode_sample.instructions_mean,
            encode_sample.instructions_max,
            decode.instructions_mean,
            decode_sample.instructions_mean,
            decode_sample.instructions_max,
            plain,
            ratio,
            encode.code_bytes,
            encode_sample.code_bytes,
            decode.code_bytes,
            encode.state_bytes,
            encode.flash_bytes,
            encode.stack_bytes.max(decode.stack_bytes),
        );
    }
    text
}

/// The README's tables.
pub fn markdown(measured: &Measured) -> Result<String> {
    Ok(tables(measured)?.into_iter().map(|(_, table)| table).collect())
}

/// Those of what was measured, each with its marker.
fn tables(Measured { rows, events, .. }: &Measured) -> Result<Vec<(&'static str, String)>> {
    let codecs = (!rows.is_empty()).then(|| (CODECS, codecs(rows)));
    Ok(codecs.into_iter().chain([(EVENTS, events::markdown(events)?)]).collect())
}

/// `f32` where there is a floating-point unit, fixed point where there is none.
fn codecs(rows: &[Row]) -> String {
    let mut text = String::new();
    for (core, sample) in CORES.into_iter().zip(["f32", "q16.16"]) {
        text += &format!(
            "\nCortex-{core}, `{sample}`:\n\n\
             | codec | encode slice | encode sample | worst sample | decode | plain | ratio | code slice | code sample | state | flash |\n\
             |---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n"
        );
        for line in lines(rows) {
            let Line { encode, encode_sample, decode, .. } = &line;
            if (encode.core, encode.sample.as_str(), encode.signal.as_str())
                == (core, sample, "paper")
            {
                let (plain, ratio) = line.plain();
                text += &format!(
                    "| {} | {:.1} | {:.1} | {} | {:.1} | {plain} | {ratio} | {} | {} | {} | {} |\n",
                    name(&encode.codec),
                    encode.instructions_mean,
                    encode_sample.instructions_mean,
                    encode_sample.instructions_max,
                    decode.instructions_mean,
                    encode.code_bytes,
                    encode_sample.code_bytes,
                    encode.state_bytes,
                    encode.flash_bytes,
                );
            }
        }
    }
    text + "\n"
}

/// The codec as a reader of the README knows it.
fn name(codec: &str) -> &str {
    match codec {
        "tbr" => "TBR",
        "sf" => "SF",
        "mw-5" => "MW, W = 5",
        "mw-63" => "MW, W = 63",
        "hsa-15" => "HSA, 15 taps",
        "t-hsa-15" => "T-HSA, 15 taps",
        "bsa-24" => "BSA, 24 taps",
        "bsa-24-busy" => "BSA, 24 taps, spiking nearly always",
        "bsa-toolbox-9" => "BSA as in the toolbox, 9 taps",
        "position-20" => "position, 20 neurons",
        "grf-20" => "GRF, 20 neurons",
        "grf-slots-15x10" => "GRF, 15 neurons, 10 slots",
        "grf-random-15x16" => "GRF, 15 neurons, by chance",
        other => other,
    }
}

/// Puts the tables between the file's markers.
pub fn write(measured: &Measured, path: &Path) -> Result<()> {
    let mut file = fs::read_to_string(path).with_context(|| path.display().to_string())?;
    for (marker, table) in tables(measured)? {
        file = between(&file, marker, &table)?;
    }
    fs::write(path, file)?;
    println!("{} has the tables.", path.display());
    Ok(())
}

fn between(file: &str, marker: &str, table: &str) -> Result<String> {
    let (start, end) = (format!("<!-- {marker} -->\n"), format!("<!-- /{marker} -->"));
    let missing = || format!("no `{}` … `{end}`", start.trim_end());
    let (before, rest) = file.split_once(&start).with_context(missing)?;
    let (_, after) = rest.split_once(&end).with_context(missing)?;
    Ok(format!("{before}{start}{table}{end}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_between_the_markers_changes() {
        let file = "a\n<!-- x -->\nold\n<!-- /x -->\nb\n<!-- x y -->\n<!-- /x y -->\n";
        let new = "a\n<!-- x -->\nnew\n<!-- /x -->\nb\n<!-- x y -->\n<!-- /x y -->\n";
        assert_eq!(between(file, "x", "new\n").unwrap(), new);
        assert!(between("a", "x", "new\n").is_err());
    }
}
