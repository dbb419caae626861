//! Formats the figures as tables.

use super::stack::Stack;
use super::{
    events,
    figures::{CORES, ENERGY, Row, between_whole, cell},
    measured::Measured,
    slower,
};
use crate::figures::markdown;
use crate::programs::{boards::Board, image};
use anyhow::Result;

/// Place of the tables: the file, and the marker around them.
const CODECS: (&str, &str) = ("docs/costs.md", "bench-target");
const EVENTS: (&str, &str) = ("docs/costs.md", "bench-target events");
const SLOWER: (&str, &str) = ("docs/costs.md", "bench-target slower");
const BRIEF: (&str, &str) = ("README.md", "bench-target brief");

/// Codecs of the short table, by the types that its rows name.
const FEW: [(&str, &str); 5] = [
    ("`StepForward`", "sf"),
    ("`SendOnDelta`", "sod-4"),
    ("`TemporalContrast`", "tbr"),
    ("`Position`", "position-20"),
    ("`WeightedPhase`", "weighted-phase-8"),
];

/// The content of a table's line: one codec, in one sample type, on one core and signal.
struct Line<'a> {
    encode: &'a Row,
    encode_sample: &'a Row,
    decode: &'a Row,
    decode_sample: &'a Row,
}

/// Groups each codec's rows to a line, in the order in which they were measured.
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
    /// Returns the plain transcription's mean, and its ratio to this codec's.
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

