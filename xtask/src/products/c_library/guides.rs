//! `cargo xtask guides`: builds the guides with the firmwares that they are for, in a checkout of one.

mod px4;

use super::{
    flights::{self, Emitted},
    package, put, room, work,
};
use crate::common::{shell, usage};
use crate::programs::boards::Board;
use crate::setup;
use anyhow::{Context, Result, ensure};
use std::{fs, path::Path};

/// Name of the crate of the guides' flights.
pub const FLIGHTS: &str = "guides";

/// Makes the crate of both ends of the guides' flights.
pub fn ends() -> Result<Emitted> {
    let files = ["betaflight", "crazyflie", "px4"];
    let files = files.map(|name| room().join("guides").join(name).with_extension("toml"));
    flights::emit_files(FLIGHTS, files.into_iter())
}

/// Builds a guide within a checkout of its firmware, including submodules.
pub fn guides(args: &[String]) -> Result<()> {
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    let (guide, checkout): (fn(&Path) -> Result<()>, _) = match args[..] {
        ["crazyflie", checkout] => (crazyflie, checkout),
        ["betaflight", checkout] => (betaflight, checkout),
        ["px4", checkout] => (px4::px4, checkout),
        _ => {
            return Err(usage("cargo xtask guides (crazyflie, betaflight, px4) CHECKOUT".into()));
        }
    };
    let checkout = fs::canonicalize(checkout).with_context(|| checkout.to_owned())?;
    let mut git = shell::command("git");
    git.arg("-C").arg(&checkout).args(["log", "-1", "--format=%H of %cs"]);
    println!("{}: {}", args[0], shell::output(&mut git)?.trim());
    guide(&checkout)
}

/// Builds a complete image with the firmware's own build, with the guide as its app.
fn crazyflie(checkout: &Path) -> Result<()> {
    setup::packages(
        "what builds a Crazyflie",
        &["gcc-arm-none-eabi", "libnewlib-arm-none-eabi", "make"],
    )?;
    let board = Board::with("M4F")?;
    let ends = ends()?;
    let archive = flights::board_archive(FLIGHTS, &ends, board)?;
    let library = package::package_flights("guides-crazyflie", &archive, &ends.include, &[])?;
    let app = work().join("guides/crazyflie");
    fs::create_dir_all(&app)?;
    fs::copy(room().join("guides/crazyflie.c"), app.join("spikes.c"))?;
    put(&app.join("Kbuild"), KBUILD)?;
    put(&app.join("app-config"), CONFIG)?;
    let makefile = format!("CRAZYFLIE_BASE := {}\n{MAKEFILE}", checkout.display());
    put(&app.join("Makefile"), &makefile)?;
    for target in ["cf2_defconfig", "all"] {
        let mut make = shell::command("make");
        make.arg("-C").arg(&app).arg("-j2").arg(format!("SPIKEWIRE={}", library.display()));
        shell::run(make.arg(format!("PWD={}", app.display())).arg(target))?;
    }
    ensure_linked(
        "arm-none-eabi-nm",
        &app.join("build/cf2.elf"),
        ["appMain", "sw_crazyflie_bank_encode"],
    )?;
    println!("crazyflie: {}", app.join("build/cf2.bin").display());
    Ok(())
}

/// Fails unless the program contains the guide's start, its bank, and the writer of frames.
fn ensure_linked(nm: &str, program: &Path, [start, bank]: [&str; 2]) -> Result<()> {
    let symbols = shell::output(shell::command(nm).arg(program))?;
    for symbol in [start, bank, "sw_writer_next_frame"] {
        let ends = format!(" {symbol}");
        ensure!(symbols.lines().any(|line| line.ends_with(&ends)), "the program lacks {symbol}");
    }
    Ok(())
}

const KBUILD: &str = "\
obj-y += spikes.o spikewire.o
ccflags-y += -I$(SPIKEWIRE)/include
$(obj)/spikewire.o: $(SPIKEWIRE)/lib/libspikewire.a
\t$(LD) -r -nostdlib -Wl,--whole-archive $< -o $@
";

const CONFIG: &str = "CONFIG_APP_ENABLE=y\nCONFIG_APP_PRIORITY=1\nCONFIG_APP_STACKSIZE=600\n";

const MAKEFILE: &str = "\
OOT_CONFIG := $(PWD)/app-config
include $(CRAZYFLIE_BASE)/tools/make/oot.mk
";

/// Builds the guide with the headers of the firmware's simulator (SITL), which needs no vendor files.
fn betaflight(checkout: &Path) -> Result<()> {
    let mut gcc = shell::command("gcc");
    gcc.args(["-std=gnu17", "-Wall", "-Wextra", "-Werror", "-fsyntax-only"]);
    gcc.args(["-DSITL", "-DSIMULATOR_BUILD", "-DTARGET_FLASH_SIZE=2048", "-DHSE_VALUE=8000000"]);
    for directory in [
        "src/main",
        "src/main/target",
        "src/platform",
        "src/platform/common/include",
        "src/platform/SIMULATOR",
        "src/platform/SIMULATOR/include",
        "src/platform/SIMULATOR/target/SITL",
        "lib/main/dyad",
    ] {
        gcc.arg("-I").arg(checkout.join(directory));
    }
    gcc.arg("-I").arg(ends()?.include).arg(room().join("guides/betaflight.c"));
    shell::run(&mut gcc)
}
