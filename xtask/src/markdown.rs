//! Tables in pages, between two comments.

use anyhow::{Context, Result};

/// The page with the table in the place of what stood between its markers.
pub fn between(page: &str, marker: &str, table: &str) -> Result<String> {
    let (start, end) = (format!("<!-- {marker} -->\n"), format!("<!-- /{marker} -->"));
    let missing = || format!("no `{}` … `{end}`", start.trim_end());
    let (before, rest) = page.split_once(&start).with_context(missing)?;
    let (_, after) = rest.split_once(&end).with_context(missing)?;
    Ok(format!("{before}{start}{table}{end}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_between_the_markers_changes() {
        let page = "a\n<!-- x -->\nold\n<!-- /x -->\nb\n<!-- x y -->\n<!-- /x y -->\n";
        let new = "a\n<!-- x -->\nnew\n<!-- /x -->\nb\n<!-- x y -->\n<!-- /x y -->\n";
        assert_eq!(between(page, "x", "new\n").unwrap(), new);
        assert!(between("a", "x", "new\n").is_err());
    }
}
