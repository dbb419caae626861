//! Formats the figures as tables.

use super::stack::Stack;
use super::{
    events,
    figures::{CORES, ENERGY, Row, between_whole, bounds, cell, decimal, whole_bounds},
    measured::Measured,
    slower,
};
use crate::common::paths;
use crate::figures::markdown;
use crate::programs::{boards::Board, image};
use anyhow::{Context, Result};
use std::fs;

/// Place of the tables: the file, and the marker around them.
const CODECS: (&str, &str) = ("docs/costs.md", "bench-target");
const EVENTS: (&str, &str) = ("docs/costs.md", "bench-target events");
const SLOWER: (&str, &str) = ("docs/costs.md", "bench-target slower");
const STACK: (&str, &str) = ("docs/costs.md", "bench-target stack");
const BRIEF: (&str, &str) = ("README.md", "bench-target brief");

/// Files with every figure, of which the page shows a few.
const CODECS_CSV: &str = "docs/costs.csv";
const EVENTS_CSV: &str = "docs/costs-events.csv";
const SLOWER_CSV: &str = "docs/costs-bounds.csv";
const STACKS_CSV: &str = "docs/costs-stack.csv";

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

/// The rows of the paper's signal on a core of the tables, in its sample type: `f32` for cores with a floating-point unit,
/// fixed point for cores without.
fn of_core<'a>(rows: &'a [Row], core: &'a str) -> impl Iterator<Item = Line<'a>> {
    let sample = if core == CORES[0] { "f32" } else { "q16.16" };
    lines(rows).filter(move |Line { encode, .. }| {
        (encode.core, encode.sample.as_str(), encode.signal.as_str()) == (core, sample, "paper")
    })
}

/// The codecs on the page.
const SHOWN: [&str; 16] = [
    "tbr",
    "mw-5",
    "sf",
    "sod-4",
    "asf",
    "bsa-24",
    "hsa-15",
    "t-hsa-15",
    "if",
    "sigma-delta",
    "position-20",
    "grf-20",
    "grf-slots-15x10",
    "ttfs-16",
    "weighted-phase-8",
    "burst-5",
];

/// Formats the cycles of the usual codecs on both cores.
fn codecs(rows: &[Row]) -> String {
    let [first, second] = CORES;
    let mut text = format!(
        "\n| scheme | {first}: many a call | one a call | worst | decode | {second}: one a call | decode | RAM |\n\
         |---|---:|---:|---:|---:|---:|---:|---:|\n"
    );
    let shown = |line: &Line<'_>| SHOWN.contains(&line.encode.codec.as_str());
    for Line { encode, encode_sample, decode, .. } in of_core(rows, first).filter(shown) {
        let other = of_core(rows, second).find(|line| line.encode.codec == encode.codec);
        let (in_fixed_point, decoded) = other
            .map_or((None, None), |line| (line.encode_sample.cycles_mean, line.decode.cycles_mean));
        text += &format!(
            "| {} | {} | {} | {} | {} | {} | {} | {} |\n",
            name(&encode.codec),
            cell(encode.cycles_mean),
            cell(encode_sample.cycles_mean),
            encode_sample.cycles_max.map_or("–".into(), between_whole),
            cell(decode.cycles_mean),
            cell(in_fixed_point),
            cell(decoded),
            encode.state_bytes,
        );
    }
    text + "\n"
}

/// Formats every figure of each codec on both cores as CSV.
fn codecs_csv(rows: &[Row]) -> String {
    let mut text = String::from(
        "core,sample,scheme,\
         encode_slice_instructions,encode_slice_cycles_least,encode_slice_cycles_most,encode_slice_nj,\
         in_c_instructions,in_c_cycles_least,in_c_cycles_most,\
         encode_sample_instructions,encode_sample_cycles_least,encode_sample_cycles_most,\
         worst_sample_instructions,worst_sample_cycles_least,worst_sample_cycles_most,\
         decode_slice_instructions,decode_slice_cycles_least,decode_slice_cycles_most,\
         plain_instructions,plain_ratio,code_slice_bytes,code_sample_bytes,state_bytes,flash_bytes\n",
    );
    for (core, energy) in ENERGY {
        for line in of_core(rows, core) {
            let Line { encode, encode_sample, decode, .. } = &line;
            let nanojoules = encode.cycles_mean.map(|[_, most]| most * energy);
            let ratio = encode.plain_mean.map(|plain| plain / encode.instructions_mean);
            let cells = [
                core.to_owned(),
                encode.sample.clone(),
                encode.codec.clone(),
                decimal(Some(encode.instructions_mean)),
                bounds(encode.cycles_mean),
                decimal(nanojoules),
                decimal(encode.in_c_mean),
                bounds(encode.in_c_cycles_mean),
                decimal(Some(encode_sample.instructions_mean)),
                bounds(encode_sample.cycles_mean),
                encode_sample.instructions_max.to_string(),
                whole_bounds(encode_sample.cycles_max),
                decimal(Some(decode.instructions_mean)),
                bounds(decode.cycles_mean),
                decimal(encode.plain_mean),
                decimal(ratio),
                encode.code_bytes.to_string(),
                encode_sample.code_bytes.to_string(),
                encode.state_bytes.to_string(),
                encode.flash_bytes.to_string(),
            ];
            text += &format!("{}\n", cells.join(","));
        }
    }
    text
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

/// Directions and forms of a codec, in the order of the tables of stacks.
const FORMS: [(&str, &str); 4] =
    [("encode", "sample"), ("encode", "slice"), ("decode", "sample"), ("decode", "slice")];

/// A codec's stacks on one core: the largest bound of all sample types, and the largest depth seen by painting, in the
/// order of `FORMS`.
struct Stacks<'a> {
    codec: &'a str,
    bound: [u32; 4],
    seen: [u32; 4],
}

