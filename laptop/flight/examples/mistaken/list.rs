//! Flight files that are easily mistaken for one another.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

const NAMES: [&str; 6] = ["roll", "pitch", "yaw", "x", "y", "z"];

/// The fields of a flight file, to be varied one at a time.
struct File<'a> {
    scheme: &'a str,
    parameters: String,
    sample: &'a str,
    period: usize,
    names: [String; 6],
    unit: &'a str,
    counts: f64,
    filter: String,
}

impl Default for File<'_> {
    fn default() -> Self {
        Self {
            scheme: "sf",
            parameters: "threshold = 0.1".into(),
            sample: "f32",
            period: 2000,
            names: NAMES.map(str::to_owned),
            unit: "rad/s",
            counts: 1.0,
            filter: String::new(),
        }
    }
}

impl File<'_> {
    fn text(&self) -> String {
        let Self { scheme, parameters, sample, period, names, unit, counts, filter } = self;
        let mut text = format!(
            "version = 1\nscheme = \"{scheme}\"\nsample = \"{sample}\"\nperiod = {period}\nkeyframe_every = 5\n{filter}\n\
             parameters = {{ {parameters} }}\n"
        );
        for name in names {
            let channel = format!("name = \"{name}\"\nunit = \"{unit}\"\ncounts = {counts:?}");
            // Writing to a string cannot fail.
            let _ = writeln!(text, "[[channel]]\n{channel}");
        }
        text
    }
}

/// Returns a flight file for each scheme in the catalogue.
fn codes() -> Vec<String> {
    let codes = catalogue::INFO.iter().map(|info| File {
        scheme: info.name,
        parameters: catalogue::run::example(info),
        ..File::default()
    });
    codes.map(|file| file.text()).collect()
}

/// Returns, for each field of a flight file, files that differ in this field only.
fn kinds() -> BTreeMap<&'static str, Vec<String>> {
    let seven =
        |file: &dyn Fn(usize) -> File<'static>| (0..7).map(|step| file(step).text()).collect();
    let file = File::default;
    let swapped = |one: usize, other: usize| {
        let mut names = NAMES.map(str::to_owned);
        names.swap(one, other);
        File { names, ..file() }
    };
    let swaps = [(0, 0), (0, 1), (0, 2), (0, 5), (1, 2), (2, 4), (3, 5)];
    let samples = ["f32", "q16.16", "q4.28", "q6.26", "q8.8", "q5.11", "q6.10"];
    let units = ["", "rad/s", "deg/s", "m/s", "m/s²", "g", "V"];
    let low_pass = |step| format!("filter = {{ kind = \"low-pass\", corner = {} }}", 40 + step);
    BTreeMap::from([
        ("code", codes()),
        ("sample", seven(&|step| File { sample: samples[step], ..file() })),
        (
            "threshold",
            seven(&|step| File { parameters: format!("threshold = 0.1{step}"), ..file() }),
        ),
        ("order", seven(&|step| swapped(swaps[step].0, swaps[step].1))),
        (
            "names",
            seven(&|step| File { names: NAMES.map(|name| format!("{name}{step}")), ..file() }),
        ),
        ("period", seven(&|step| File { period: 2000 + step, ..file() })),
        ("unit", seven(&|step| File { unit: units[step], ..file() })),
        ("counts", seven(&|step| File { counts: 1.0 + step as f64 / 8.0, ..file() })),
        ("filter", seven(&|step| File { filter: low_pass(step), ..file() })),
    ])
}

/// Returns the text of each file with its kinds. Two files with a common kind differ in this field only.
pub(crate) fn flights() -> BTreeMap<String, BTreeSet<&'static str>> {
    let mut found: BTreeMap<String, BTreeSet<&str>> = BTreeMap::new();
    for (kind, texts) in kinds() {
        for text in texts {
            found.entry(text).or_default().insert(kind);
        }
    }
    found
}
