//! The crate's rooms stand in the order of the data's way, and no module names one that stands above its own.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The rooms from the lowest to the highest. Those of one line stand side by side, and none names the other.
const ORDER: [&[&str]; 9] = [
    &["serial"], // what serde does not derive
    &["error"],
    &["num"],
    &["scheme"],
    &["event"],
    &["frame"],
    &["wire"],
    &["out", "chip"],
    &["lib"],
];

fn height(room: &str) -> Option<usize> {
    ORDER.iter().position(|rooms| rooms.contains(&room))
}

/// A word or a sign of Rust's text, with its line.
type Token = (String, usize);

/// The tokens of a text, as far as paths and blocks go: without comments, literals and lifetimes.
fn tokens(source: &str) -> Vec<Token> {
    let mut tokens = Vec::new();
    let mut rest = source;
    let mut line = 1;
    while let Some(first) = rest.chars().next() {
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if first == '"' {
            quoted(rest)
        } else if rest.starts_with("'\\") || rest.chars().nth(2) == Some('\'') && first == '\'' {
            character(rest)
        } else if first.is_alphanumeric() || first == '_' {
            rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len())
        } else {
            first.len_utf8()
        };
        let (token, after) = rest.split_at(length);
        let is_text = token.starts_with("//") || token.starts_with("/*") || first == '"';
        if !is_text && first != '\'' && !first.is_whitespace() {
            tokens.push((token.to_owned(), line));
        }
        line += token.matches('\n').count();
        rest = after;
    }
    tokens
}

/// How long a character literal is, its quotes included.
fn character(text: &str) -> usize {
    let shortest = if text.starts_with("'\\") { 3 } else { 2 };
    shortest + 1 + text[shortest..].find('\'').expect("a character ends")
}

/// How long a string literal is, its quotes included.
fn quoted(text: &str) -> usize {
    let mut is_escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            '"' if !is_escaped => return at + 1,
            '\\' => is_escaped = !is_escaped,
            _ => is_escaped = false,
        }
    }
    panic!("a string does not end: {text}")
}

/// The names that stand directly below the crate's root in every path of a text, with their lines: of
/// `crate::a::b`, of each branch of `crate::{a, b::c}`, and of `super::a` where `super` is the root.
///
/// `depth` is how many modules the text's own lies below the root. A `*` stands for all names.
fn named(source: &str, depth: usize) -> Vec<Token> {
    let tokens = tokens(source);
    let word = |at: usize| tokens.get(at).map_or("", |(token, _)| token);
    let is_path = |at: usize| word(at) == ":" && word(at + 1) == ":";
    let mut named = Vec::new();
    // One entry for each open brace: whether it is an inline module's.
    let mut braces = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        match word(at) {
            "{" => braces.push(at >= 2 && word(at - 2) == "mod"),
            "}" => drop(braces.pop()),
            "crate" if is_path(at + 1) => {
                at += 3;
                heads(&tokens, at, &mut named);
                continue;
            }
            "super" if is_path(at + 1) => {
                let mut level = depth + braces.iter().filter(|&&is_module| is_module).count();
                while word(at) == "super" && is_path(at + 1) {
                    assert!(level > 0, "super above the root in line {}", tokens[at].1);
                    level -= 1;
                    at += 3;
                }
                if level == 0 {
                    heads(&tokens, at, &mut named);
                } else if word(at) == "{" {
                    let mut branches = Vec::new();
                    heads(&tokens, at, &mut branches);
                    // Written so, a path cannot be followed.
                    named.extend(branches.into_iter().filter(|(name, _)| name == "super"));
                }
                continue;
            }
            _ => {}
        }
        at += 1;
    }
    named
}

/// The first names of a path, or of every branch of a tree in braces.
fn heads(tokens: &[Token], at: usize, named: &mut Vec<Token>) {
    if tokens[at].0 != "{" {
        named.push(tokens[at].clone());
        return;
    }
    let mut depth = 0;
    let mut is_head = true;
    for (token, line) in &tokens[at..] {
        match token.as_str() {
            "{" => depth += 1,
            "}" => depth -= 1,
            "," if depth == 1 => is_head = true,
            _ if depth == 1 && is_head => {
                named.push((token.clone(), *line));
                is_head = false;
            }
            _ => {}
        }
        if depth == 0 {
            return;
        }
    }
}

/// The rooms that the root declares, and the room of each name that it makes public or takes up.
fn roots(lib: &str) -> BTreeMap<String, String> {
    let tokens = tokens(lib);
    let word = |at: usize| tokens.get(at).map_or("", |(token, _)| token);
    let mut roots = BTreeMap::new();
    for at in 0..tokens.len() {
        if word(at) == "mod" && word(at + 2) == ";" {
            roots.insert(word(at + 1).to_owned(), word(at + 1).to_owned());
        }
    }
    for at in 0..tokens.len() {
        let is_path = word(at + 2) == ":" && word(at + 3) == ":";
        if word(at) == "use" && is_path && roots.contains_key(word(at + 1)) {
            let room = word(at + 1).to_owned();
            let end = (at..tokens.len()).find(|&end| word(end) == ";").expect("a use ends");
            // Of `a::b::C` or `a::{b, c::D, e as F}`: the last word before each comma or closing brace.
            for name in at + 2..end {
                if matches!(word(name + 1), "," | "}" | ";") && !matches!(word(name), "," | "}") {
                    roots.insert(word(name).to_owned(), room.clone());
                }
            }
        }
    }
    roots
}

