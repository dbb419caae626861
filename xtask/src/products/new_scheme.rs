//! `cargo xtask scheme NAME TYPE --like NAME`: writes the beginnings of a scheme, which compile at once.
//!
//! In the crate and in the catalogue they are a copy of an existing scheme under another name, with the lines that list
//! it. The reference and its test begin empty: copied, they would prove nothing.

use crate::common::{cargo, command, output, paths, run, usage};
use anyhow::{Context, Result, ensure};
use catalogue::INFO;
use std::{
    fs,
    path::{Path, PathBuf},
};

pub const USAGE: &str =
    "cargo xtask scheme NAME TYPE --like NAME, as in: trial TrialForward --like sf";

/// Files of the reference and its test: their directories, what they are, and the files that list them.
const BY_HAND: [(&str, &str, &str); 2] = [
    ("host-tests/src/reference", "once more, from the paper alone and in doubles", "mod.rs"),
    ("host-tests/tests", "against the reference", "codes.rs"),
];

/// Tables with a row for each scheme. A new row has the type's name alone: another scheme's words would lie.
const PAGES: [&str; 4] =
    ["src/lib.rs", "docs/schemes.md", "docs/codes.md", "src/scheme/fingerprint.rs"];

pub fn new_scheme(args: &[String]) -> Result<()> {
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    let [name, type_name, "--like", like] = args[..] else { return Err(usage(USAGE.into())) };
    let like = INFO.iter().find(|info| info.name == like).ok_or_else(|| {
        let names: Vec<_> = INFO.iter().map(|info| info.name).collect();
        usage(format!("no scheme `{like}`; there are {}", names.join(", ")))
    })?;
    if INFO.iter().any(|info| info.name == name || info.type_name == type_name) {
        return Err(usage(format!("`{name}` or `{type_name}` is there already")));
    }
    let names = Names::new((like.name, like.type_name), (name, type_name))?;
    for file in names.write(&paths::root())? {
        println!("{file}");
    }
    run(&mut cargo("fmt --package spikewire --package catalogue --package host-tests"))?;
    println!(
        "By hand now: the law in the first, names and parameters in the second, the rows' empty cells, and \
         host-tests/src/reference/{module}.rs and host-tests/tests/{module}.rs, which are empty; then `cargo xtask write`. \
         `cargo test --package host-tests --test codes every_scheme` names what is missing.",
        module = names.new.module
    );
    Ok(())
}

/// The names of a scheme.
struct Called {
    /// Name on the command line: `step-forward`.
    name: String,
    /// Name of its type: `StepForward`.
    type_name: String,
    /// Name of its file in the crate: `step_forward`.
    module: String,
    /// Name of its file in the catalogue.
    entry: String,
}

impl Called {
    fn new(name: &str, type_name: &str, module: String) -> Self {
        Self { name: name.into(), type_name: type_name.into(), module, entry: snake(name) }
    }
}

/// The names of the scheme that is copied, and those of the new one.
struct Names {
    /// Directory of its file, from the repository's top.
    room: PathBuf,
    old: Called,
    new: Called,
}

impl Names {
    fn new(old: (&str, &str), new: (&str, &str)) -> Result<Self> {
        let (room, module) = declared(&paths::root().join("src/scheme"), old.1)?;
        Ok(Self {
            room: Path::new("src/scheme").join(room),
            old: Called::new(old.0, old.1, module),
            new: Called::new(new.0, new.1, snake(new.1)),
        })
    }

    /// Replaces the old scheme's names in a text by the new one's.
    fn renamed(&self, text: &str) -> String {
        let (old, new) = (&self.old, &self.new);
        replaced(text, &old.type_name, &new.type_name)
            .replace(&format!("\"{}\"", old.name), &format!("\"{}\"", new.name))
            .replace(&format!("`{}`", old.name), &format!("`{}`", new.name))
            .replace(&format!("\"{}\"", old.module), &format!("\"{}\"", new.module))
    }

    /// Writes the files; returns their paths.
    fn write(&self, root: &Path) -> Result<Vec<String>> {
        let (old, new, room) = (&self.old, &self.new, root.join(&self.room));
        let entries = root.join("laptop/catalogue/src");
        let copies = [
            (room.clone(), &old.module, &new.module),
            (entries.join("schemes"), &old.entry, &new.entry),
        ];
        let mut files = Vec::new();
        for (room, from, to) in copies {
            let target = room.join(format!("{to}.rs"));
            ensure!(!target.exists(), "{} is there already", target.display());
            let text = fs::read_to_string(room.join(format!("{from}.rs")))?;
            fs::write(&target, self.renamed(&text))?;
            files.push(target);
        }
        let module = room.join("mod.rs");
        let text = fs::read_to_string(&module)?;
        fs::write(
            &module,
            self.listed(&text, &|line| {
                line.contains(&format!("{};", old.module))
                    || line.contains(&format!("{}::", old.module))
            }),
        )?;
        let list = entries.join("lib.rs");
        let text = fs::read_to_string(&list)?;
        fs::write(&list, self.listed(&text, &|line| line.trim() == format!("{},", old.entry)))?;
        files.extend([module, list]);
        for page in PAGES {
            let page = root.join(page);
            let text = fs::read_to_string(&page)?;
            let is_row =
                |line: &str| line.contains('|') && replaced(line, &old.type_name, "") != line;
            fs::write(&page, self.without_words(&self.listed(&text, &is_row)))?;
            files.push(page);
        }
        for (room, words, list) in BY_HAND {
            let (room, module) = (root.join(room), &new.module);
            let file = room.join(format!("{module}.rs"));
            fs::write(&file, format!("//! `{}` {words}.\n", new.type_name))?;
            let list = room.join(list);
            let text = inserted(&fs::read_to_string(&list)?, &format!("mod {module};"));
            let text = inserted(&text, &format!("pub use {module}::*;"));
            fs::write(&list, text)?;
            files.extend([file, list]);
        }
        let shown = |file: PathBuf| file.strip_prefix(root).unwrap_or(&file).display().to_string();
        Ok(files.into_iter().map(shown).collect())
    }

