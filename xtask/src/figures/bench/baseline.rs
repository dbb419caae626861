//! Compares counts with a recorded baseline: none may grow by more than a twentieth.

use super::{
    figures::Row,
    measured::{Compilers, Measured},
    slower::{self, Shares},
};
use crate::common::paths;
use anyhow::{Context, Result, bail};
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, fs, path::PathBuf};

/// Cores in the baseline: the usual one and the smallest.
pub const CORES: [&str; 2] = ["M4F", "M0"];

const ALLOWED: f64 = 1.05;

#[derive(Serialize, Deserialize)]
struct Baseline {
    compilers: Compilers,
    instructions_mean: BTreeMap<String, f64>,
    /// Codecs that take more than counts or plain C allow.
    above_bound: Shares,
}

fn path() -> PathBuf {
    paths::examples().join("bench-target/baseline.json")
}

fn counts(Measured { rows, events, .. }: &Measured) -> BTreeMap<String, f64> {
    let rows = rows.iter().map(|row| (key(row), row.instructions_mean));
    let events = events.iter().map(|event| (event.key(), event.instructions_mean));
    rows.chain(events).collect()
}

fn key(row: &Row) -> String {
    let Row { core, signal, codec, sample, direction, form, .. } = row;
    format!("{core} {signal} {codec} {sample} {direction} {form}")
}

pub fn write(measured: &Measured) -> Result<()> {
    let baseline = Baseline {
        compilers: measured.compilers.clone(),
        instructions_mean: counts(measured),
        above_bound: slower::exceptions(&measured.rows),
    };
    fs::write(path(), serde_json::to_string_pretty(&baseline)? + "\n")?;
    println!("{} counts are the baseline now.", baseline.instructions_mean.len());
    Ok(())
}

/// Prints every difference on a core. Fails if a count has grown, unless another compiler may be the cause.
pub fn compare(core: &str, measured: &Measured) -> Result<()> {
    let file = fs::read_to_string(path())
        .context("no baseline; `cargo bench-target --baseline` writes it")?;
    let mut baseline: Baseline = serde_json::from_str(&file)?;
    baseline.instructions_mean.retain(|key, _| key.split(' ').next() == Some(core));
    baseline.above_bound.retain(|key, _| key.split(' ').nth(1) == Some(core));
    let above = slower::unlisted(&measured.rows, &baseline.above_bound);
    let in_c = above.iter().filter(|key| slower::is_in_c(key)).count();
    let own = above.len() - in_c + differences(&baseline.instructions_mean, &counts(measured));
    let grown = own + in_c;
    let (then, now) = (&baseline.compilers, &measured.compilers);
    // C's compiler has a say only in what is compared with C.
    let may_be_compilers = then.rustc != now.rustc || (own == 0 && then.gcc != now.gcc);
    if grown == 0 {
        println!("No count of {} has grown by more than 5 %.", baseline.instructions_mean.len());
        println!("All bounds hold but {} that the baseline lists.", baseline.above_bound.len());
    } else if !may_be_compilers {
        bail!("{grown} counts have grown by more than 5 %, are gone, or are above a bound");
    } else {
        println!("{grown} counts have grown. No failure, as a compiler is another:");
        for (whose, Compilers { rustc, gcc }) in [("baseline", then), ("here    ", now)] {
            println!("  {whose} {rustc}, {gcc}");
        }
    }
    Ok(())
}

/// Prints the differences; returns how many are too large.
fn differences(old: &BTreeMap<String, f64>, new: &BTreeMap<String, f64>) -> usize {
    let mut grown = 0;
    for (key, &old) in old {
        match new.get(key) {
            None => println!("{key}: {old:.2}, gone"),
            Some(&new) if new > old * ALLOWED => println!("{key}: {old:.2}, now {new:.2}: MORE"),
            Some(&new) => {
                if new * ALLOWED < old {
                    println!("{key}: {old:.2}, now {new:.2}: less");
                }
                continue;
            }
        }
        grown += 1;
    }
    for (key, new) in new.iter().filter(|(key, _)| !old.contains_key(*key)) {
        println!("{key}: {new:.2}, not in the baseline");
    }
    grown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_twentieth_is_allowed_and_a_loss_is_seen() {
        let counts = |counts: [f64; 3]| {
            BTreeMap::from_iter(counts.iter().enumerate().map(|(i, &count)| (i.to_string(), count)))
        };
        let old = counts([100.0, 100.0, 100.0]);
        assert_eq!(differences(&old, &counts([105.0, 100.0, 1.0])), 0);
        assert_eq!(differences(&old, &counts([105.1, 100.0, 200.0])), 2);
        assert_eq!(differences(&old, &BTreeMap::new()), 3);
    }
}
