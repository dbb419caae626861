//! No two modules of this program name each other, directly or through others.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
};

/// What each module imports, of the modules beside it.
fn imports() -> BTreeMap<String, BTreeSet<String>> {
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/src");
    let paths = fs::read_dir(source).unwrap().map(|entry| entry.unwrap().path());
    let texts: BTreeMap<String, String> = paths
        .filter(|path| path.is_file())
        .map(|path| {
            let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
            (name, fs::read_to_string(path).unwrap())
        })
        .collect();
    let named = |name: &String, text: &String| {
        let uses = text.split("crate::").skip(1);
        let words = uses.flat_map(|rest| {
            let end = if rest.starts_with('{') { ';' } else { ':' };
            let part = rest.split([end, '(', ';']).next().unwrap();
            part.split(|letter: char| !letter.is_alphanumeric() && letter != '_')
        });
        words.filter(|word| texts.contains_key(*word) && word != name).map(str::to_owned).collect()
    };
    texts.iter().map(|(name, text)| (name.clone(), named(name, text))).collect()
}

#[test]
fn none_names_another_that_names_it() {
    let mut imports = imports();
    assert!(imports["demo"].contains("picture"), "imports are not read");
    // Take away those that import none that is left, until none is left.
    while !imports.is_empty() {
        let done: Vec<String> = imports
            .iter()
            .filter(|(_, named)| named.iter().all(|name| !imports.contains_key(name)))
            .map(|(name, _)| name.clone())
            .collect();
        assert!(!done.is_empty(), "these name each other: {imports:?}");
        imports.retain(|name, _| !done.contains(name));
    }
}
