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

/// Formats the exceptions, a line for those that have all but the codec's name in common.
pub fn markdown(rows: &[Row]) -> String {
    let mut lines: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for (key, share) in exceptions(rows) {
        let (of, codec) = key.rsplit_once(' ').unwrap_or_default();
        lines.entry(of.to_owned()).or_default().push(format!("{codec} {share:.2}"));
    }
    let mut text = String::from(
        "\n| compared with, core, form | codecs, and how many times as much |\n|---|---|\n",
    );
    for (of, codecs) in lines {
        let of = match of.split_once(' ') {
            Some((kind, rest)) if kind == COUNTS.0 => format!("the quicker wide type, {rest}"),
            Some((_, rest)) => format!("plain C, {rest}"),
            None => of,
        };
        text += &format!("| {of} | {} |\n", codecs.join(", "));
    }
    text + "\n"
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