/// What a text of this room may not name, or names and nobody knows: one line each.
fn offences(
    source: &str,
    file: &str,
    room: &str,
    depth: usize,
    roots: &BTreeMap<String, String>,
) -> Vec<String> {
    let own =
        height(room).unwrap_or_else(|| panic!("{file}: the room {room} has no place in the order"));
    let offence = |(name, line): &Token| {
        let place = format!("src/{file}:{line}");
        let Some(other) = roots.get(name) else {
            return Some(format!("{place}: crate::{name} belongs to no room"));
        };
        let above =
            height(other).unwrap_or_else(|| panic!("the room {other} has no place in the order"));
        let is_allowed = other == room || above < own;
        (!is_allowed).then(|| format!("{place}: {room} names crate::{name}, of {other}"))
    };
    named(source, depth).iter().filter_map(offence).collect()
}

/// All files of Rust below a directory.
fn files(directory: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else if path.extension().is_some_and(|end| end == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Every room that the root declares, from top to bottom.
#[test]
fn no_room_names_one_above_it() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("../src");
    let roots = roots(&fs::read_to_string(src.join("lib.rs")).unwrap());
    let mut offending = Vec::new();
    let mut read = BTreeMap::new();
    for path in files(&src) {
        let file = path.strip_prefix(&src).unwrap().with_extension("");
        let mut modules: Vec<_> = file.iter().map(|part| part.to_str().unwrap()).collect();
        if modules.last() == Some(&"mod") {
            modules.pop();
        }
        let room = modules[0];
        // A file that no module declares is not part of the crate.
        if roots.contains_key(room) {
            *read.entry(room.to_owned()).or_insert(0) += 1;
            let source = fs::read_to_string(&path).unwrap();
            let name = path.strip_prefix(&src).unwrap().display().to_string();
            offending.extend(offences(&source, &name, room, modules.len(), &roots));
        }
    }
    for room in ["error", "num", "scheme"] {
        assert!(read.get(room).is_some_and(|&count| count > 1), "{room} was not read: {read:?}");
    }
    assert!(offending.is_empty(), "\n{}", offending.join("\n"));
}

fn house() -> BTreeMap<String, String> {
    roots(
        "#![no_std]\nmod error; mod num; #[cfg(feature = \"x\")] pub mod scheme; mod event; pub mod out; pub mod chip;
         pub use error::ConfigError;
         pub use num::{Sample, SampleKind};
         pub use scheme::{Scheme, codec::Encoder, temporal, other as rate};",
    )
}

#[test]
fn what_the_root_names() {
    let table = [
        ("num", Some("num")),
        ("scheme", Some("scheme")),
        ("chip", Some("chip")),
        ("ConfigError", Some("error")),
        ("SampleKind", Some("num")),
        ("Encoder", Some("scheme")),
        ("temporal", Some("scheme")),
        ("rate", Some("scheme")),
        ("codec", None),
        ("other", None),
        ("core", None),
    ];
    let house = house();
    for (name, room) in table {
        assert_eq!(house.get(name).map(String::as_str), room, "{name}");
    }
}

/// The test fails where it should, and says where.
#[test]
fn what_is_refused() {
    let table: [(&str, &str, usize, &str, &[&str]); 16] = [
        (
            "from below",
            "num",
            2,
            "use crate::error::finite;\nuse crate::{ConfigError, Sample};",
            &[],
        ),
        ("from its own", "scheme", 2, "use crate::scheme::code::Code; use super::codec;", &[]),
        ("a room above", "num", 2, "\nuse crate::scheme::Spike;", &["2 scheme"]),
        ("a name of a room above", "num", 2, "use crate::Scheme;", &["1 Scheme"]),
        (
            "in braces",
            "num",
            2,
            "use crate::{\n    Sample,\n    temporal::{A, B},\n};",
            &["3 temporal"],
        ),
        ("in an expression", "error", 1, "fn f() {\n crate::num::floor(1.0) }", &["2 num"]),
        ("by super", "num", 1, "use super::scheme::Spike;", &["1 scheme"]),
        ("by super of its own", "num", 2, "use super::scheme::Spike;", &[]),
        ("by super twice", "num", 2, "use super::super::{Sample, Scheme};", &["1 Scheme"]),
        ("in a module in the file", "num", 1, "mod tests {\n use super::{floor, rate}; }", &[]),
        ("what cannot be followed", "num", 2, "use super::{floor, super::num};", &["1 super"]),
        (
            "by super in it",
            "num",
            1,
            "mod tests { fn f() {}\n use super::super::rate; }",
            &["2 rate"],
        ),
        ("after it", "num", 1, "mod tests { }\nuse super::rate;", &["2 rate"]),
        ("side by side", "chip", 2, "use crate::out::Batch;", &["1 out"]),
        ("what nobody knows", "chip", 2, "use crate::Nothing;", &["1 Nothing"]),
        (
            "in words only",
            "error",
            2,
            "//! [`x`](crate::Scheme)\n/* crate::Scheme */ const A: &str = \"crate::\\\"Scheme\"; const B: char = '\"'; fn f<'a>(a: &'a str) {}",
            &[],
        ),
    ];
    let house = house();
    for (name, room, depth, source, expected) in table {
        let offending = offences(source, "x.rs", room, depth, &house);
        assert_eq!(offending.len(), expected.len(), "{name}: {offending:?}");
        for (offence, expected) in offending.iter().zip(expected) {
            let (line, path) = expected.split_once(' ').unwrap();
            assert!(offence.starts_with(&format!("src/x.rs:{line}: ")), "{name}: {offence}");
            assert!(offence.contains(&format!("crate::{path}")), "{name}: {offence}");
        }
    }
}

#[test]
#[should_panic(expected = "the room attic has no place in the order")]
fn a_room_without_a_place() {
    offences("", "attic/mod.rs", "attic", 1, &house());
}
