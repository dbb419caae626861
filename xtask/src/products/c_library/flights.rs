//! Both ends of flights in C, as `spikewire emit c --flight` makes them: each hears its own sender with the crate's bits, on
//! the host and on a board, and none hears an exact value of a flight that is mistaken for its own.

use super::{compiler, put, room, work};
use crate::common::{paths, shell};
use crate::programs::boards::Board;
use crate::programs::{host, qemu};
use crate::setup::toolchain;
use anyhow::{Context, Result, ensure};
use std::collections::BTreeMap;
use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

/// Pairs of each kind that are heard, at least.
const PAIRS: usize = 30;
/// Statuses of a value withheld from a receiver of another flight: no fingerprint yet, another one, and sub-timesteps that
/// are longer than the sender's period.
const REASONS: [&str; 3] = ["16", "17", "19"];

/// A line of the table of flights.
struct Flight {
    name: String,
    one: f64,
    fingerprint: u32,
    kinds: Vec<String>,
}

/// Runs the ends of all flights on the host, and of those whose bits the crate's own test tells on a Cortex-M4F.
pub fn verify() -> Result<()> {
    let files = write_flights()?;
    let flights = read(&files)?;
    let pairs = emit("pairs", &files, &flights)?;
    let flown: Vec<_> = flights.into_iter().filter(|own| own.kinds == ["flown"]).collect();
    let small = emit("flown", &files, &flown)?;

    let archive = host_archive("pairs", &pairs)?;
    let program = compiler::on_host("ends", "c99", &archive, &["PAIRS"])?;
    heard(&shell::output(&mut Command::new(program))?)?;

    let board = Board::with("M4F")?;
    let archive = board_archive("flown", &small, board)?;
    let program = compiler::for_board("ends", board, &archive, &[])?;
    known(board.core, &qemu::run(board, &program)?)
}

/// Writes the flights' files and their table; returns their directory.
pub fn write_flights() -> Result<PathBuf> {
    let files = paths::target().join("mistaken");
    shell::run(Command::new(host::example_of_tests("mistaken")?).arg(&files))?;
    Ok(files)
}

/// Reads the table, without the schemes that draw from a generator: these are not in C.
fn read(files: &Path) -> Result<Vec<Flight>> {
    let table = fs::read_to_string(files.join("flights.txt"))?;
    let is_in_c =
        |name: &str| catalogue::IN_C.iter().any(|(own, all)| own.name == name && !all.is_empty());
    let mut flights = Vec::new();
    for line in table.lines() {
        let [name, scheme, one, fingerprint, kinds @ ..] = &*line.split(' ').collect::<Vec<_>>()
        else {
            anyhow::bail!("no flight: {line}");
        };
        if is_in_c(scheme) {
            flights.push(Flight {
                name: (*name).to_owned(),
                one: one.parse()?,
                fingerprint: fingerprint.parse()?,
                kinds: kinds.iter().map(|own| (*own).to_owned()).collect(),
            });
        }
    }
    Ok(flights)
}

/// The crate that `spikewire emit c` makes of flight files.
pub struct Emitted {
    /// Directory of the crate.
    pub directory: PathBuf,
    /// Directory of its headers.
    pub include: PathBuf,
}

/// Makes the crate of these flight files, and its headers.
pub fn emit_files(name: &str, files: impl Iterator<Item = PathBuf>) -> Result<Emitted> {
    // `emit` makes a new directory only; cargo builds it where it built the last one.
    let new = tempfile::tempdir()?;
    let emitted = new.path().join(name);
    let made = work().join("emitted").join(name);
    fs::create_dir_all(&made)?;
    let mut emit = host::spikewire("emit c --flight")?;
    emit.args(files).arg("-o").arg(&emitted).arg("--spikewire").arg(paths::root());
    shell::run(&mut emit)?;
    shell::run(shell::command("cp").arg("-r").arg(emitted.join(".")).arg(&made))?;
    // The versions that the library was compiled with.
    fs::copy(room().join("Cargo.lock"), made.join("Cargo.lock"))?;
    let include = work().join(name);
    let mut cargo = shell::cargo("run --features header --bin header");
    shell::run(in_dev(&mut cargo, &made).arg(&include))?;
    Ok(Emitted { directory: made, include })
}

