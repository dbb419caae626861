//! `cargo xtask book`: builds the pages of the repository as a web site, with search, for any static host.

use crate::common::{command, links, output, paths, run};
use crate::programs::python;
use anyhow::{Context, Result, bail, ensure};
use std::{
    fs,
    path::{Path, PathBuf},
};

/// Most words of README, docs and the crates' READMEs together, as `wc -w` counts them. Who adds some deletes others.
const MOST_WORDS: usize = 40_000;

/// Most columns of a table; a wider one is a page in disguise, or a file.
const MOST_COLUMNS: usize = 8;

/// Most characters of a table's cell, without the targets of links.
const LONGEST_CELL: usize = 200;

/// Builds the book; returns its directory. A page that no part lists, or a link that leads nowhere, is an error.
pub fn build() -> Result<PathBuf> {
    let python = python::environment_with("book-python", "docs/requirements.txt")?;
    let pages = tempfile::tempdir()?;
    gather(pages.path())?;
    let site = paths::target().join("book");
    let mut mkdocs = command(&python);
    mkdocs.args(["-m", "mkdocs", "build", "--strict", "--site-dir"]).arg(&site);
    // The theme's notice about another project's plans.
    mkdocs.env("NO_MKDOCS_2_WARNING", "1");
    run(mkdocs.env("BOOK_PAGES", pages.path()))?;
    println!("Open it in a browser, or put it on any host: {}", site.join("index.html").display());
    Ok(site)
}

/// Packs the book into one file, which a release carries.
pub fn pack() -> Result<PathBuf> {
    let (site, packed) = (build()?, paths::target().join("spikewire-book.tar.gz"));
    run(command("tar").arg("-czf").arg(&packed).arg("-C").arg(site).arg("."))?;
    Ok(packed)
}

/// Copies every page that git knows or would add, and the files that they link to, to the same places below a directory,
/// so that links lead to the same files as in the repository.
fn gather(to: &Path) -> Result<()> {
    let listed = output(command("git").args([
        "ls-files",
        "--cached",
        "--others",
        "--exclude-standard",
        "*.md",
    ]))?;
    let root = paths::root();
    let mut words = 0;
    for page in listed.lines().filter(|page| root.join(page).is_file()) {
        let text = fs::read_to_string(root.join(page))?;
        if let Some(row) = wide_row(&text) {
            bail!("{page}: this row has too many columns or too long a cell: {row}");
        }
        if page.starts_with("docs/") || page.ends_with("README.md") {
            words += text.split_whitespace().count();
        }
        for file in links::relative(&text).filter_map(|link| links::target(page, link)) {
            // What is missing, the builder reports with the page's name.
            if !file.ends_with(".md") && root.join(&file).is_file() {
                fs::copy(root.join(&file), place(to, &file)?)?;
            }
        }
        fs::write(place(to, page)?, shown(&text))?;
    }
    ensure!(words <= MOST_WORDS, "the pages have {words} words; {MOST_WORDS} are allowed");
    Ok(())
}

/// Returns the first row of a table that has too many columns or too long a cell.
fn wide_row(text: &str) -> Option<&str> {
    text.lines().filter(|line| line.starts_with('|')).find(|row| {
        let cells: Vec<&str> = row.trim_end().trim_matches('|').split('|').collect();
        let is_long = cells.iter().any(|cell| seen_length(cell.trim()) > LONGEST_CELL);
        is_long || cells.len() > MOST_COLUMNS
    })
}

/// Returns a cell's number of characters as a reader sees it: without the targets of its links.
fn seen_length(cell: &str) -> usize {
    let mut parts = cell.split("](");
    let first = parts.next().unwrap_or_default();
    let behind_targets = parts.map(|part| part.split_once(')').map_or("", |(_, rest)| rest));
    first.chars().count() + behind_targets.map(|rest| rest.chars().count()).sum::<usize>()
}

/// Returns a file's path below a directory, whose directories are made.
fn place(to: &Path, file: &str) -> Result<PathBuf> {
    let path = to.join(file);
    fs::create_dir_all(path.parent().context("no directory")?)?;
    Ok(path)
}

/// Returns a page's text as rustdoc shows it: blocks of Rust without the lines that it hides, and without its attributes.
fn shown(text: &str) -> String {
    let mut shown = String::new();
    let mut is_rust = false;
    for line in text.lines() {
        if line.starts_with("```") {
            is_rust = line.starts_with("```rust");
            shown += if is_rust { "```rust" } else { line };
        } else if is_rust && (line == "#" || line.starts_with("# ")) {
            continue;
        } else {
            shown += line;
        }
        shown.push('\n');
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::{seen_length, shown, wide_row};

    #[test]
    fn wide_tables_are_found() {
        let (eight, nine) = ("|a".repeat(8) + "|", "|a".repeat(9) + "|");
        assert_eq!(wide_row(&eight), None);
        assert_eq!(wide_row(&format!("b\n{eight}\n{nine}")), Some(nine.as_str()));
        let (fits, long) = (format!("| {} |", "c".repeat(200)), format!("| {} |", "c".repeat(201)));
        assert_eq!(wide_row(&format!("{fits}\n{long}")), Some(long.as_str()));
        assert_eq!(seen_length("[de](https://f) g [h](i) j"), "[de g [h j".len());
    }

    #[test]
    fn lines_that_rustdoc_hides_are_not_shown() {
        let page = "# A\n```rust,ignore\n# hidden\n#[b]\nlet c;\n```\n```sh\n# d\n```\n";
        let seen = "# A\n```rust\n#[b]\nlet c;\n```\n```sh\n# d\n```\n";
        assert_eq!(shown(page), seen);
    }
}
