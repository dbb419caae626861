//! `cargo verify package`: checks that the published files include all that the pages show, and nothing else.

use crate::common::{cargo, links, output, paths};
use crate::programs::published::CRATES;
use anyhow::{Result, ensure};
use std::{fs, path::Path};

/// Beginnings of the paths that may be published.
const PUBLISHED: [&str; 6] =
    ["src/", "docs/", "README.md", "CHANGELOG.md", "SAFETY.md", "LICENSE-"];
/// Files that cargo adds.
const ADDED: [&str; 4] = ["Cargo.toml", "Cargo.toml.orig", "Cargo.lock", ".cargo_vcs_info.json"];

pub fn package() -> Result<()> {
    for own in CRATES {
        let list = output(cargo("package --list --allow-dirty --package").arg(own.name))?;
        let files: Vec<&str> = list.lines().collect();
        let wanted = |file: &&&str| {
            ADDED.contains(file) || PUBLISHED.iter().any(|start| file.starts_with(start))
        };
        let unwanted: Vec<_> = files.iter().filter(|file| !wanted(file)).collect();
        ensure!(unwanted.is_empty(), "{}: published, and should not be: {unwanted:?}", own.name);
        for file in ["src/lib.rs", "README.md", "CHANGELOG.md", "LICENSE-MIT", "LICENSE-APACHE"] {
            ensure!(files.contains(&file), "{}: its published files lack {file}", own.name);
        }
        let links = follow(&paths::root().join(own.directory), &files)?;
        println!("{}: {} files; their {links} links hold.", own.name, files.len());
    }
    Ok(())
}

/// Follows the links in a crate's published pages; returns their number. A picture must be published with its page; a link
/// may lead to any file of the repository, where the pages of crates.io look for it.
fn follow(top: &Path, files: &[&str]) -> Result<usize> {
    let mut links = 0;
    for page in files.iter().filter(|file| file.ends_with(".md")) {
        let text = fs::read_to_string(top.join(page))?;
        for link in links::relative(&text) {
            let is_there = match links::target(page, link) {
                Some(target) if is_picture(&target) => files.contains(&target.as_str()),
                _ => top.join(page).with_file_name("").join(link).exists(),
            };
            ensure!(is_there, "{page} links to {link}, which is not there");
            links += 1;
        }
    }
    Ok(links)
}

fn is_picture(file: &str) -> bool {
    [".svg", ".png"].iter().any(|end| file.ends_with(end))
}