/// Builds the archive of an emitted crate for the host.
pub fn host_archive(name: &str, emitted: &Emitted) -> Result<PathBuf> {
    let mut cargo = shell::cargo("build --lib");
    shell::run(in_dev(&mut cargo, &emitted.directory))?;
    Ok(work().join(format!("debug/lib{name}.a")))
}

/// Builds the archive of an emitted crate for a board.
pub fn board_archive(name: &str, emitted: &Emitted, board: &Board) -> Result<PathBuf> {
    let mut cargo = toolchain::cargo_for(board.target, "build --release --lib")?;
    cargo.current_dir(&emitted.directory);
    cargo.env("RUSTFLAGS", format!("-C target-cpu={}", board.cpu));
    shell::run(&mut cargo).with_context(|| format!("both ends of flights for {}", board.core))?;
    Ok(paths::thumb_target().join(board.target).join(format!("release/lib{name}.a")))
}

/// Makes the crate of these flights, its headers, and the list of them for C.
fn emit(name: &str, files: &Path, flights: &[Flight]) -> Result<Emitted> {
    let files = flights.iter().map(|own| files.join(&own.name).with_extension("toml"));
    let emitted = emit_files(name, files)?;
    let mut kinds: Vec<&String> = flights.iter().flat_map(|own| &own.kinds).collect();
    kinds.sort();
    kinds.dedup();
    let mut list = String::new();
    for own in flights {
        list += &format!("#include \"{}.h\"\n", own.name);
    }
    list += "#define FLIGHTS(X)";
    for Flight { name, one, fingerprint, kinds: own } in flights {
        let bits = own.iter().filter_map(|kind| kinds.iter().position(|known| *known == kind));
        let bits: u32 = bits.map(|bit| 1 << bit).sum();
        list += &format!(
            " \\\n    X({name}, {}, {one:?}, {fingerprint}u, {bits}u)",
            name.to_uppercase()
        );
    }
    put(&emitted.include.join("flights.h"), &(list + "\n"))?;
    Ok(emitted)
}

/// Sets a build of the host up to share what the library's own builds compile.
fn in_dev<'a>(cargo: &'a mut Command, directory: &Path) -> &'a mut Command {
    cargo.current_dir(directory).env("CARGO_TARGET_DIR", work())
}

/// Fails unless the flights whose bits the crate's test tells have these bits.
fn known(place: &str, said: &str) -> Result<()> {
    let known = paths::root().join("laptop/flight/tests/flights/flown.txt");
    let known = fs::read_to_string(known)?;
    let lacking: Vec<_> =
        known.lines().filter(|line| !said.lines().any(|own| own == *line)).collect();
    ensure!(lacking.is_empty(), "{place}: C does not say\n{}\nbut\n{said}", lacking.join("\n"));
    println!("{place}: both ends of {} flights have the crate's bits in C", known.lines().count());
    Ok(())
}

/// Checks what the host's program says.
fn heard(said: &str) -> Result<()> {
    known("host", said)?;
    let (mut own, mut flights) = (0, 0);
    let (mut pairs, mut reasons) = (BTreeMap::new(), BTreeMap::new());
    for line in said.lines() {
        match *line.split([' ', ',', ':']).filter(|word| !word.is_empty()).collect::<Vec<_>>() {
            ["kind", kind, count, ..] => _ = pairs.insert(kind, count.parse::<usize>()?),
            ["reason", reason, count, ..] => _ = reasons.insert(reason, count.parse::<usize>()?),
            [_, _, "frames", _, "bytes", exact, "exact", ..] => {
                flights += 1;
                own += usize::from(exact.parse::<usize>()? > 20);
            }
            _ => {}
        }
    }
    let few = pairs.iter().filter(|(_, count)| **count < PAIRS).count();
    ensure!(pairs.len() >= 10 && few == 0, "too few pairs of a kind: {pairs:?}");
    ensure!(reasons.keys().all(|why| REASONS.contains(why)), "other reasons: {said}");
    // Means are never exact.
    ensure!(own + 8 > flights, "{own} of {flights} flights hear their own sender:\n{said}");
    let count: usize = pairs.values().sum();
    println!(
        "{flights} flights in C: 0 exact values in {count} mistaken pairs; reasons {reasons:?}"
    );
    Ok(())
}
