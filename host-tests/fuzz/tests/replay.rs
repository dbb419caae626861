//! `cargo verify fuzz`: the corpora, and mutants of theirs from a fixed seed; `FUZZ_TIMES` times as many of these.

use fuzz::TARGETS;
use fuzz::mutate::Random;
use std::path::Path;
use std::{fs, time::Instant};

#[test]
#[ignore = "a check of its own, `cargo verify fuzz`"]
fn replay() {
    let times: usize = std::env::var("FUZZ_TIMES").map_or(1, |times| times.parse().unwrap());
    let mut all = 0;
    for target in TARGETS {
        let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(target.name);
        let mut files: Vec<_> = fs::read_dir(&corpus)
            .unwrap_or_else(|error| panic!("{}: {error}", corpus.display()))
            .map(|entry| entry.unwrap().path())
            .collect();
        files.sort();
        assert!(!files.is_empty(), "{} is empty", corpus.display());
        let (start, mut runs) = (Instant::now(), 0);
        let mut random = Random::new(2022);
        for file in &files {
            let input = fs::read(file).unwrap();
            (target.run)(&input);
            for _ in 0..target.mutants * times {
                let mut mutant = input.clone();
                random.damage(&mut mutant);
                (target.run)(&mutant);
            }
            runs += 1 + target.mutants * times;
        }
        println!(
            "{:10} {runs:6} inputs of {} files, {:.1?}",
            target.name,
            files.len(),
            start.elapsed()
        );
        all += runs;
    }
    println!("{all} inputs, and no promise broken");
}
