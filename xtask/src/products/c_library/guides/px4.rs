//! The guide for PX4, as a module of the firmware's own build, for its simulator (SITL).

use super::{
    super::{flights, package, put, room, work},
    FLIGHTS, ends, ensure_linked,
};
use crate::common::shell;
use crate::programs::python;
use crate::setup;
use anyhow::{Context, Result};
use std::{fs, path::Path};

/// Builds a complete program of the firmware, with the guide as its module. All output lies outside the checkout.
pub fn px4(checkout: &Path) -> Result<()> {
    setup::packages("what builds PX4", &["cmake", "g++", "ninja-build"])?;
    let python = python::environment("px4")?;
    python::install(&python, &PACKAGES)?;
    let ends = ends()?;
    let archive = flights::host_archive(FLIGHTS, &ends)?;
    let needs = ["pthread", "dl", "m"];
    let library = package::package_flights("guides-px4", &archive, &ends.include, &needs)?;
    let place = work().join("guides/px4");
    let module = place.join("src/modules/spikes");
    fs::create_dir_all(&module)?;
    let guide = fs::read_to_string(room().join("guides/px4.cpp"))?;
    put(&module.join("Spikes.cpp"), &guide)?;
    put(&module.join("CMakeLists.txt"), &indented(&guide))?;
    let list = guide.split('`').find(|quoted| quoted.starts_with("set("));
    put(&place.join("src/CMakeLists.txt"), list.context("the guide names no list of modules")?)?;
    let build = place.join("build");
    let mut cmake = shell::command("cmake");
    cmake
        .arg("-S")
        .arg(checkout)
        .arg("-B")
        .arg(&build)
        .args(["-GNinja", "-DCONFIG=px4_sitl_default"]);
    cmake.arg(format!("-DEXTERNAL_MODULES_LOCATION={}", place.display()));
    cmake.arg(format!("-DSPIKEWIRE={}", library.display()));
    cmake.arg(format!("-DPYTHON_EXECUTABLE={}", python.display()));
    shell::run(&mut cmake)?;
    shell::run(shell::command("cmake").arg("--build").arg(&build).args(["--target", "px4"]))?;
    ensure_linked("nm", &build.join("bin/px4"), ["spikes_main", "sw_px4_bank_encode"])?;
    println!("px4: {}", build.join("bin/px4").display());
    Ok(())
}

/// Python packages that the firmware's build needs.
const PACKAGES: [&str; 10] = [
    "empy>=3.3,<4",
    "jinja2",
    "jsonschema",
    "kconfiglib",
    "lxml",
    "packaging",
    "pyros-genmsg",
    "pyyaml",
    "setuptools<=81",
    "toml",
];

/// Returns the indented lines of the comment at the start of the guide: its CMakeLists.txt.
fn indented(guide: &str) -> String {
    let lines = guide.lines().filter_map(|line| line.strip_prefix("//     "));
    lines.map(|line| format!("{line}\n")).collect()
}
