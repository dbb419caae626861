//! Reads and writes tables in pages, between two markers.

use crate::common::paths;
use anyhow::{Context, Result, ensure};
use std::fs;

/// Writes a table between its markers in a page.
pub fn write(page: &str, marker: &str, table: &str) -> Result<()> {
    let text = between(&read(page)?, marker, table)?;
    fs::write(paths::root().join(page), text)?;
    println!("{page} has the table `{marker}`.");
    Ok(())
}

/// Fails if a page has another table; the error names the command that writes it.
pub fn ensure_written(page: &str, marker: &str, table: &str, command: &str) -> Result<()> {
    let text = read(page)?;
    ensure!(
        between(&text, marker, table)? == text,
        "{page} has other figures; `{command}` puts these there:\n{table}"
    );
    Ok(())
}

/// Returns the text that is between the markers now.
pub fn section(page: &str, marker: &str) -> Result<String> {
    Ok(parts(&read(page)?, marker)?[1].to_owned())
}

fn read(page: &str) -> Result<String> {
    fs::read_to_string(paths::root().join(page)).with_context(|| page.to_owned())
}

/// Returns the page with the table in place of the text between its markers.
fn between(page: &str, marker: &str, table: &str) -> Result<String> {
    let [before, _, after] = parts(page, marker)?;
    Ok(format!("{before}<!-- {marker} -->\n{table}<!-- /{marker} -->{after}"))
}

/// Splits a page into the text before, between and after the markers.
fn parts<'a>(page: &'a str, marker: &str) -> Result<[&'a str; 3]> {
    let (start, end) = (format!("<!-- {marker} -->\n"), format!("<!-- /{marker} -->"));
    let missing = || format!("no `{}` … `{end}`", start.trim_end());
    let (before, rest) = page.split_once(&start).with_context(missing)?;
    let (table, after) = rest.split_once(&end).with_context(missing)?;
    Ok([before, table, after])
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