    /// Empties the cells of the new scheme's rows, except that with its name.
    fn without_words(&self, page: &str) -> String {
        let mut lines = Vec::new();
        for line in page.lines() {
            let is_row = line.contains('|') && line.contains(&self.new.type_name);
            let cells = line.split('|').enumerate().map(|(place, cell)| {
                let is_margin = place == 0 || cell.is_empty();
                if is_margin || cell.contains(&self.new.type_name) { cell } else { " " }
            });
            lines.push(if is_row { cells.collect::<Vec<_>>().join("|") } else { line.to_owned() });
        }
        lines.join("\n") + "\n"
    }

    /// Duplicates each line that lists the old scheme, for the new one.
    fn listed(&self, text: &str, is_listed: &dyn Fn(&str) -> bool) -> String {
        let mut lines = Vec::new();
        for line in text.lines() {
            lines.push(line.to_owned());
            if is_listed(line) {
                let again = line
                    .replace(&format!("{};", self.old.module), &format!("{};", self.new.module));
                let again = again
                    .replace(&format!("{}::", self.old.module), &format!("{}::", self.new.module));
                let again =
                    again.replace(&format!("{},", self.old.entry), &format!("{},", self.new.entry));
                lines.push(self.renamed(&again));
            }
        }
        lines.join("\n") + "\n"
    }
}

/// Inserts a line before those that begin with the same word, if there are any; rustfmt sorts them. The module `common`
/// is kept apart.
fn inserted(text: &str, line: &str) -> String {
    let (word, _) = line.split_once(' ').unwrap_or((line, ""));
    let is_listed = |other: &&str| other.starts_with(word) && *other != "mod common;";
    text.lines().find(is_listed).map_or_else(
        || text.to_owned(),
        |first| text.replacen(&format!("\n{first}\n"), &format!("\n{line}\n{first}\n"), 1),
    )
}

/// Replaces the beginnings of words: `StepForward` in `StepForwardState`, but not in `AdaptiveStepForward`.
fn replaced(text: &str, from: &str, to: &str) -> String {
    let mut parts = text.split(from);
    let mut done = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let is_within = done.ends_with(|letter: char| letter.is_alphanumeric());
        done.push_str(if is_within { from } else { to });
        done.push_str(part);
    }
    done
}

/// Returns the directory and the file, without its ending, in which a type is declared.
fn declared(rooms: &Path, type_name: &str) -> Result<(PathBuf, String)> {
    for room in fs::read_dir(rooms)?.collect::<Result<Vec<_>, _>>()? {
        let Ok(files) = fs::read_dir(room.path()) else { continue };
        for file in files.collect::<Result<Vec<_>, _>>()? {
            let text = fs::read_to_string(file.path()).unwrap_or_default();
            if text.contains(&format!("pub struct {type_name}<")) {
                let module = file.path().file_stem().context("no name")?.to_string_lossy().into();
                return Ok((room.file_name().into(), module));
            }
        }
    }
    anyhow::bail!("no file of src/scheme declares `{type_name}`: take another scheme to begin from")
}

/// Converts `TrialForward` or `trial-forward` to a module's name.
fn snake(name: &str) -> String {
    let mut snake = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !snake.is_empty() {
            snake.push('_');
        }
        snake.extend(letter.to_lowercase());
    }
    snake.replace('-', "_")
}

/// Makes a scheme in a copy of the repository's files, which must compile there.
pub fn verify() -> Result<()> {
    let copy = tempfile::tempdir()?;
    let files =
        output(command("git").args(["ls-files", "--cached", "--others", "--exclude-standard"]))?;
    for file in files.lines().filter(|file| paths::root().join(file).is_file()) {
        let to = copy.path().join(file);
        fs::create_dir_all(to.parent().context("a file without directory")?)?;
        fs::copy(paths::root().join(file), to)?;
    }
    let names = Names::new(("sf", "StepForward"), ("trial", "TrialForward"))?;
    let files = names.write(copy.path())?;
    let mut check = cargo("check --package catalogue --all-features --all-targets");
    run(check
        .current_dir(copy.path())
        .env("CARGO_TARGET_DIR", paths::target().join("new-scheme")))?;
    println!("A scheme to begin from compiles; {} files are written.", files.len());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_listed_where_there_is_a_list() {
        let text = "//! x\n\nmod common;\n\nmod bank;\nmod slots;\n\npub use bank::{\n    a,\n};\n";
        let with = text.replace("mod bank;", "mod hough;\nmod bank;");
        assert_eq!(inserted(text, "mod hough;"), with);
        let with = text.replace("pub use bank", "pub use trial::*;\npub use bank");
        assert_eq!(inserted(text, "pub use trial::*;"), with);
        assert_eq!(inserted("fn f() {}\n", "mod x;"), "fn f() {}\n");
    }
}
