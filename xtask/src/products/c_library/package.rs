//! Packages the library for build systems: archive, header, CMake package and pkg-config file.

use super::{include, put, work};
use crate::common::{paths, shell};
use anyhow::Result;
use std::{
    fs,
    path::{Path, PathBuf},
};

/// Writes the package of the library below `target/c-library/<name>`; programs must also link the libraries in `needs`.
pub fn package(name: &str, archive: &Path, needs: &[&str]) -> Result<PathBuf> {
    package_flights(name, archive, include()?, needs)
}

/// Writes a package of this archive and the headers in `include`, as [`package`] does.
pub fn package_flights(
    name: &str,
    archive: &Path,
    include: &Path,
    needs: &[&str],
) -> Result<PathBuf> {
    let place = paths::target().join("c-library").join(name);
    let cmake = place.join("lib/cmake/spikewire");
    let pkgconfig = place.join("lib/pkgconfig");
    for directory in [&cmake, &pkgconfig] {
        fs::create_dir_all(directory)?;
    }
    fs::copy(archive, place.join("lib/libspikewire.a"))?;
    fs::create_dir_all(place.join("include"))?;
    shell::run(shell::command("cp").arg("-r").arg(include.join(".")).arg(place.join("include")))?;
    put(&cmake.join("spikewireConfig.cmake"), &CMAKE.replace("@NEEDS@", &needs.join(";")))?;
    put(&cmake.join("spikewireConfigVersion.cmake"), CMAKE_VERSION)?;
    let needed: String = needs.iter().map(|name| format!(" -l{name}")).collect();
    put(&pkgconfig.join("spikewire.pc"), &PKG_CONFIG.replace("@NEEDS@", &needed))?;
    println!("{name}: {}", place.strip_prefix(work()).unwrap_or(&place).display());
    Ok(place)
}

const CMAKE: &str = "\
# find_package(spikewire CONFIG) defines spikewire::spikewire.
get_filename_component(_spikewire \"${CMAKE_CURRENT_LIST_DIR}/../../..\" ABSOLUTE)
if(NOT TARGET spikewire::spikewire)
  add_library(spikewire::spikewire STATIC IMPORTED)
  set_target_properties(spikewire::spikewire PROPERTIES
    IMPORTED_LOCATION \"${_spikewire}/lib/libspikewire.a\"
    INTERFACE_INCLUDE_DIRECTORIES \"${_spikewire}/include\"
    INTERFACE_LINK_LIBRARIES \"@NEEDS@\"
    INTERFACE_LINK_OPTIONS \"-Wl,--gc-sections\")
endif()
";

const CMAKE_VERSION: &str = "\
set(PACKAGE_VERSION 0.1.0)
set(PACKAGE_VERSION_COMPATIBLE FALSE)
if(PACKAGE_FIND_VERSION VERSION_EQUAL PACKAGE_VERSION OR NOT PACKAGE_FIND_VERSION)
  set(PACKAGE_VERSION_COMPATIBLE TRUE)
  set(PACKAGE_VERSION_EXACT TRUE)
endif()
";

const PKG_CONFIG: &str = "\
prefix=${pcfiledir}/../..

Name: spikewire
Description: Sensor samples to spikes and back on a flight controller
Version: 0.1.0
Cflags: -I${prefix}/include
Libs: -L${prefix}/lib -lspikewire@NEEDS@ -Wl,--gc-sections
";