/// Collects the stacks of a core, codec by codec.
fn stacks<'a>(core: &str, rows: &'a [Row]) -> Vec<Stacks<'a>> {
    let mut stacks: Vec<Stacks<'_>> = Vec::new();
    for row in rows.iter().filter(|row| row.core == core) {
        let form = (row.direction.as_str(), row.form.as_str());
        let Some(form) = FORMS.iter().position(|known| *known == form) else { continue };
        let place = stacks.iter().position(|stacks| stacks.codec == row.codec);
        let place = place.unwrap_or_else(|| {
            stacks.push(Stacks { codec: &row.codec, bound: [0; 4], seen: [0; 4] });
            stacks.len() - 1
        });
        let Stacks { bound, seen, .. } = &mut stacks[place];
        bound[form] = bound[form].max(row.stack_bound_bytes.unwrap_or(u32::MAX));
        seen[form] = seen[form].max(row.stack_bytes);
    }
    stacks
}

/// Formats every stack of a codec as CSV.
fn stacks_csv(rows: &[Row]) -> String {
    let mut text = String::from(
        "core,scheme,encode_sample_bound,encode_sample_seen,encode_slice_bound,encode_slice_seen,\
         decode_sample_bound,decode_sample_seen,decode_slice_bound,decode_slice_seen\n",
    );
    for core in CORES {
        for Stacks { codec, bound, seen } in stacks(core, rows) {
            let pairs: Vec<String> =
                bound.iter().zip(seen).map(|(bound, seen)| format!("{bound},{seen}")).collect();
            text += &format!("{core},{codec},{}\n", pairs.join(","));
        }
    }
    text
}

/// Formats the deepest stack of each form on each core, and of the modules besides the codecs.
fn stack(rows: &[Row]) -> Result<String> {
    let mut text = String::from(
        "\n| core | encode a sample | encode a slice | decode a sample | decode a slice |\n|---|---|---|---|---|\n",
    );
    for core in CORES {
        text += &format!("| {core} |");
        let stacks = stacks(core, rows);
        for form in 0..FORMS.len() {
            // The first of equal ones.
            let deepest = stacks.iter().rev().max_by_key(|stacks| stacks.bound[form]);
            let Some(Stacks { codec, bound, .. }) = deepest else { continue };
            text += &format!(" {} ({}) |", bound[form], name(codec));
        }
        text += "\n";
    }
    // For the usual core alone: this is another image to build.
    let [core, _] = CORES;
    text += &format!("\n| module, {core} | at most | its deepest function |\n|---|---:|---|\n");
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

/// Writes the table of stacks into docs/costs.md, and all of them beside it.
pub fn write_stack(measured: &Measured) -> Result<()> {
    markdown::write(STACK.0, STACK.1, &stack(&measured.rows)?)?;
    write_file(STACKS_CSV, &stacks_csv(&measured.rows))
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
    for ((file, marker), table) in tables(measured)? {
        markdown::write(file, marker, &table)?;
    }
    write_file(CODECS_CSV, &codecs_csv(&measured.rows))?;
    write_file(EVENTS_CSV, &events::csv(&measured.events))?;
    write_file(SLOWER_CSV, &slower::csv(&measured.rows))
}

fn write_file(path: &str, text: &str) -> Result<()> {
    fs::write(paths::root().join(path), text).with_context(|| path.to_owned())?;
    println!("{path} is written.");
    Ok(())
}
