//! `cargo xtask new-firmware DIR --board NAME` and `… --hal NAME --flight flight.toml`: writes a project, outside this
//! workspace, that builds at once.
//!
//! A board's files are those of `examples/boards`, without the other boards; a HAL's are those of `examples/templates`.

use crate::common::{paths, usage};
use crate::products::parts::{BOARDS, Part};
use crate::products::templates::{TEMPLATES, Template};
use anyhow::{Context, Result, ensure};
use spikewire_flight::{Flight, UnitSize, escaped};
use std::{
    fs,
    path::{Path, PathBuf},
};
use toml::{Table, Value};

/// The templates' own reading of names.
#[path = "../../../examples/flight/src/names.rs"]
#[allow(dead_code, reason = "a template needs sizes of units, too")]
mod names;

/// The number of the axis that a channel's name tells a template: rates about x, y, z are 0 to 2, accelerations 3 to 5.
pub(crate) use names::axis;

pub const USAGE: &str = "cargo xtask new-firmware DIR --board NAME [--git URL]
cargo xtask new-firmware DIR --hal NAME --flight FLIGHT.toml [--git URL]";

/// Where a project finds the crate and its companions.
pub enum Origin {
    /// A directory with this repository's files.
    Path(PathBuf),
    /// A URL for git.
    Git(String),
}

/// Packages that a project takes from there, with their directories.
const PACKAGES: [(&str, &str); 5] = [
    ("spikewire", ""),
    ("flight", "examples/flight"),
    ("imu", "examples/flight"), // the same under another name, as a flight's module is `flight`
    ("icm42688p", "examples/icm42688p"),
    ("spikewire-flight", "laptop/flight"),
];

/// Error text for a feature that is not a list.
const ARRAYS: &str = "a feature is a list of texts";

pub fn new_firmware(args: &[String]) -> Result<()> {
    let mut args: Vec<&str> = args.iter().map(String::as_str).collect();
    let origin = match args[..] {
        [.., "--git", url] => {
            args.truncate(args.len() - 2);
            Origin::Git(url.into())
        }
        _ => Origin::Path(paths::root()),
    };
    match args[..] {
        [directory, "--board", board] => for_board(&free(directory)?, board, &origin),
        [directory, "--hal", hal, "--flight", flight] => {
            for_hal(&free(directory)?, hal, Path::new(flight), &origin)
        }
        _ => Err(usage(format!("{USAGE}\nboards: {}\nHALs: {}", boards(), hals()))),
    }
}

/// Returns a directory's path, unless it is there.
fn free(directory: &str) -> Result<PathBuf> {
    let directory = std::env::current_dir()?.join(directory);
    ensure!(!directory.exists(), "{} is there already", directory.display());
    Ok(directory)
}

fn for_board(directory: &Path, board: &str, origin: &Origin) -> Result<()> {
    let part = BOARDS.iter().find(|part| part.name == board);
    let part = part.ok_or_else(|| usage(format!("no board `{board}`; there are {}", boards())))?;
    write(directory, part, origin)?;
    println!("{}: firmware for {}. In it:", directory.display(), part.name);
    println!("  cargo build --release    # with this compiler's target {}", part.target);
    println!("  {}", part.flash);
    println!("  spikewire listen --baud {} PORT {}", part.baud, part.listen);
    Ok(())
}

fn for_hal(directory: &Path, hal: &str, flight: &Path, origin: &Origin) -> Result<()> {
    let template = TEMPLATES.iter().find(|template| template.hal == hal);
    let template =
        template.ok_or_else(|| usage(format!("no HAL `{hal}`; there are {}", hals())))?;
    write_template(directory, template, flight, origin)?;
    let Template { target, baud, .. } = template;
    let name = directory.file_name().context("a directory has a name")?.to_string_lossy();
    println!("{}: firmware with {hal}. In it:", directory.display());
    println!("  cargo build --release    # with this compiler's target {target}");
    println!("  cargo run --release      # with a debug probe: cargo install probe-rs-tools");
    println!("  spikewire listen --baud {baud} PORT --flight flight.toml");
    if let Some(part) = template.emulated {
        let image = directory.join("target").join(target).join("release").join(&*name);
        println!("Without a board, in {}:", paths::root().display());
        println!("  cargo xtask emulate {} --part {part}", image.display());
    }
    Ok(())
}

