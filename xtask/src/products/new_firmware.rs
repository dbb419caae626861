//! `cargo xtask new-firmware DIR --board NAME`: writes a project for a board, outside this workspace, that builds at
//! once.
//!
//! Its files are those of `examples/boards`, without the other boards.

use crate::common::{paths, usage};
use crate::products::parts::{BOARDS, Part};
use anyhow::{Context, Result, ensure};
use std::{
    fs,
    path::{Path, PathBuf},
};
use toml::{Table, Value};

pub const USAGE: &str = "cargo xtask new-firmware DIR --board NAME [--git URL]";

/// Where a project finds the crate and its companions.
pub enum Origin {
    /// A directory with this repository's files.
    Path(PathBuf),
    /// A URL for git.
    Git(String),
}

/// Packages that a project takes from there, with their directories.
const PACKAGES: [(&str, &str); 3] =
    [("spikewire", ""), ("flight", "examples/flight"), ("icm42688p", "examples/icm42688p")];

/// Error text for a feature that is not a list.
const ARRAYS: &str = "a feature is a list of texts";

pub fn new_firmware(args: &[String]) -> Result<()> {
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    let (directory, board, origin) = match args[..] {
        [directory, "--board", board] => (directory, board, Origin::Path(paths::root())),
        [directory, "--board", board, "--git", url] => (directory, board, Origin::Git(url.into())),
        _ => return Err(usage(format!("{USAGE}\nboards: {}", names()))),
    };
    let directory = std::env::current_dir()?.join(directory);
    let part = BOARDS.iter().find(|part| part.name == board);
    let part = part.ok_or_else(|| usage(format!("no board `{board}`; there are {}", names())))?;
    ensure!(!directory.exists(), "{} is there already", directory.display());
    write(&directory, part, &origin)?;
    println!("{}: firmware for {}. In it:", directory.display(), part.name);
    println!("  cargo build --release    # with this compiler's target {}", part.target);
    println!("  {}", part.flash);
    println!("  spikewire listen --baud {} PORT {}", part.baud, part.listen);
    Ok(())
}

fn names() -> String {
    BOARDS.map(|part| part.name).join(", ")
}

/// Writes the project's files.
pub fn write(directory: &Path, part: &Part, origin: &Origin) -> Result<()> {
    let from = paths::examples().join("boards");
    let read = |path: String| fs::read_to_string(from.join(&path)).context(path);
    let manifest: Table = read("Cargo.toml".into())?.parse()?;
    let files = [
        ("Cargo.toml", self::manifest(manifest, directory, part, origin)?),
        (".cargo/config.toml", config(part)),
        ("memory.x", read(format!("memory/{}.x", part.memory))?),
        ("build.rs", build_script(part)),
        ("src/main.rs", alone(&read("src/main.rs".into())?, part.name)),
        ("src/board.rs", alone(&read(format!("src/board/{}.rs", part.board))?, part.name)),
        ("src/part.rs", alone(&read(format!("src/part/{}.rs", part.part))?, part.name)),
    ];
    for (name, text) in files {
        let path = directory.join(name);
        fs::create_dir_all(path.parent().context("a file lies in a directory")?)?;
        fs::write(path, text)?;
    }
    Ok(())
}

/// Returns the manifest with this board's dependencies only, and their features.
fn manifest(mut all: Table, directory: &Path, part: &Part, origin: &Origin) -> Result<String> {
    let name = directory.file_name().context("a directory has a name")?.to_string_lossy();
    let mut dependencies = table(&mut all, "dependencies")?;
    let features = table(&mut all, "features")?;
    let mut asked = vec![part.name.to_owned()];
    while let Some(feature) = asked.pop() {
        if let Some((dependency, feature)) = feature.split_once('/') {
            enable(&mut dependencies, dependency, Some(feature))?;
        } else if let Some(dependency) = feature.strip_prefix("dep:") {
            enable(&mut dependencies, dependency, None)?;
        } else {
            let more = features.get(&feature).and_then(Value::as_array);
            for one in more.with_context(|| format!("no feature `{feature}`"))? {
                asked.push(one.as_str().context(ARRAYS)?.into());
            }
        }
    }
    dependencies.retain(|_, value| value.get("optional").is_none());
    let mut patched = Table::new();
    for (package, place) in PACKAGES {
        let source = match origin {
            Origin::Path(root) => ("path", root.join(place).display().to_string()),
            Origin::Git(url) => ("git", url.clone()),
        };
        let source = Table::from_iter([(source.0.to_owned(), Value::String(source.1))]);
        if package == "spikewire" {
            patched.insert(package.into(), source.into());
        } else if let Some(Value::Table(dependency)) = dependencies.get_mut(package) {
            dependency.remove("path");
            dependency.extend(source);
        }
    }
    let package = Table::from_iter([
        ("name".to_owned(), Value::from(&*name)),
        ("version".to_owned(), Value::from("0.1.0")),
        ("edition".to_owned(), Value::from("2024")),
    ]);
    let patch = Table::from_iter([("crates-io".to_owned(), patched.into())]);
    let project = Table::from_iter([
        ("package".to_owned(), package.into()),
        ("dependencies".to_owned(), dependencies.into()),
        ("patch".to_owned(), patch.into()),
        ("profile".to_owned(), table(&mut all, "profile")?.into()),
        ("workspace".to_owned(), Table::new().into()),
    ]);
    Ok(toml::to_string(&project)?)
}

