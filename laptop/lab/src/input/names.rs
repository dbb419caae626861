//! Names of channels: patterns, ranges of an array's items, and suggestions for a misspelt name.

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

/// Most items of an array that a range stands for.
pub(crate) const MOST_ITEMS: usize = 1 << 12;

/// Returns the names for which `name[0..3]` stands: `name[0]`, `name[1]` and `name[2]`, at most the first `most` of them.
/// A name without a range stands for itself.
pub fn items(name: &str, most: usize) -> Vec<String> {
    for (open, _) in name.match_indices('[') {
        let (before, rest) = name.split_at(open + 1);
        let Some((range, after)) = rest.split_once(']') else { break };
        let Some((start, end)) = range.split_once("..") else { continue };
        let (Ok(start), Ok(end)) = (start.parse::<usize>(), end.parse::<usize>()) else { continue };
        let end = end.min(start.saturating_add(most));
        return (start..end).map(|item| format!("{before}{item}]{after}")).collect();
    }
    vec![name.to_owned()]
}

/// Returns whether a name is a pattern: `*` in it stands for any letters, and `?` for one.
pub(crate) fn is_pattern(name: &str) -> bool {
    name.contains(['*', '?'])
}

/// Returns whether a pattern fits a name.
pub(crate) fn fits(pattern: &str, name: &str) -> bool {
    let (pattern, name) = (pattern.as_bytes(), name.as_bytes());
    let (mut at, mut place) = (0, 0);
    // The last `*`, and the place in the name up to which it stands. After a mismatch it takes one letter more.
    let mut star = None;
    while place < name.len() {
        if pattern.get(at) == Some(&b'*') {
            star = Some((at, place));
            at += 1;
        } else if pattern.get(at).is_some_and(|own| *own == b'?' || *own == name[place]) {
            at += 1;
            place += 1;
        } else if let Some((star_at, end)) = star {
            star = Some((star_at, end + 1));
            (at, place) = (star_at + 1, end + 1);
        } else {
            return false;
        }
    }
    pattern[at..].iter().all(|own| *own == b'*')
}

/// Lists the first names, and the number of further ones.
pub(crate) fn few(names: &[impl AsRef<str>]) -> String {
    const MOST: usize = 4;
    let first: Vec<&str> = names.iter().take(MOST).map(AsRef::as_ref).collect();
    let first = first.join(", ");
    match names.len().saturating_sub(MOST) {
        0 => first,
        more => format!("{first} and {more} more"),
    }
}

/// Returns whether a topic is a further instance of a sensor, such as `IMU:1`.
pub(crate) fn is_instance(topic: &str) -> bool {
    topic.rsplit_once(':').is_some_and(|(_, number)| number.parse::<u32>().is_ok_and(|own| own > 0))
}

/// Formats the names of channels for a sentence: `gyro[0], gyro[1], gyro[2]` is written as the range `gyro[0..3]`.
pub(crate) fn brief<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    /// Channels of an array that follow each other.
    struct Run<'a> {
        name: &'a str,
        /// The array's name, and the first and the last item.
        items: Option<(&'a str, usize, usize)>,
    }
    let mut runs: Vec<Run> = Vec::new();
    for name in names {
        let split = name.strip_suffix(']').and_then(|rest| rest.rsplit_once('['));
        let item = split.and_then(|(array, item)| Some((array, item.parse::<usize>().ok()?)));
        if let (Some((array, item)), Some(Run { items: Some((before, _, last)), .. })) =
            (item, runs.last_mut())
            && array == *before
            && item == *last + 1
        {
            *last = item;
            continue;
        }
        runs.push(Run { name, items: item.map(|(array, item)| (array, item, item)) });
    }
    let words = runs.iter().map(|run| match run.items {
        Some((array, first, last)) if last > first => format!("{array}[{first}..{}]", last + 1),
        _ => run.name.to_owned(),
    });
    words.collect::<Vec<_>>().join(", ")
}

/// Lists channels with their units: `gyro_rad[0..3] (rad/s), accelerometer_m_s2[0..3] (m/s²)`.
pub(crate) fn with_units(names: &[String], units: &[Option<String>]) -> String {
    let mut words = Vec::new();
    let mut start = 0;
    // Neighbours in one unit share it.
    for end in 1..=names.len() {
        if end < names.len() && units[end] == units[start] {
            continue;
        }
        let own = brief(names[start..end].iter().map(String::as_str));
        let unit = units[start].as_deref().unwrap_or("unit unknown");
        words.push(format!("{own} ({unit})"));
        start = end;
    }
    words.join(", ")
}

#[cfg(test)]
mod tests {
    use super::{brief, fits, items, with_units};

    #[test]
    fn ranges_stand_for_their_items() {
        assert_eq!(items("gyro[0..3]", 64), ["gyro[0]", "gyro[1]", "gyro[2]"]);
        assert_eq!(items("a[1].b[2..4].c", 64), ["a[1].b[2].c", "a[1].b[3].c"]);
        assert_eq!(items("x[0..9]", 2), ["x[0]", "x[1]"]);
        for name in ["gyro", "gyro[0]", "w [m..s]", "a[0..", "a[..3]"] {
            assert_eq!(items(name, 64), [name]);
        }
        assert_eq!(brief(["g[0]", "g[1]", "g[2]", "a[0]", "a[2]", "t"]), "g[0..3], a[0], a[2], t");
    }

    #[test]
    fn neighbours_in_one_unit_share_it() {
        let names = ["g[0]", "g[1]", "ax", "ay", "t"].map(str::to_owned);
        let units = [Some("rad/s"), Some("rad/s"), Some("g"), Some("g"), None];
        let units = units.map(|unit| unit.map(str::to_owned));
        assert_eq!(with_units(&names, &units), "g[0..2] (rad/s), ax, ay (g), t (unit unknown)");
    }

    #[test]
    fn patterns_fit_as_in_a_shell() {
        for (pattern, name) in [
            ("gyro_*", "gyro_x"),
            ("gyro_rad[*]", "gyro_rad[0]"),
            ("*", ""),
            ("*.x", "a.b.x"),
            ("a*b*c", "axxbxbc"),
            ("gyro_?", "gyro_x"),
        ] {
            assert!(fits(pattern, name), "{pattern} {name}");
        }
        for (pattern, name) in
            [("gyro_*", "accel_x"), ("gyro_?", "gyro_"), ("a*b", "abc"), ("gyro[*]", "gyro")]
        {
            assert!(!fits(pattern, name), "{pattern} {name}");
        }
    }
}