fn boards() -> String {
    BOARDS.map(|part| part.name).join(", ")
}

fn hals() -> String {
    TEMPLATES.map(|template| template.hal).join(", ")
}

/// Writes a template's files, and the flight's.
pub fn write_template(
    directory: &Path,
    template: &Template,
    flight: &Path,
    origin: &Origin,
) -> Result<()> {
    let Template { hal, target, chip, memory, sections, .. } = template;
    let read = |path: String| {
        fs::read_to_string(paths::examples().join(&path)).with_context(|| path.clone())
    };
    check_flight(flight)?;
    let flight = fs::read_to_string(flight).with_context(|| flight.display().to_string())?;
    let mut manifest: Table = read(format!("templates/{hal}/Cargo.toml"))?.parse()?;
    from_origin(&mut manifest, directory, origin)?;
    let files = [
        ("Cargo.toml", toml::to_string(&manifest)?),
        (".cargo/config.toml", config(target, chip)),
        (
            "rust-toolchain.toml",
            format!("[toolchain]\nchannel = \"stable\"\ntargets = [\"{target}\"]\n"),
        ),
        ("memory.x", read(format!("boards/memory/{memory}.x"))? + sections),
        ("build.rs", read("templates/build.rs".into())?),
        ("src/main.rs", read(format!("templates/{hal}/src/main.rs"))?),
        ("flight.toml", flight),
    ];
    write_files(directory, files)
}

/// Checks that a template can fly a flight's file: each channel has an axis of the sensor in its name and a known unit, and
/// the sensor's counts become its samples. Otherwise the project's build would fail.
fn check_flight(path: &Path) -> Result<()> {
    let flight = Flight::read(path)?;
    flight.check_units().map_err(|error| usage(format!("{}: {error}", path.display())))?;
    let file = path.display();
    ensure!(
        matches!(flight.sample.to_string().as_str(), "f32" | "i16"),
        "{file}: sample {} is not one that a sensor's counts become here; take f32 or i16",
        flight.sample
    );
    for (index, channel) in flight.channels.iter().enumerate() {
        let line = flight.line_of(index).unwrap_or(1);
        let name = escaped(&channel.name);
        let axis = axis(&channel.name).with_context(|| {
            format!("{file}:{line}: `{name}` has no axis in its name, such as gyro_x or accel_z")
        })?;
        let size = UnitSize::of(&channel.unit);
        let of_quantity = if axis < 3 { UnitSize::rate } else { UnitSize::acceleration };
        let is_known = size.and_then(of_quantity).is_some();
        let units = if axis < 3 { "one such as rad/s or deg/s" } else { "one such as m/s² or g" };
        ensure!(is_known, "{file}:{line}: the unit of `{name}` must be {units}");
    }
    Ok(())
}

/// Names the project, and finds this repository's packages elsewhere.
fn from_origin(manifest: &mut Table, directory: &Path, origin: &Origin) -> Result<()> {
    let name = directory.file_name().context("a directory has a name")?.to_string_lossy();
    let package = manifest.get_mut("package").and_then(Value::as_table_mut).context("package")?;
    package.insert("name".into(), Value::from(&*name));
    let patch = manifest.get_mut("patch").and_then(Value::as_table_mut).context("patch")?;
    let patch = patch.get_mut("crates-io").and_then(Value::as_table_mut).context("crates-io")?;
    place_packages(patch, origin);
    for kind in ["dependencies", "build-dependencies"] {
        let own = manifest.get_mut(kind).and_then(Value::as_table_mut).context(kind)?;
        place_packages(own, origin);
    }
    Ok(())
}

