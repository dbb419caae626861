//! C compilers: the host's with its sanitizers, and the distribution's for Cortex-M.

use super::flights::{self, Emitted};
use super::{declared, include, room, work};
use crate::common::shell;
use crate::programs::boards::Board;
use anyhow::{Context, Result, ensure};
use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

/// Warnings, all of which are errors.
const STRICT: [&str; 6] = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"];

/// Compiles for the host, in a language; the program ends at the first error of address or of undefined behaviour.
pub fn on_host(name: &str, language: &str, archive: &Path, defined: &[&str]) -> Result<PathBuf> {
    let program = work().join(format!("{name}-{}", language.replace("+", "p")));
    let mut gcc = shell::command(if language.starts_with("c++") { "g++" } else { "gcc" });
    gcc.args(["-x", if language.starts_with("c++") { "c++" } else { "c" }]);
    gcc.arg(format!("-std={language}")).args(STRICT).args(["-O1", "-g"]);
    gcc.args(["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]);
    sources(&mut gcc, name, "host.c", defined)?;
    gcc.args(["-x", "none"]).arg(archive).args(["-lpthread", "-ldl", "-lm"]);
    shell::run(gcc.arg("-o").arg(&program))?;
    Ok(program)
}

/// Compiles for a board, with no other library than this one.
pub fn for_board(name: &str, board: &Board, archive: &Path, defined: &[&str]) -> Result<PathBuf> {
    let place = work().join(board.machine);
    fs::create_dir_all(&place)?;
    fs::copy(board.memory_map(), place.join("board.x"))
        .with_context(|| board.machine.to_owned())?;
    let program = place.join([&[name], defined].concat().join("-").replace('=', "-"));
    let mut gcc = shell::command("arm-none-eabi-gcc");
    gcc.arg(format!("-mcpu={}", board.cpu)).args(["-mthumb", "-std=c99"]).args(STRICT);
    if board.target.ends_with("hf") {
        gcc.args(["-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"]);
    }
    // Jump tables of the smallest core are calls of the compiler's library.
    gcc.args([
        "-Os",
        "-ffreestanding",
        "-ffunction-sections",
        "-fdata-sections",
        "-fno-jump-tables",
    ]);
    gcc.args(["-nostdlib", "-Wl,--gc-sections", "-Wl,--fatal-warnings", "-Wl,-z,noexecstack"]);
    gcc.arg("-L").arg(&place).arg("-T").arg(room().join("tests/link.ld"));
    sources(&mut gcc, name, "cortex_m.c", defined)?;
    shell::run(gcc.args(["-x", "none"]).arg(archive).arg("-o").arg(&program))?;
    Ok(program)
}

/// Adds the test, its support code, the header, and the recorded flight.
fn sources(gcc: &mut Command, name: &str, board: &str, defined: &[&str]) -> Result<()> {
    let tests = room().join("tests");
    gcc.arg("-I").arg(include()?).arg("-I").arg(&tests).arg("-I").arg(work());
    gcc.args(defined.iter().map(|name| format!("-D{name}")));
    gcc.arg(tests.join(name).with_extension("c")).arg(tests.join(board));
    if ["flight", "count"].contains(&name) {
        gcc.arg(format!("-Wa,-I{}", work().display()));
        gcc.args(["-x", "assembler-with-cpp"]).arg(tests.join("recording.S"));
    }
    Ok(())
}

/// Compiles the guides, each with declarations of what its firmware provides; the firmwares themselves are not in this
/// repository. `ends` has the headers of their flights.
pub fn guides(ends: &Emitted) -> Result<()> {
    for (guide, compiler, standard) in [
        ("crazyflie.c", "arm-none-eabi-gcc", "c11"),
        ("betaflight.c", "arm-none-eabi-gcc", "c11"),
        ("px4.cpp", "g++", "c++14"),
    ] {
        let guides = room().join("guides");
        let mut gcc = shell::command(compiler);
        if compiler != "g++" {
            gcc.args(["-mcpu=cortex-m4", "-mthumb"]);
        }
        gcc.arg(format!("-std={standard}")).args(["-Wall", "-Wextra", "-Wpedantic", "-Werror"]);
        gcc.arg("-I").arg(&ends.include);
        gcc.arg("-I").arg(guides.join("stubs").join(Path::new(guide).with_extension("")));
        gcc.arg("-c").arg(guides.join(guide)).arg("-o").arg(work().join(guide).with_extension("o"));
        shell::run(&mut gcc)?;
    }
    Ok(())
}

/// Runs the guides in C on the host with a stand-in for their firmware: what they send must arrive, and they must never
/// wait.
pub fn guides_run(ends: &Emitted) -> Result<()> {
    let archive = flights::host_archive(super::guides::FLIGHTS, ends)?;
    for guide in ["crazyflie", "betaflight"] {
        let program = work().join(format!("guide-{guide}"));
        let (guides, tests) = (room().join("guides"), room().join("tests"));
        let mut gcc = shell::command("gcc");
        gcc.args(["-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-O1", "-g"]);
        gcc.args(["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]);
        gcc.arg("-I").arg(&ends.include).arg("-I").arg(guides.join("stubs").join(guide));
        gcc.arg("-I").arg(&tests).arg(tests.join(format!("guide_{guide}.c")));
        gcc.arg(guides.join(guide).with_extension("c")).arg(&archive);
        gcc.args(["-lpthread", "-ldl", "-lm", "-o"]).arg(&program);
        shell::run(&mut gcc)?;
        shell::run(&mut Command::new(program))?;
    }
    Ok(())
}

/// Builds a CMake project that finds the host's package and uses one of its codecs.
pub fn with_cmake(package: &Path) -> Result<()> {
    const MOST: u64 = 100_000;
    let place = work().join("with-cmake");
    fs::create_dir_all(&place)?;
    super::put(&place.join("CMakeLists.txt"), CMAKE_PROJECT)?;
    fs::copy(room().join("tests/one.c"), place.join("one.c"))?;
    let build = place.join("build");
    let mut cmake = shell::command("cmake");
    cmake.arg("-S").arg(&place).arg("-B").arg(&build).arg("-DCMAKE_BUILD_TYPE=Release");
    shell::output(cmake.arg(format!("-DCMAKE_PREFIX_PATH={}", package.display())))?;
    shell::output(shell::command("cmake").arg("--build").arg(&build))?;
    let program = build.join("one");
    let bytes = fs::metadata(&program)?.len();
    println!("a program of the host with one codec: {bytes} bytes");
    ensure!(bytes < MOST, "one codec costs {bytes} bytes, and not less than {MOST}");
    shell::run(&mut Command::new(program))
}

const CMAKE_PROJECT: &str = "\
cmake_minimum_required(VERSION 3.13)
project(one C)
find_package(spikewire 0.1.0 CONFIG REQUIRED)
add_executable(one one.c)
target_link_libraries(one PRIVATE spikewire::spikewire)
target_link_options(one PRIVATE -s)
";

/// Writes the recorded flight where the assembler finds it, and the codecs that fly it where the compiler finds them.
pub fn record() -> Result<()> {
    fs::create_dir_all(work())?;
    fs::write(work().join("flown.h"), declared::flown())?;
    fs::write(work().join("flight.bin"), flight_data::HEXAROTOR).context("flight.bin")
}
