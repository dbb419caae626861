//! Prints every number in every message of a log. Each line is a message: its topic, its time in µs, then
//! `field=number` for each number.
//!
//! `cargo run --example numbers -- flight.bin`

use flight_logs::definition::Path as Field;
use flight_logs::{Damage, Kind, microseconds, open};
use std::error::Error;
use std::io::{BufWriter, Write, stdout};
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).ok_or("a log must be named")?;
    let path = Path::new(&file);
    let kind = Kind::of(path)?.ok_or("no log")?;
    let mut log = open(path, kind, Damage::Skip)?;
    let mut output = BufWriter::new(stdout().lock());
    let mut fields: Vec<Vec<(String, Field)>> = Vec::new();
    while let Some(entry) = log.next()? {
        for topic in &log.topics()[fields.len()..] {
            let names = topic
                .definition
                .as_ref()
                .map_or_else(|_| Vec::new(), |definition| definition.names().0);
            let all = names.iter().flat_map(|name| expanded(name));
            let found = all.filter_map(|name| {
                let field = topic.definition.as_ref().ok()?.number(&name).ok()?;
                Some((name, field))
            });
            fields.push(found.collect());
        }
        let topic = &log.topics()[entry.topic];
        write!(output, "{} {}", topic.name, microseconds(entry.time))?;
        for (name, field) in &fields[entry.topic] {
            if let Ok(Some(number)) = topic.number(field, log.message()) {
                write!(output, " {name}={number:?}")?;
            }
        }
        writeln!(output)?;
    }
    output.flush()?;
    for note in log.faults().notes() {
        eprintln!("{note}");
    }
    Ok(())
}

/// Expands the name of an array, `few[0..3]`, to the names of its items, `few[0]` to `few[2]`. Returns any other name
/// alone.
fn expanded(name: &str) -> Vec<String> {
    let array = || {
        let (stem, rest) = name.split_once("[0..")?;
        let (count, behind) = rest.split_once(']')?;
        let count: usize = count.parse().ok()?;
        Some((0..count).map(|index| format!("{stem}[{index}]{behind}")).collect())
    };
    array().unwrap_or_else(|| vec![name.to_owned()])
}
