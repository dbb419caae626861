//! `cargo verify interface`: compares the public items of each published crate with its `interface.txt`, so that a
//! reviewer sees each change of them.

use crate::common::{cargo, paths, run};
use crate::programs::published::{CRATES, Crate};
use anyhow::{Context, Result, ensure};
use std::{collections::BTreeSet, fs, path::PathBuf};

/// Compares every crate's public items with its `interface.txt`.
pub fn verify() -> Result<()> {
    for own in &CRATES {
        let (now, kept) = (of(own)?, fs::read_to_string(page(own)).unwrap_or_default());
        let (new, old) = (lines(&now), lines(&kept));
        for line in old.difference(&new) {
            println!("- {line}");
        }
        for line in new.difference(&old) {
            println!("+ {line}");
        }
        ensure!(
            now == kept,
            "{} offers something else than its interface.txt says; if it is meant: `cargo xtask write interface`, \
             and a line in its CHANGELOG.md",
            own.name
        );
        println!("{}: {} public types, {} items.", own.name, types(&now), new.len());
    }
    Ok(())
}

/// Writes every crate's `interface.txt`.
pub fn write() -> Result<()> {
    for own in &CRATES {
        fs::write(page(own), of(own)?)?;
    }
    Ok(())
}

fn page(own: &Crate) -> PathBuf {
    paths::root().join(own.directory).join("interface.txt")
}

/// Lists all public items of a crate with all its features, one on each line. Leaves out what every type implements,
/// and the members of an implementation, which its trait determines.
fn of(own: &Crate) -> Result<String> {
    const JSON: &str = "--lib --all-features -- -Z unstable-options --output-format json";
    let place = paths::target().join("interface");
    // The compiler's description of a crate is not stable, but is always the same of a pinned one.
    run(cargo("rustdoc --quiet")
        .args(["--package", own.name])
        .args(JSON.split(' '))
        .env("CARGO_TARGET_DIR", &place)
        .env("RUSTC_BOOTSTRAP", "1"))?;
    let name = own.name.replace('-', "_");
    let items = public_api::Builder::from_rustdoc_json(place.join(format!("doc/{name}.json")))
        .omit_blanket_impls(true)
        .omit_auto_trait_impls(true)
        .omit_auto_derived_impls(true)
        .build()
        .with_context(|| format!("{name}.json of the documentation"))?;
    let mut text = String::new();
    let mut of_trait = false;
    for item in items.items() {
        let line = item.to_string();
        if line.starts_with("impl") {
            of_trait = line.contains(" for ");
        } else if !is_member(&line) {
            of_trait = false;
        } else if of_trait {
            continue;
        }
        text.push_str(
            &line
                .replace("core::option::Option", "Option")
                .replace("core::result::Result", "Result"),
        );
        text.push('\n');
    }
    // The crate's own name stands in each line and says nothing.
    Ok(text.replace(&format!("{name}::"), ""))
}

fn lines(text: &str) -> BTreeSet<&str> {
    text.lines().collect()
}

/// Counts the structs, enums, unions, traits and aliases of a crate.
fn types(text: &str) -> usize {
    const KINDS: [&str; 5] = ["struct", "enum", "union", "trait", "type"];
    let declares = |line: &&str| {
        let declared = line.strip_prefix("pub ").and_then(|rest| rest.split_once(' '));
        // Not the type of an implementation for references or arrays.
        declared.is_some_and(|(kind, name)| {
            KINDS.contains(&kind) && name.starts_with(char::is_alphabetic) && !is_member(line)
        })
    };
    text.lines().filter(declares).count()
}

/// Returns whether an item is a member of a type, that is, whether the word before its name is capitalised.
fn is_member(line: &str) -> bool {
    const BEFORE: [&str; 6] = ["pub", "const", "unsafe", "fn", "type", "struct"];
    let path = line.split(' ').find(|word| !BEFORE.contains(word)).unwrap_or_default();
    let path = path.split(['<', '(']).next().unwrap_or_default();
    let path = path.trim_end_matches([':', '=']);
    let mut words = path.rsplit("::");
    // Behind a type's parameters, its name is the last word.
    let is_cut = line.contains(&format!("{path}<")) && line.contains(">::");
    let owner = if is_cut { words.next() } else { words.nth(1) };
    owner.is_some_and(|word| word.starts_with(char::is_uppercase))
}