/// Formats all figures as text. Instructions are those of a sample; memory is in bytes.
pub fn text(rows: &[Row]) -> String {
    let mut text = String::new();
    let mut table = String::new();
    for line in lines(rows) {
        let Line { encode, encode_sample, decode, decode_sample } = &line;
        let title = format!("{}, {} signal, {}", encode.core, encode.signal, encode.sample);
        if title != table {
            text += &format!(
                "\n{title:18} {:>8} {:>15} {:>8} {:>15} {:>6} {:>8} {:>8} {:>6} {:>9} {:>6} {:>6} {:>8} {:>6} {:>5} {:>5} {:>5}\n",
                "encode",
                "cycles",
                "1 sample",
                "cycles",
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
            "{:24} {:>8.1} {:>15} {:>8.1} {:>15} {:>6} {:>8.1} {:>8.1} {:>6} {:>9} {:>6} {:>6} {:>8} {:>6} {:>5} {:>5} {:>5}\n",
            encode.codec,
            encode.instructions_mean,
            cell(encode.cycles_mean),
            encode_sample.instructions_mean,
            cell(encode_sample.cycles_mean),
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

/// Formats the tables of docs/costs.md.
pub fn markdown(measured: &Measured) -> Result<String> {
    let tables = tables(measured)?.into_iter().filter(|((page, _), _)| *page == CODECS.0);
    Ok(tables.map(|(_, table)| table).collect())
}

/// Formats the tables of what was measured, each with its place.
fn tables(Measured { rows, events, .. }: &Measured) -> Result<Vec<((&str, &str), String)>> {
    let mut tables = vec![(EVENTS, events::markdown(events)?)];
    if !rows.is_empty() {
        tables.insert(0, (CODECS, codecs(rows)));
        tables.push((SLOWER, slower::markdown(rows)));
        tables.push((BRIEF, brief(rows, &markdown::section(BRIEF.0, BRIEF.1)?)));
    }
    Ok(tables)
}

/// Rewrites the last two columns of the table of a few codecs: the cycles of a sample on the usual core, and the RAM.
fn brief(rows: &[Row], table: &str) -> String {
    let usual = |line: &Line<'_>| {
        (line.encode.core, line.encode.sample.as_str(), line.encode.signal.as_str())
            == (CORES[0], "f32", "paper")
    };
    let anew = |row: &str| {
        let (_, codec) = FEW.into_iter().find(|(name, _)| row.contains(name))?;
        let costs = lines(rows).find(|line| usual(line) && line.encode.codec == codec)?;
        let (cycles, ram) = (cell(costs.encode_sample.cycles_mean), costs.encode.state_bytes);
        let cells: Vec<&str> = row.split(" | ").collect();
        let words = cells.get(..cells.len().checked_sub(2)?)?.join(" | ");
        Some(format!("{words} | {cycles} | {ram} |"))
    };
    table.lines().map(|row| anew(row).unwrap_or_else(|| row.to_owned()) + "\n").collect()
}

/// Formats the codecs: in `f32` for cores with a floating-point unit, in fixed point for cores without.
fn codecs(rows: &[Row]) -> String {
    let mut text = String::new();
    for ((core, energy), sample) in ENERGY.into_iter().zip(["f32", "q16.16"]) {
        text += &format!(
            "\nCortex-{core}, `{sample}`:\n\n\
             | codec | encode slice | cycles | nJ | in C | cycles | encode sample | cycles | worst sample | cycles | decode | cycles | plain | ratio | code slice | code sample | state | flash |\n\
             |---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n"
        );
        for line in lines(rows) {
            let Line { encode, encode_sample, decode, .. } = &line;
            if (encode.core, encode.sample.as_str(), encode.signal.as_str())
                == (core, sample, "paper")
            {
                let (plain, ratio) = line.plain();
                let nanojoules =
                    encode.cycles_mean.map(|[_, most]| format!("{:.1}", most * energy));
                text += &format!(
                    "| {} | {:.1} | {} | {} | {} | {} | {:.1} | {} | {} | {} | {:.1} | {} | {plain} | {ratio} | {} | {} | {} | {} |\n",
                    name(&encode.codec),
                    encode.instructions_mean,
                    cell(encode.cycles_mean),
                    nanojoules.unwrap_or_default(),
                    encode.in_c_mean.map_or("–".into(), |mean| format!("{mean:.1}")),
                    cell(encode.in_c_cycles_mean),
                    encode_sample.instructions_mean,
                    cell(encode_sample.cycles_mean),
                    encode_sample.instructions_max,
                    encode_sample.cycles_max.map_or("–".into(), between_whole),
                    decode.instructions_mean,
                    cell(decode.cycles_mean),
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

/// Modules of the crate besides the codecs, with their paths in an image.
const ROOMS: [(&str, &[&str]); 6] = [
    ("bank and queues", &["spikewire::event::"]),
    ("link", &["spikewire::wire::link::"]),
    ("formats and batches", &["spikewire_cameras::format::", "spikewire::wire::batch::"]),
    ("sinks", &["spikewire::out::"]),
    ("chips", &["spikewire_chips::"]),
    ("cameras", &["spikewire_cameras::frame::"]),
];

/// Formats the stacks of a core: the largest bound of all sample types, and the depth seen by painting.
fn stack(core: &str, measured: &Measured) -> Result<String> {
    let mut codecs: Vec<&str> = Vec::new();
    let rows = || measured.rows.iter().filter(|row| row.core == core);
    for row in rows() {
        if !codecs.contains(&row.codec.as_str()) {
            codecs.push(&row.codec);
        }
    }
    let mut text = String::from(
        "\n| codec | encode sample | encode slice | decode sample | decode slice |\n|---|---:|---:|---:|---:|\n",
    );
    for codec in codecs {
        text += &format!("| {}", name(codec));
        for (direction, form) in
            [("encode", "sample"), ("encode", "slice"), ("decode", "sample"), ("decode", "slice")]
        {
            let of = rows().filter(|row| {
                (row.codec.as_str(), row.direction.as_str(), row.form.as_str())
                    == (codec, direction, form)
            });
            let (bound, seen) = of.fold((0, 0), |(bound, seen): (u32, u32), row| {
                (bound.max(row.stack_bound_bytes.unwrap_or(u32::MAX)), seen.max(row.stack_bytes))
            });
            text += &format!(" | {bound} ({seen})");
        }
        text += " |\n";
    }
    // Of the usual core alone: this is another image to build.
    if core != CORES[0] {
        return Ok(text + "\n");
    }
    text += "\n| everything else | at most | its deepest function |\n|---|---:|---|\n";
    let image = image::build("no-panic", Board::with(core)?)?;
    let image = Stack::read(&image)?;
    for (room, paths) in ROOMS {
        let Some((depth, deepest)) = image.deepest_of(paths)? else {
            text += &format!("| {room} | – | all inlined into their callers |\n");
            continue;
        };
        let waker = if depth.is_blind { " and the program's waker" } else { "" };
        text += &format!("| {room} | {}{waker} | `{}` |\n", depth.bytes, short(deepest));
    }
    Ok(text + "\n")
}

/// Returns a function's path without modules and generic arguments.
fn short(path: &str) -> String {
    let (mut depth, mut plain) = (0, String::new());
    for letter in path.trim_start_matches('<').chars() {
        match letter {
            '<' => depth += 1,
            '>' if depth > 0 => depth -= 1,
            '>' => {}
            _ if depth == 0 => plain.push(letter),
            _ => {}
        }
    }
    let words: Vec<&str> = plain.split("::").filter(|word| !word.is_empty()).collect();
    let word = |word: &str| word.split(" as ").next().unwrap_or_default().to_owned();
    match words[..] {
        [.., kind, method] => format!("{}::{}", word(kind), word(method)),
        _ => plain,
    }
}

fn stack_marker(core: &str) -> String {
    format!("bench-target stack {core}")
}

/// Writes the table of a core's stacks into docs/costs.md.
pub fn write_stack(core: &str, measured: &Measured) -> Result<()> {
    markdown::write(CODECS.0, &stack_marker(core), &stack(core, measured)?)
}

/// Returns the codec's name in the tables.
fn name(codec: &str) -> &str {
    match codec {
        "tbr" => "TBR",
        "sf" => "SF",
        "sod-4" => "send-on-delta, 4 spikes",
        "weighted-phase-8" => "weighted phase, 8 digits",
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

/// Writes the tables into their files.
pub fn write(measured: &Measured) -> Result<()> {
    tables(measured)?
        .into_iter()
        .try_for_each(|((file, marker), table)| markdown::write(file, marker, &table))
}
