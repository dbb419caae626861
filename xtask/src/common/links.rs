//! Reads the links of pages.

use std::path::{Component, Path, PathBuf};

/// Returns the targets of a page's links and pictures within this repository, without what follows a `#`.
pub fn relative(text: &str) -> impl Iterator<Item = &str> {
    let ends = text.match_indices("](").map(|(at, mark)| &text[at + mark.len()..]);
    ends.filter_map(|rest| rest.split([')', '#', ' ']).next())
        .filter(|link| !link.is_empty() && !link.contains("://"))
}

/// Returns a link's target as a path from the repository's top; `None` if it leads outside.
pub fn target(page: &str, link: &str) -> Option<String> {
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
        assert_eq!(relative(text).collect::<Vec<_>>(), ["b.md", "e/f.svg", "../l.md"]);
        assert_eq!(target("docs/a.md", "../b.md").unwrap(), "b.md");
        assert_eq!(target("a.md", "docs/b.md").unwrap(), "docs/b.md");
        assert_eq!(target("a.md", "../b.md"), None);
    }
}
