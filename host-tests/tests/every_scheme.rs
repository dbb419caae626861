//! What a scheme needs that nothing can generate: a test with a reference of its own, its rows and words in the docs, and its
//! place in lists of other languages. Each test names what is missing.

use catalogue::{Channel, Flight, INFO, Storable};
use host_tests::flight;
use spikewire::ConfigError;
use std::{
    any::type_name,
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

/// The schemes' types, such as `StepForward`.
#[derive(Default)]
struct Types(BTreeSet<String>);

impl Flight for Types {
    type Sample = f32;
    type Error = ConfigError;

    fn visit<P: Storable<Sample = f32>>(
        &mut self,
        _: &'static str,
        _: &'static str,
        _: &P,
        _: P::EncoderState,
    ) -> Result<(), ConfigError> {
        let path = type_name::<P>().split('<').next().unwrap();
        self.0.insert(path.rsplit("::").next().unwrap().to_owned());
        Ok(())
    }
}

/// The tables with a row for each scheme, and the cell of each row, counted from the first stroke, with words of its own.
const TABLES: [(&str, usize); 3] =
    [("src/lib.rs", 3), ("docs/schemes.md", 2), ("docs/codes.md", 1)];

/// The words of the table of fingerprints, with which a receiver of one's own is written.
const FINGERPRINTS: &str = "src/scheme/fingerprint.rs";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

fn read(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Returns the texts of all Rust files below a directory.
fn sources_of(room: &str) -> Vec<String> {
    let (mut texts, mut waiting) = (Vec::new(), vec![root().join(room)]);
    while let Some(path) = waiting.pop() {
        if path.is_dir() {
            waiting.extend(fs::read_dir(&path).unwrap().map(|entry| entry.unwrap().path()));
        } else if path.extension().is_some_and(|end| end == "rs") {
            texts.push(fs::read_to_string(&path).unwrap());
        }
    }
    texts
}

/// Returns the types of all schemes in the catalogue.
fn types() -> BTreeSet<String> {
    let samples = flight::flown::<f32>(0, 1.0);
    let mut types = Types::default();
    catalogue::fly(&Channel::new(0, flight::calibrated(&samples)), &mut types).unwrap();
    assert!(types.0.contains("StepForward"), "{:?}", types.0);
    types.0
}

/// Returns the cells of the rows of tables that name a scheme's type.
fn rows(page: &str, types: &BTreeSet<String>) -> Vec<Vec<String>> {
    let text = read(page);
    let rows = text.lines().map(|line| line.trim_start_matches("//!").trim());
    let rows = rows.filter(|line| line.starts_with('|') && line.ends_with('|'));
    let is_of_a_scheme = |row: &&str| {
        let mut words = row.split(|sign: char| !sign.is_alphanumeric());
        words.any(|word| types.contains(word))
    };
    let cells = |row: &str| row.split('|').map(|cell| cell.trim().to_owned()).collect();
    rows.filter(is_of_a_scheme).map(cells).collect()
}

#[test]
fn has_a_test_and_rows_in_the_docs() {
    let tests = sources_of("host-tests/tests");
    for name in types() {
        assert!(
            tests.iter().any(|test| test.contains(&name)),
            "no test compares `{name}` with a reference: CONTRIBUTING.md, “A scheme”, step 3"
        );
        for (page, _) in TABLES {
            assert!(
                read(page).contains(&name),
                "{page} has no `{name}`: CONTRIBUTING.md, “A scheme”, step 4"
            );
        }
    }
}

/// `cargo xtask scheme` leaves the cells of a new row empty: no row has another scheme's words.
#[test]
fn has_words_of_its_own() {
    let types = types();
    for (page, place) in TABLES {
        let rows = rows(page, &types);
        assert!(rows.len() > 20, "{page}: {} rows are read", rows.len());
        let mut seen: BTreeMap<String, String> = BTreeMap::new();
        for cells in rows {
            let row = cells.join("|");
            // Before the first stroke and behind the last one there is nothing, and a family stands in its first row.
            let first = if page == "src/lib.rs" { place } else { 1 };
            let empty = cells[first..cells.len() - 1].iter().position(String::is_empty);
            assert!(empty.is_none(), "{page}: a cell is empty in {row}");
            if let Some(other) = seen.insert(cells[place].clone(), row.clone()) {
                panic!("{page}: two rows say `{}`:\n{other}\n{row}", cells[place]);
            }
        }
    }
}

/// Whoever writes a receiver takes the bytes of a fingerprint from the table.
#[test]
fn has_a_row_in_the_table_of_fingerprints() {
    let text = read(FINGERPRINTS);
    let mut named = 0;
    for source in ["src/scheme", "src/filter"].into_iter().flat_map(sources_of) {
        for begun in
            ["Fingerprint::new(\"", ".named(\""].iter().flat_map(|call| source.split(call).skip(1))
        {
            let name = begun.split('"').next().unwrap();
            let is_told = text
                .lines()
                .any(|line| line.starts_with("///") && line.contains(&format!("`{name}`")));
            assert!(is_told, "{FINGERPRINTS} does not say what the fingerprint of `{name}` is of");
            named += 1;
        }
    }
    assert!(named > 20, "{named} fingerprints are found");
    for line in text.lines().filter(|line| line.starts_with("/// |")) {
        let is_complete = line
            .trim_start_matches("/// |")
            .split('|')
            .filter(|cell| cell.trim().is_empty())
            .count()
            == 1;
        assert!(is_complete, "{FINGERPRINTS}: a cell is empty in {line}");
    }
}

#[test]
fn is_counted_where_the_docs_count() {
    let count = INFO.len();
    assert!(
        read("README.md").contains(&format!("lists all {count} schemes")),
        "README.md: there are {count} schemes"
    );
    // Each code with six signals.
    let words = format!("With {count} codes that is {} problems", count * 6);
    assert!(read("SAFETY.md").contains(&words), "SAFETY.md does not say: {words}");
}

/// Python decodes weights in the place of spikes by the kind of a code; which kind it is cannot be derived.
#[test]
fn has_a_kind_in_python_s_weights() {
    let text = read("bindings/python/spikewire/_weighted.py");
    let mut kinds: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for kind in ["MEANS", "STEPS", "FILTERS", "DIGITS", "WITHOUT"] {
        let list =
            text.split(&format!("\n{kind} = (")).nth(1).unwrap_or_else(|| panic!("no list {kind}"));
        let list = list.split(')').next().unwrap();
        kinds.insert(kind, list.split('"').skip(1).step_by(2).collect());
    }
    for info in INFO {
        let of_it = kinds.iter().filter(|(_, names)| names.contains(&info.name));
        assert_eq!(of_it.count(), 1, "_weighted.py lists `{}` not once: {kinds:?}", info.name);
    }
    for name in kinds.values().flatten() {
        assert!(
            INFO.iter().any(|info| info.name == *name),
            "_weighted.py lists `{name}`, which there is not"
        );
    }
}

/// ROS nodes take these parameters where a launch file gives none.
#[test]
fn has_defaults_in_ros() {
    const PAGE: &str = "bindings/ros/ros1/spikewire_ros/config/defaults.yaml";
    let text = read(PAGE);
    let mut named = BTreeSet::new();
    for line in text.lines().filter(|line| !line.starts_with('#') && !line.is_empty()) {
        let (name, rest) = line.split_once(": {").unwrap_or_else(|| panic!("{PAGE}: {line}"));
        let info = INFO.iter().find(|info| info.name == name);
        let info = info.unwrap_or_else(|| panic!("{PAGE}: there is no scheme `{name}`"));
        for pair in rest.trim_end_matches('}').split(", ") {
            let key = pair.split(':').next().unwrap();
            assert!(
                key == "calibrate" || info.parameter(key).is_some(),
                "{PAGE}: `{name}` has no parameter `{key}`"
            );
        }
        named.insert(name);
    }
    for info in INFO {
        assert!(named.contains(info.name), "{PAGE} has no line for `{}`", info.name);
    }
}
