//! Measures the cost of calling from C: instructions on emulated cores, compared with calls from Rust.

use super::{archive, compiler};
use crate::programs::{boards::Board, image, qemu};
use anyhow::{Context, Result, bail, ensure};
use std::collections::BTreeMap;

/// Largest share by which encoding slices may take more in C than in Rust, over all codecs; also for decoding. Single
/// codecs may take more, if they take only a few instructions a sample.
const MOST: f64 = 0.05;

/// The forms, as the programs print them.
const FORMS: [&str; 4] = ["encode", "encode_slice", "decode", "decode_slice"];

/// Instructions of each form, by scheme and sample type.
type Counts = BTreeMap<String, [u32; 4]>;

/// Prints what each form takes in C and in Rust; fails if encoding a slice takes too much more.
pub fn cost() -> Result<()> {
    compiler::record()?;
    compare(Board::with("M4F")?)
}

fn compare(board: &Board) -> Result<()> {
    let archive = archive(board)?;
    let ticks = format!("TICKS_PER_GIGAINSTRUCTION={}u", board.ticks_per_gigainstruction());
    let mut c = Counts::new();
    for (sample, half) in super::tests::SAMPLES
        .into_iter()
        .flat_map(|sample| [(sample, "HALF=0"), (sample, "HALF=1")])
    {
        let program = compiler::for_board("count", board, &archive, &[sample, half, &ticks])?;
        c.extend(counts(&qemu::run_counting(board, &program)?)?);
    }
    let rust = counts(&qemu::run_counting(board, &image::build("c-boundary", board)?)?)?;
    println!("\n{}: instructions in C, and how many more than in Rust", board.core);
    let mut sums = [(0, 0); 4];
    for (name, own) in &c {
        let crate_s = rust.get(name).with_context(|| format!("Rust does not count {name}"))?;
        print!("{name:28}");
        for (place, (form, (own, rust))) in FORMS.iter().zip(own.iter().zip(crate_s)).enumerate() {
            print!("  {form} {own:7} {:+6.1} %", 100.0 * more(*own, *rust));
            sums[place].0 += own;
            sums[place].1 += rust;
        }
        println!();
    }
    print!("{:28}", "all");
    for (form, (own, rust)) in FORMS.iter().zip(sums) {
        print!("  {form} {own:7} {:+6.1} %", 100.0 * more(own, rust));
    }
    println!();
    let [_, encode, _, decode] = sums;
    for (own, rust) in [encode, decode] {
        ensure!(more(own, rust) <= MOST, "slices take more in C than they may");
    }
    Ok(())
}

fn more(own: u32, rust: u32) -> f64 {
    f64::from(own) / f64::from(rust) - 1.0
}

/// Parses `sf f32 encode 1 encode_slice 2 decode 3 decode_slice 4`.
fn counts(printed: &str) -> Result<Counts> {
    let mut counts = Counts::new();
    for line in printed.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        let [scheme, sample, rest @ ..] = &words[..] else { bail!("no count: {line}") };
        let mut own = [0; 4];
        for (place, pair) in own.iter_mut().zip(rest.chunks(2)) {
            *place = pair.last().unwrap_or(&"").parse().with_context(|| line.to_owned())?;
        }
        counts.insert(format!("{scheme} {sample}"), own);
    }
    Ok(counts)
}
