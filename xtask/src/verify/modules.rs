//! The modules of this program that a step of `cargo verify` runs: those that its function names, and all that these import.

use crate::common::paths::root;
use proc_macro2::{Delimiter, Spacing, TokenStream, TokenTree};
use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

/// A path from the crate's root, and its line.
pub type Named = (Vec<String>, usize);

/// Returns all paths in a text that begin at the root: `crate::a::b`, each branch of `crate::{a, b::c}`, and `super::a`
/// in a nested module. `module` is the text's own path from the root.
pub fn paths(source: &str, module: &[String]) -> Vec<Named> {
    let mut found = Vec::new();
    walk(source.parse().unwrap(), module, &mut found);
    found
}

fn walk(tokens: TokenStream, module: &[String], found: &mut Vec<Named>) {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let mut at = 0;
    while let Some(token) = tokens.get(at) {
        match token {
            TokenTree::Ident(word) if is_path(&tokens, at + 1) && word == "crate" => {
                at = branch(&tokens, at + 3, Vec::new(), found);
                continue;
            }
            TokenTree::Ident(word) if is_path(&tokens, at + 1) && word == "super" => {
                at = branch(&tokens, at, module.to_vec(), found);
                continue;
            }
            TokenTree::Group(group) => {
                let inline = at.checked_sub(2).filter(|&at| is_word(&tokens, at, "mod"));
                let inline = inline.map(|at| tokens[at + 1].to_string());
                let module: Vec<String> = module.iter().cloned().chain(inline).collect();
                walk(group.stream(), &module, found);
            }
            _ => {}
        }
        at += 1;
    }
}

/// Parses a path or a tree of paths after its prefix; returns where it ends.
fn branch(
    tokens: &[TokenTree],
    at: usize,
    mut before: Vec<String>,
    found: &mut Vec<Named>,
) -> usize {
    match tokens.get(at) {
        Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Brace => {
            let branches: Vec<TokenTree> = group.stream().into_iter().collect();
            let comma = |token: &TokenTree| matches!(token, TokenTree::Punct(sign) if sign.as_char() == ',');
            for one in branches.split(comma).filter(|one| !one.is_empty()) {
                branch(one, 0, before.clone(), found);
            }
            return at + 1;
        }
        Some(TokenTree::Ident(word)) if word == "super" => {
            assert!(before.pop().is_some(), "super above the root");
        }
        Some(word) => before.push(word.to_string()),
        None => {}
    }
    if is_path(tokens, at + 1) {
        return branch(tokens, at + 3, before, found);
    }
    let line = tokens.get(at).map_or(0, |token| token.span().start().line);
    found.push((before, line));
    at + 1
}

fn is_path(tokens: &[TokenTree], at: usize) -> bool {
    let is_colon =
        |at: usize| matches!(tokens.get(at), Some(TokenTree::Punct(sign)) if sign.as_char() == ':');
    let is_joint =
        matches!(tokens.get(at), Some(TokenTree::Punct(sign)) if sign.spacing() == Spacing::Joint);
    is_joint && is_colon(at) && is_colon(at + 1)
}

fn is_word(tokens: &[TokenTree], at: usize, wanted: &str) -> bool {
    matches!(tokens.get(at), Some(TokenTree::Ident(word)) if word == wanted)
}

/// Returns all Rust files below a directory, each with its module's path.
pub fn files(top: &Path) -> Vec<(PathBuf, Vec<String>)> {
    let (mut found, mut waiting) = (Vec::new(), vec![top.to_path_buf()]);
    while let Some(path) = waiting.pop() {
        if path.is_dir() {
            waiting.extend(fs::read_dir(&path).unwrap().map(|entry| entry.unwrap().path()));
        } else if path.extension().is_some_and(|end| end == "rs") {
            let file = path.strip_prefix(top).unwrap().with_extension("");
            let parts = file.iter().map(|part| part.to_str().unwrap().to_owned());
            found.push((path, parts.filter(|part| part != "mod").collect()));
        }
    }
    found
}

/// A source file of this program.
struct Source {
    /// Path from the repository's top.
    file: String,
    module: Vec<String>,
    /// Modules that it imports.
    imports: BTreeSet<Vec<String>>,
    text: String,
}

/// All modules of this program.
pub struct Modules(Vec<Source>);

impl Modules {
    /// Reads all source files.
    pub fn read() -> Self {
        let files = files(&root().join("xtask/src"));
        let is_module = |named: &[String]| files.iter().any(|(_, module)| module == named);
        let mut sources = Vec::new();
        for (path, module) in &files {
            let text = fs::read_to_string(path).unwrap();
            let mut imports = BTreeSet::new();
            for (named, _) in paths(&text, module) {
                let longest = (1..=named.len()).rev().find(|length| is_module(&named[..*length]));
                imports.extend(longest.map(|length| named[..length].to_vec()));
            }
            let file = path.strip_prefix(root()).unwrap().to_str().unwrap().to_owned();
            sources.push(Source { file, module: module.clone(), imports, text });
        }
        Self(sources)
    }

    /// Returns the files of the modules that an expression names before `::`, and of all modules that these import.
    pub fn behind(&self, expression: &str) -> BTreeSet<String> {
        let joined = expression.replace(" ::", "::");
        let words =
            joined.split(|sign: char| !(sign.is_alphanumeric() || sign == '_' || sign == ':'));
        let names: Vec<&str> = words.flat_map(|word| word.rsplit("::").skip(1)).collect();
        let is_named = |source: &&Source| {
            source.module.last().is_some_and(|name| names.contains(&name.as_str()))
        };
        let mut waiting: Vec<&[String]> =
            self.0.iter().filter(is_named).map(|source| source.module.as_slice()).collect();
        let mut found = BTreeSet::new();
        while let Some(wanted) = waiting.pop() {
            // A module stands for those below it, whose names it may export as its own.
            for source in self.0.iter().filter(|source| source.module.starts_with(wanted)) {
                if found.insert(source.file.clone()) {
                    waiting.extend(source.imports.iter().map(Vec::as_slice));
                }
            }
        }
        found
    }

    /// Returns whether one of the files names a crate.
    pub fn name(&self, files: &BTreeSet<String>, package: &str) -> bool {
        let path = format!("{}::", package.replace('-', "_"));
        self.0.iter().any(|source| files.contains(&source.file) && source.text.contains(&path))
    }
}
