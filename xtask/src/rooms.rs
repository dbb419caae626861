//! Tests the order of the crate's modules: data flows through them, and none may name one above its own. The modules of
//! this program need no order, but no two may name each other, directly or through others; nor may two files of a
//! module.

use crate::verify::modules::{Named, files, paths};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
};
use syn::{Item, UseTree};

/// The crate's modules from the lowest to the highest. Those on one line are equal, and none may name the other.
const ORDER: [&[&str]; 8] = [
    &["serial"], // what serde does not derive
    &["error"],
    &["num"],
    &["scheme"],
    &["filter", "event"],
    &["wire"],
    &["out"],
    &["lib"],
];

/// Returns the modules that a root declares, and the module of each name that it re-exports.
fn roots(lib: &str) -> BTreeMap<String, String> {
    let items = syn::parse_file(lib).unwrap().items;
    let rooms = items.iter().filter_map(|item| match item {
        Item::Mod(room) if room.content.is_none() => Some(room.ident.to_string()),
        _ => None,
    });
    let mut roots: BTreeMap<String, String> = rooms.map(|room| (room.clone(), room)).collect();
    for item in &items {
        if let Item::Use(item) = item
            && let UseTree::Path(path) = &item.tree
            && let Some(room) = roots.get(&path.ident.to_string()).cloned()
        {
            leaves(&path.tree, &room, &mut roots);
        }
    }
    roots
}

fn leaves(tree: &UseTree, room: &str, roots: &mut BTreeMap<String, String>) {
    match tree {
        UseTree::Path(path) => leaves(&path.tree, room, roots),
        UseTree::Group(group) => group.items.iter().for_each(|one| leaves(one, room, roots)),
        UseTree::Name(one) => drop(roots.insert(one.ident.to_string(), room.into())),
        UseTree::Rename(one) => drop(roots.insert(one.rename.to_string(), room.into())),
        UseTree::Glob(_) => panic!("{room}: a `*` does not say what it brings"),
    }
}

/// Lists the names in a module's text that are forbidden or unknown, one on each line.
fn offences(source: &str, module: &[String], roots: &BTreeMap<String, String>) -> Vec<String> {
    let height = |room: &str| {
        let place = ORDER.iter().position(|rooms| rooms.contains(&room));
        place.unwrap_or_else(|| panic!("the room {room} has no place in the order"))
    };
    let room = &module[0];
    let own = height(room);
    let offence = |(path, line): Named| match roots.get(&path[0]) {
        None => Some(format!("line {line}: crate::{} belongs to no room", path[0])),
        Some(other) if other == room || height(other) < own => None,
        Some(other) => Some(format!("line {line}: crate::{}, of {other}", path[0])),
    };
    paths(source, module).into_iter().filter_map(offence).collect()
}

#[test]
fn no_room_of_the_crate_names_one_above_it() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("../src");
    let roots = roots(&fs::read_to_string(src.join("lib.rs")).unwrap());
    let (mut offending, mut read) = (Vec::new(), BTreeMap::new());
    for (path, module) in files(&src) {
        // A file that no module declares is not part of the crate.
        if roots.contains_key(&module[0]) {
            let offences = offences(&fs::read_to_string(&path).unwrap(), &module, &roots);
            offending.extend(offences.iter().map(|one| format!("{}: {one}", path.display())));
            *read.entry(module[0].clone()).or_insert(0) += 1;
        }
    }
    for room in ["error", "num", "scheme"] {
        assert!(read.get(room).is_some_and(|&count| count > 1), "{room} was not read: {read:?}");
    }
    assert!(offending.is_empty(), "\n{}", offending.join("\n"));
}

