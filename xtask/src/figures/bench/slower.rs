//! Two bounds on every codec: 16-bit counts take at most 5 % more than the quicker of `f32` and `q16.16`, in
//! instructions, and slices at most 10 % more than plain C, in cycles. The baseline lists the exceptions.

use super::figures::{CORES, Row};
use std::collections::BTreeMap;

/// How much more a codec takes than what it is compared with, by its name in the baseline.
pub type Shares = BTreeMap<String, f64>;

const COUNTS: (&str, f64) = ("i16", 1.05);
const IN_C: (&str, f64) = ("C", 1.1);

/// How much an exception may grow: rounding to two decimals, and small changes of code.
const GROWN: f64 = 1.02;

/// Returns the shares of all codecs, of both signals the larger.
fn shares(rows: &[Row]) -> Shares {
    let mut shares = Shares::new();
    let mut add = |key, share: f64| {
        let most: &mut f64 = shares.entry(key).or_default();
        *most = most.max((share * 100.0).round() / 100.0);
    };
    for row in rows.iter().filter(|row| CORES.contains(&row.core)) {
        let Row { core, codec, direction, form, sample, signal, .. } = row;
        if let (Some([_, cycles]), Some([_, in_c])) = (row.cycles_mean, row.in_c_cycles_mean)
            && form == "slice"
        {
            add(format!("{} {core} {sample} {codec}", IN_C.0), cycles / in_c);
        }
        if sample != COUNTS.0 {
            continue;
        }
        let wider = rows.iter().filter(|other| {
            (other.core, &other.codec, &other.direction, &other.form, &other.signal)
                == (*core, codec, direction, form, signal)
                && ["f32", "q16.16"].contains(&other.sample.as_str())
        });
        if let Some(quicker) = wider.map(|other| other.instructions_mean).reduce(f64::min) {
            let key = format!("{} {core} {direction} {form} {codec}", COUNTS.0);
            add(key, row.instructions_mean / quicker);
        }
    }
    shares
}

/// Returns whether a share is one of plain C.
pub fn is_in_c(key: &str) -> bool {
    !key.starts_with(COUNTS.0)
}

fn most(key: &str) -> f64 {
    if is_in_c(key) { IN_C.1 } else { COUNTS.1 }
}

/// Returns the shares above their bound.
pub fn exceptions(rows: &[Row]) -> Shares {
    let mut shares = shares(rows);
    shares.retain(|key, share| *share > most(key));
    shares
}

/// Prints every share above its bound that is no exception, or a larger one, and every exception that is gone; returns
/// their names. Prints smaller exceptions, too.
pub fn unlisted(rows: &[Row], listed: &Shares) -> Vec<String> {
    let shares = shares(rows);
    let mut found = Vec::new();
    for (key, share) in &shares {
        let most = listed.get(key).map_or(most(key), |share| share * GROWN);
        if *share > most {
            println!("{key}: {share:.2} times, where {most:.2} is allowed");
            found.push(key.clone());
        }
    }
    for (key, listed) in listed {
        match shares.get(key) {
            Some(share) if share * GROWN < *listed => {
                println!("{key}: {listed:.2} times, now {share:.2}: less");
            }
            Some(_) => {}
            None => {
                println!("{key}: {listed:.2} times, gone");
                found.push(key.clone());
            }
        }
    }
    found
}

/// An exception by the parts of its name.
struct Exception {
    /// What the codec is compared with.
    against: &'static str,
    /// Core and form, or core and sample type.
    place: String,
    codec: String,
    share: f64,
}

fn parsed(rows: &[Row]) -> impl Iterator<Item = Exception> + use<> {
    exceptions(rows).into_iter().filter_map(|(key, share)| {
        let (kind, rest) = key.split_once(' ')?;
        let (place, codec) = rest.rsplit_once(' ')?;
        let against = if kind == COUNTS.0 { "the quicker wide type" } else { "plain C" };
        Some(Exception { against, place: place.to_owned(), codec: codec.to_owned(), share })
    })
}

/// Formats the exceptions, a line for each core and what it is compared with: their number and the largest.
pub fn markdown(rows: &[Row]) -> String {
    let mut lines: BTreeMap<(&str, String), Vec<Exception>> = BTreeMap::new();
    for exception in parsed(rows) {
        let core = exception.place.split(' ').next().unwrap_or_default().to_owned();
        lines.entry((exception.against, core)).or_default().push(exception);
    }
    let mut text =
        String::from("\n| compared with, core | above the bound | the largest |\n|---|---:|---|\n");
    for ((against, core), exceptions) in lines {
        let count = exceptions.len();
        // The first of equal ones.
        let largest = exceptions.iter().rev().max_by(|a, b| a.share.total_cmp(&b.share));
        let Some(Exception { place, codec, share, .. }) = largest else { continue };
        text += &format!("| {against}, {core} | {count} | {codec}, {place}: {share:.2} times |\n");
    }
    text + "\n"
}

/// Formats the exceptions as CSV.
pub fn csv(rows: &[Row]) -> String {
    let mut text = String::from("compared_with,core_and_form,scheme,times\n");
    for Exception { against, place, codec, share } in parsed(rows) {
        text += &format!("{against},{place},{codec},{share:.2}\n");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(sample: &str, instructions: f64, cycles: f64, in_c: f64) -> Row {
        Row {
            codec: "sf".into(),
            direction: "encode".into(),
            sample: sample.into(),
            core: "M0",
            form: "slice".into(),
            signal: "paper".into(),
            instructions_mean: instructions,
            cycles_mean: Some([cycles; 2]),
            in_c_cycles_mean: Some([in_c; 2]),
            ..Row::default()
        }
    }

    #[test]
    fn both_bounds_hold_unless_the_baseline_says_otherwise() {
        let rows = |counts, cycles| {
            [
                row("f32", 30.0, 1.0, 1.0),
                row("q16.16", 20.0, cycles, 10.0),
                row("i16", counts, 1.0, 1.0),
            ]
        };
        assert_eq!(unlisted(&rows(21.0, 11.0), &Shares::new()).len(), 0);
        assert_eq!(unlisted(&rows(21.2, 11.2), &Shares::new()).len(), 2);
        let listed = exceptions(&rows(24.0, 12.0));
        let keys: Vec<&str> = listed.keys().map(String::as_str).collect();
        assert_eq!(keys, ["C M0 q16.16 sf", "i16 M0 encode slice sf"]);
        assert_eq!(unlisted(&rows(24.4, 12.2), &listed).len(), 0);
        assert_eq!(unlisted(&rows(25.0, 13.0), &listed).len(), 2);
        assert_eq!(unlisted(&rows(20.0, 10.0), &listed).len(), 0);
        assert_eq!(unlisted(&[], &listed).len(), 2);
    }
}