fn table(of: &mut Table, name: &str) -> Result<Table> {
    match of.remove(name) {
        Some(Value::Table(table)) => Ok(table),
        _ => anyhow::bail!("examples/boards/Cargo.toml has no `{name}`"),
    }
}

/// Adds a dependency to the project, with an additional feature.
fn enable(dependencies: &mut Table, name: &str, feature: Option<&str>) -> Result<()> {
    let value = dependencies.get_mut(name).with_context(|| format!("no dependency `{name}`"))?;
    if let Value::String(version) = value {
        *value = Table::from_iter([("version".to_owned(), Value::from(version.as_str()))]).into();
    }
    let table = value.as_table_mut().context("a dependency is a table")?;
    table.remove("optional");
    if let Some(feature) = feature {
        let features = table.entry("features").or_insert(Value::Array(Vec::new()));
        features.as_array_mut().context(ARRAYS)?.push(feature.into());
    }
    Ok(())
}

/// Returns the text without the parts for other boards: attributes that ask for a feature, and the line after one that
/// is false.
fn alone(text: &str, board: &str) -> String {
    let mut lines = text.lines();
    let mut kept = String::new();
    while let Some(line) = lines.next() {
        let code = line.trim_start();
        if code.starts_with("#[cfg_attr(") {
            continue;
        }
        if let Some(asked) = code.strip_prefix("#[cfg(") {
            let is_asked = asked.contains(&format!("feature = \"{board}\""));
            if is_asked == asked.starts_with("not(") {
                lines.next();
            }
            continue;
        }
        kept += line;
        kept.push('\n');
    }
    kept
}

fn config(part: &Part) -> String {
    let Part { target, chip, .. } = part;
    format!(
        "[build]\ntarget = \"{target}\"\n\n[target.{target}]\nrunner = \"probe-rs run --chip {chip}\"\n\n[env]\n\
         DEFMT_LOG = \"info\"\n"
    )
}

fn build_script(part: &Part) -> String {
    let scripts = if part.memory == "rp2040" {
        "[\"link.x\", \"defmt.x\", \"link-rp.x\"]"
    } else {
        "[\"link.x\", \"defmt.x\"]"
    };
    format!(
        "//! The linker scripts of cortex-m-rt and defmt, and the part's memory map.\n\n\
         fn main() {{\n    let here = std::env::var(\"CARGO_MANIFEST_DIR\").unwrap();\n    \
         println!(\"cargo:rerun-if-changed=memory.x\");\n    \
         println!(\"cargo:rustc-link-search={{here}}\");\n    \
         for script in {scripts} {{\n        println!(\"cargo:rustc-link-arg-bins=-T{{script}}\");\n    }}\n}}\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_boards_are_left_out() {
        let text = "a\n#[cfg_attr(feature = \"x\", path = \"x.rs\")]\nmod b;\n#[cfg(not(feature = \"x\"))]\nc\n#[cfg(feature = \"x\")]\nd\n";
        assert_eq!(alone(text, "x"), "a\nmod b;\nd\n");
        assert_eq!(alone(text, "y"), "a\nmod b;\nc\n");
    }

    #[test]
    fn a_project_has_its_boards_dependencies_alone() {
        let directory = tempfile::tempdir().unwrap();
        for part in &BOARDS {
            let project = directory.path().join(part.name);
            write(&project, part, &Origin::Git("https://example.org/spikewire".into())).unwrap();
            let manifest = fs::read_to_string(project.join("Cargo.toml")).unwrap();
            let hals = ["embassy-nrf", "embassy-rp", "embassy-stm32"];
            let taken = hals.iter().filter(|hal| manifest.contains(*hal)).count();
            assert_eq!(taken, 1, "{}: {manifest}", part.name);
            assert!(!manifest.contains("path = "), "{}", part.name);
            let main = fs::read_to_string(project.join("src/main.rs")).unwrap();
            assert!(!main.contains("feature"), "{}", part.name);
        }
    }
}
