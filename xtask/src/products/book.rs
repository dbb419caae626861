//! `cargo xtask book`: builds the pages of the repository as a web site, with search, for any static host.

use crate::common::{command, links, output, paths, run};
use crate::programs::python;
use anyhow::{Context, Result};
use std::{
    fs,
    path::{Path, PathBuf},
};

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
    for page in listed.lines().filter(|page| root.join(page).is_file()) {
        let text = fs::read_to_string(root.join(page))?;
        for file in links::relative(&text).filter_map(|link| links::target(page, link)) {
            // What is missing, the builder reports with the page's name.
            if !file.ends_with(".md") && root.join(&file).is_file() {
                fs::copy(root.join(&file), place(to, &file)?)?;
            }
        }
        fs::write(place(to, page)?, shown(&text))?;
    }
    Ok(())
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
    use super::shown;

    #[test]
    fn lines_that_rustdoc_hides_are_not_shown() {
        let page = "# A\n```rust,ignore\n# hidden\n#[b]\nlet c;\n```\n```sh\n# d\n```\n";
        let seen = "# A\n```rust\n#[b]\nlet c;\n```\n```sh\n# d\n```\n";
        assert_eq!(shown(page), seen);
    }
}