#[test]
fn no_two_rooms_of_this_program_name_each_other() {
    let (mut rooms, mut files_of) =
        (BTreeMap::<_, BTreeSet<_>>::new(), BTreeMap::<_, BTreeSet<_>>::new());
    for (path, module) in files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src")) {
        for (to, _) in paths(&fs::read_to_string(path).unwrap(), &module) {
            rooms.entry(module[0].clone()).or_default().insert(to[0].clone());
            if let ([room, from, ..], [other, to, ..]) = (&module[..], &to[..])
                && room == other
            {
                let [from, to] = [from, to].map(|file| format!("{room}/{file}"));
                files_of.entry(from).or_default().insert(to);
            }
        }
    }
    assert!(rooms["figures"].contains("programs"), "imports are not read: {rooms:?}");
    assert!(files_of["figures/demo"].contains("figures/picture"), "nor here: {files_of:?}");
    for mut left in [rooms, files_of] {
        left.iter_mut().for_each(|(from, to)| to.retain(|to| to != from));
        // Take away those that name none that is left, until none is left.
        while !left.is_empty() {
            let all: BTreeSet<String> = left.keys().cloned().collect();
            left.retain(|_, to| to.iter().any(|to| all.contains(to)));
            assert!(left.len() < all.len(), "these name each other: {left:?}");
        }
    }
}

fn module(path: &str) -> Vec<String> {
    path.split("::").map(str::to_owned).collect()
}

/// Shows that the test fails where it should, and names the place.
#[test]
fn what_is_refused() {
    let house = roots(
        "#![no_std] mod error; mod num; #[cfg(feature = \"x\")] pub mod scheme; mod event; pub mod out; pub mod filter;
         pub use error::ConfigError; pub use num::{Sample, SampleKind};
         pub use scheme::{Scheme, codec::Encoder, temporal, other as rate};",
    );
    assert!(!house.contains_key("codec") && !house.contains_key("other"));
    let table: [(&str, &str, &str, &[&str]); 16] = [
        ("below", "num::a", "use crate::error::finite;\nuse crate::{ConfigError, Sample};", &[]),
        ("its own", "scheme::a", "use crate::scheme::code::Code; use super::codec;", &[]),
        ("above", "num::a", "\nuse crate::scheme::Spike;", &["2: crate::scheme"]),
        ("a name of a room above", "num::a", "use crate::Scheme;", &["1: crate::Scheme"]),
        (
            "braces",
            "num::a",
            "use crate::{\n Sample,\n temporal::{A, B}};",
            &["3: crate::temporal", "3: crate::temporal"],
        ),
        ("an expression", "error", "fn f() {\n crate::num::floor(1.0) }", &["2: crate::num"]),
        ("a macro", "error", "macro_rules! m { () => { $crate::Sample }; }", &["1: crate::Sample"]),
        ("super", "num", "use super::scheme::Spike;", &["1: crate::scheme"]),
        ("super of its own", "num::a", "use super::scheme::Spike;", &[]),
        ("super twice", "num::a", "use super::super::{Sample, Scheme};", &["1: crate::Scheme"]),
        ("super in braces", "num::a", "use super::{floor, super::rate};", &["1: crate::rate"]),
        ("a module in the file", "num", "mod tests {\n use super::{floor, rate}; }", &[]),
        (
            "super in it",
            "num",
            "mod t { fn f() {}\n use super::super::rate; }",
            &["2: crate::rate"],
        ),
        ("side by side", "filter::a", "use crate::event::Bank;", &["1: crate::event"]),
        ("what nobody knows", "out::a", "use crate::Nothing;", &["1: crate::Nothing"]),
        (
            "words only",
            "error::a",
            "//! [`x`](crate::Scheme)\n/* crate::Scheme */ const A: &str = \"crate::\\\"Scheme\"; const B: char = '\"';",
            &[],
        ),
    ];
    for (name, own, source, expected) in table {
        let offending = offences(source, &module(own), &house);
        assert_eq!(offending.len(), expected.len(), "{name}: {offending:?}");
        for (offence, expected) in offending.iter().zip(expected) {
            assert!(offence.starts_with(&format!("line {expected}")), "{name}: {offence}");
        }
    }
}

#[test]
#[should_panic(expected = "the room attic has no place in the order")]
fn a_room_without_a_place() {
    offences("", &module("attic"), &BTreeMap::new());
}