/// Replaces the paths of this repository's packages.
fn place_packages(dependencies: &mut Table, origin: &Origin) {
    for (package, place) in PACKAGES {
        let (key, source) = match origin {
            Origin::Path(root) => ("path", root.join(place).display().to_string()),
            Origin::Git(url) => ("git", url.clone()),
        };
        if let Some(Value::Table(dependency)) = dependencies.get_mut(package)
            && dependency.remove("path").is_some()
        {
            dependency.insert(key.into(), Value::String(source));
        }
    }
}

/// Writes the project's files.
pub fn write(directory: &Path, part: &Part, origin: &Origin) -> Result<()> {
    let from = paths::examples().join("boards");
    let read = |path: String| fs::read_to_string(from.join(&path)).context(path);
    let manifest: Table = read("Cargo.toml".into())?.parse()?;
    let files = [
        ("Cargo.toml", self::manifest(manifest, directory, part, origin)?),
        (".cargo/config.toml", config(part.target, part.chip)),
        ("memory.x", read(format!("memory/{}.x", part.memory))?),
        ("build.rs", build_script(part)),
        ("src/main.rs", alone(&read("src/main.rs".into())?, part.name)),
        ("src/board.rs", alone(&read(format!("src/board/{}.rs", part.board))?, part.name)),
        ("src/part.rs", alone(&read(format!("src/part/{}.rs", part.part))?, part.name)),
    ];
    write_files(directory, files)
}

fn write_files<const N: usize>(directory: &Path, files: [(&str, String); N]) -> Result<()> {
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
    place_packages(&mut dependencies, origin);
    let mut patched = table(&mut all, "patch")?;
    let crates_io = patched.get_mut("crates-io").and_then(Value::as_table_mut);
    place_packages(crates_io.context("a patch")?, origin);
    let package = Table::from_iter([
        ("name".to_owned(), Value::from(&*name)),
        ("version".to_owned(), Value::from("0.1.0")),
        ("edition".to_owned(), Value::from("2024")),
    ]);
    let project = Table::from_iter([
        ("package".to_owned(), package.into()),
        ("dependencies".to_owned(), dependencies.into()),
        ("patch".to_owned(), patched.into()),
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

fn config(target: &str, chip: &str) -> String {
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
    fn a_hals_project_finds_this_repositorys_packages() {
        let directory = tempfile::tempdir().unwrap();
        let flight = paths::examples().join("one-file/flight.toml");
        for template in &TEMPLATES {
            let project = directory.path().join(template.hal);
            let url = "https://example.org/spikewire";
            write_template(&project, template, &flight, &Origin::Git(url.into())).unwrap();
            let manifest = fs::read_to_string(project.join("Cargo.toml")).unwrap();
            assert!(!manifest.contains("path = "), "{manifest}");
            assert_eq!(manifest.matches(url).count(), 4, "{manifest}");
            let name = format!("name = \"{}\"", template.hal);
            assert!(manifest.contains(&name), "{manifest}");
        }
    }

    /// Whatever would fail the project's build is refused with its line, before anything is written.
    #[test]
    fn a_flight_that_no_template_flies_is_refused() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("flight.toml");
        let head = "version = 1\nscheme = \"sf\"\nperiod = 2000\nparameters = { threshold = 1 }\n[[channel]]\n";
        let refused = |channel: &str, words: &str| {
            fs::write(&path, format!("{head}{channel}\n")).unwrap();
            let project = directory.path().join("project");
            let origin = Origin::Git("https://example.org/spikewire".into());
            let error = write_template(&project, &TEMPLATES[0], &path, &origin).unwrap_err();
            assert!(error.to_string().contains(words), "{channel}: {error}");
            assert!(!project.exists());
        };
        refused("name = \"roll\"\nunit = \"rad/s\"", "flight.toml:5: `roll` has no axis");
        refused("name = \"gyro_x\"\nunit = \"V\"", "must be one such as rad/s or deg/s");
        refused("name = \"gyro_x\"", "line 5: channel 0: unit is missing for \"gyro_x\"");
        refused("name = \"acc_x\"\nunit = \"deg/s\"", "must be one such as m/s² or g");
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
