//! Makes a copy of the repository, whose crates have each change behind a switch.

use super::{
    CRATES, Out,
    changes::Change,
    schemata::{Sites, switched},
};
use crate::common::{
    paths,
    shell::{command, run},
};
use anyhow::{Context, Result, ensure};
use serde_json::Value;
use std::{
    collections::BTreeMap,
    env, fs,
    hash::{DefaultHasher, Hash, Hasher},
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

/// A program of tests.
pub struct Program {
    pub name: String,
    pub path: PathBuf,
    /// Directory of its package, in which it is started.
    pub package: PathBuf,
}

pub struct Copy {
    top: PathBuf,
    /// The changes that get a switch.
    switched: Vec<usize>,
    pub out: BTreeMap<usize, Out>,
}

impl Copy {
    /// Makes the copy below `target/mutants`. Everything except the crates' sources is a link.
    pub fn new(switched: Vec<usize>) -> Result<Self> {
        let top = paths::target().join("mutants/tree");
        link(Path::new(""), &top)?;
        Ok(Self { top, switched, out: BTreeMap::new() })
    }

    /// Compiles the tests without the changes that the compiler rejects. Which these are is stored until the crate
    /// changes.
    pub fn programs(&mut self, changes: &[Change]) -> Result<Vec<Program>> {
        let kept = kept()?;
        self.out = fs::read(&kept)
            .ok()
            .and_then(|out| serde_json::from_slice(&out).ok())
            .unwrap_or_default();
        let packages = CRATES.map(|(name, _)| format!(" --package {name}")).concat();
        self.compile(changes, &format!("check{packages} --all-features"))?;
        fs::write(&kept, serde_json::to_string(&self.out)?)?;
        let tests = env::var("MUTANTS_TESTS")
            .unwrap_or_else(|_| "catalogue cameras chips codes wire".into());
        let (own, tests): (Vec<_>, Vec<_>) =
            tests.split(' ').partition(|name| *name == "catalogue");
        let tests = tests.iter().map(|name| format!(" --test {name}")).collect::<String>();
        let build = format!("test --no-run{packages} --package host-tests --lib{tests}");
        let mut told = self.compile(changes, &build)?;
        if !own.is_empty() {
            told.extend(self.compile(changes, "test --no-run --package catalogue --lib")?);
        }
        fs::write(kept, serde_json::to_string(&self.out)?)?;
        let programs = told.iter().filter_map(|message| {
            let path = message["executable"].as_str()?.into();
            let name = message["target"]["name"].as_str()?.to_owned();
            let package = Path::new(message["manifest_path"].as_str()?).parent()?.to_owned();
            Some(Program { name, path, package })
        });
        Ok(programs.collect())
    }

    fn compile(&mut self, changes: &[Change], arguments: &str) -> Result<Vec<Value>> {
        loop {
            self.write(changes)?;
            let told =
                self.cargo().args(arguments.split(' ')).arg("--message-format=json").output()?;
            let messages: Vec<Value> =
                told.stdout.split(|byte| *byte == b'\n').flat_map(serde_json::from_slice).collect();
            if told.status.success() {
                return Ok(messages);
            }
            let before = self.out.len();
            let errors = messages
                .iter()
                .map(|message| &message["message"])
                .filter(|message| message["level"] == "error");
            for error in errors {
                for span in error["spans"].as_array().into_iter().flatten() {
                    self.take_out(span)?;
                }
            }
            let said = String::from_utf8_lossy(&told.stderr);
            let shown: Vec<&str> = messages
                .iter()
                .filter_map(|message| message["message"]["rendered"].as_str())
                .collect();
            ensure!(
                self.out.len() > before,
                "the copy does not compile:\n{said}\n{}",
                shown.join("\n")
            );
            println!("{} changes do not compile, or have no switch", self.out.len());
        }
    }

    /// Removes the changes to which an error points.
    fn take_out(&mut self, span: &Value) -> Result<()> {
        let (Some(file), Some(at)) = (span["file_name"].as_str(), span["byte_start"].as_u64())
        else {
            return Ok(());
        };
        let file = self.top.join(file);
        let is_changed = |(_, source): &(_, &str)| file.starts_with(self.top.join(source));
        if CRATES.iter().any(is_changed) && span["is_primary"] == true {
            let text = fs::read_to_string(file)?;
            self.out.extend(innermost(&text[..at as usize]));
        }
        Ok(())
    }

    fn write(&mut self, changes: &[Change]) -> Result<()> {
        let mut files: BTreeMap<&str, Sites> = BTreeMap::new();
        for number in self.switched.iter().filter(|number| !self.out.contains_key(number)) {
            let change = &changes[*number];
            let sites = files.entry(&change.file).or_default();
            sites.entry(change.site()).or_default().push((*number, change.replacement.clone()));
        }
        for file in all_sources()? {
            let name = file.strip_prefix(paths::root())?;
            let text = fs::read_to_string(&file)?;
            let sites = files.remove(name.to_str().context("a file's name is no text")?);
            let (mut text, out) = switched(&text, &sites.unwrap_or_default())?;
            self.out.extend(out);
            if CRATES.iter().any(|(_, source)| name == Path::new(source).join("lib.rs")) {
                // Features before what else is said of the whole crate, modules behind it.
                for (old, new) in [
                    ("#[cfg(test)]\nextern crate std;", ""),
                    ("#![no_std]", "#![no_std]\n#![feature(core_intrinsics, const_eval_select)]"),
                    (FORBID, &*format!("{FORBID}\nextern crate std;\nmod mutant;")),
                ] {
                    text = text.replacen(old, new, 1);
                }
            }
            write_if_new(&self.top.join(name), &text)?;
        }
        let switch =
            format!("{}\nconst CHANGES: usize = {};\n", include_str!("switch.rs"), changes.len());
        for (_, source) in CRATES {
            write_if_new(&self.top.join(source).join("mutant.rs"), &switch)?;
        }
        Ok(())
    }

    /// Prepares cargo in the copy. Tests run many times, so they are optimised a little.
    fn cargo(&self) -> Command {
        let mut cargo = Command::new("cargo");
        cargo
            .current_dir(&self.top)
            .env("CARGO_TARGET_DIR", paths::target().join("mutants/build"))
            .env("CARGO_INCREMENTAL", "0")
            .env("CARGO_PROFILE_DEV_OPT_LEVEL", "1")
            .env("RUSTFLAGS", "--cap-lints=allow")
            // The switch asks whether it runs within a constant, which only the compiler's own library may.
            .env("RUSTC_BOOTSTRAP", CRATES.map(|(name, _)| name.replace('-', "_")).join(","))
            .stderr(Stdio::inherit());
        cargo
    }
}

/// The last attribute of a crate's root.
const FORBID: &str = "#![forbid(unsafe_code)]";

/// Links everything in a directory except for sources; makes the directories that lead to them.
fn link(below: &Path, top: &Path) -> Result<()> {
    fs::create_dir_all(top.join(below))?;
    for entry in fs::read_dir(paths::root().join(below))? {
        let name = below.join(entry?.file_name());
        let is_own = CRATES.iter().any(|(_, source)| name == Path::new(source));
        if is_own || [".git", "target"].iter().any(|left| name == Path::new(left)) {
            continue;
        }
        if CRATES.iter().any(|(_, source)| Path::new(source).starts_with(&name)) {
            link(&name, top)?;
        } else if !top.join(&name).exists() {
            run(command("ln").arg("-s").arg(paths::root().join(&name)).arg(top.join(&name)))?;
        }
    }
    Ok(())
}

/// Returns the path of the stored list of rejected changes, for the present crates.
fn kept() -> Result<PathBuf> {
    let mut hasher = DefaultHasher::new();
    for file in all_sources()? {
        (&file, fs::read(&file)?).hash(&mut hasher);
    }
    Ok(paths::target().join(format!("mutants/out-{:016x}.json", hasher.finish())))
}

fn write_if_new(file: &Path, text: &str) -> Result<()> {
    if fs::read_to_string(file).is_ok_and(|old| old == text) {
        return Ok(());
    }
    fs::create_dir_all(file.parent().context("a file without a directory")?)?;
    Ok(fs::write(file, text)?)
}

fn all_sources() -> Result<Vec<PathBuf>> {
    let all = CRATES.map(|(_, source)| sources(&paths::root().join(source)));
    Ok(all.into_iter().collect::<Result<Vec<_>>>()?.concat())
}

/// All Rust files below a directory.
fn sources(directory: &Path) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(directory)? {
        let path = entry?.path();
        if path.is_dir() {
            files.extend(sources(&path)?);
        } else {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

/// Returns the innermost changes within whose marks the text ends.
fn innermost(text: &str) -> Vec<(usize, Out)> {
    let mut open: Vec<(usize, Out, usize)> = Vec::new();
    for (start, _) in text.match_indices("/*") {
        let Some(mark) = text[start + 2..].split_once("*/").map(|(mark, _)| mark) else { continue };
        let end = start + mark.len() + 4;
        let number = |digits: Option<&str>| digits.and_then(|digits| digits.parse::<usize>().ok());
        if let Some(change) = number(mark.strip_prefix('<')) {
            open.push((change, Out::DoesNotCompile, end));
        } else if let Some(change) = number(mark.strip_prefix('{')) {
            open.push((change, Out::NoSwitch, end));
        } else if let Some(change) = number(mark.strip_suffix(['>', '}']))
            && let Some(last) = open.iter().rposition(|(opened, ..)| *opened == change)
        {
            open.remove(last);
        }
    }
    // Marks of several changes at one place stand side by side.
    let mut found = Vec::new();
    let mut before = open.last().map_or(0, |(.., end)| *end);
    while let Some((change, out, end)) = open.pop().filter(|(.., end)| *end == before) {
        found.push((change, out));
        before = end - format!("/*<{change}*/").len();
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_that_of_the_innermost_change() {
        let of = |text| innermost(text).into_iter().map(|(change, _)| change).collect::<Vec<_>>();
        assert_eq!(of("/*{1*//*{2*/match (/*{3*/a"), [3]);
        assert_eq!(of("/*{1*//*{2*/match (/*{3*/a/*3}*/)"), [2, 1]);
        assert_eq!(of("/*<4*/a/*4>*/ /* a comment */ b"), [0; 0]);
    }
}
