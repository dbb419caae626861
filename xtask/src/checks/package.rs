//! `cargo verify package`: checks that the published files include all that the pages show, and nothing else.

use crate::common::{cargo, output, paths};
use crate::programs::published::CRATES;
use anyhow::{Result, ensure};
use std::{
    fs,
    path::{Component, Path, PathBuf},
};

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
        let links = links(&paths::root().join(own.directory), &files)?;
        println!("{}: {} files; their {links} links to each other hold.", own.name, files.len());
    }
    Ok(())
}

/// Follows the links in a crate's published pages; returns their number.
fn links(top: &Path, files: &[&str]) -> Result<usize> {
    let mut links = 0;
    for page in files.iter().filter(|file| file.ends_with(".md")) {
        let text = fs::read_to_string(top.join(page))?;
        for link in relative_links(&text) {
            let target = target(page, link);
            ensure!(
                target.as_deref().is_some_and(|target| files.contains(&target)),
                "{page} links to {link}, which is not published"
            );
            links += 1;
        }
    }
    Ok(links)
}

/// Returns the targets of a page's links and pictures within this repository, without what follows a `#`.
fn relative_links(text: &str) -> impl Iterator<Item = &str> {
    let ends = text.match_indices("](").map(|(at, mark)| &text[at + mark.len()..]);
    ends.filter_map(|rest| rest.split([')', '#', ' ']).next())
        .filter(|link| !link.is_empty() && !link.contains("://"))
}

/// Returns a link's target as a path from the repository's top; `None` if it leads outside.
fn target(page: &str, link: &str) -> Option<String> {
    let mut path = PathBuf::new();
    for part in Path::new(page).parent()?.join(link).components() {
        match part {
            Component::ParentDir => path.pop().then_some(())?,
            Component::Normal(name) => path.push(name),
            _ => return None,
        }
    }
    Some(path.to_str()?.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_are_read_and_followed() {
        let text = "[a](b.md#c) ![d](e/f.svg) [g](https://h) [i](#j) [k](../l.md)";
        assert_eq!(relative_links(text).collect::<Vec<_>>(), ["b.md", "e/f.svg", "../l.md"]);
        assert_eq!(target("docs/a.md", "../b.md").unwrap(), "b.md");
        assert_eq!(target("a.md", "docs/b.md").unwrap(), "docs/b.md");
        assert_eq!(target("a.md", "../b.md"), None);
    }
}
