//! Suggestions for a misspelt name.

/// Returns a text that suggests valid names for the misspelt name `asked`. If there are at most eight valid names, the
/// text lists all of them. Otherwise, the text lists the three names most like `asked`, and the number of all names.
pub fn near<'a>(asked: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    const FEW: usize = 8;
    const MOST: usize = 3;
    let lower = asked.to_lowercase();
    let mut ranked: Vec<(f64, &str)> = names
        .into_iter()
        .map(|name| (strsim::jaro_winkler(&lower, &name.to_lowercase()), name))
        .collect();
    if ranked.len() <= FEW {
        let names: Vec<&str> = ranked.iter().map(|(_, name)| *name).collect();
        return format!("there are {}", names.join(", "));
    }
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    let names: Vec<&str> = ranked.iter().take(MOST).map(|(_, name)| *name).collect();
    format!("near it are {}; there are {}", names.join(", "), ranked.len())
}
