//! What a build system takes: archive, header, CMake package and pkg-config file.

use super::{put, room, work};
use crate::{boards::Board, paths, shell};
use anyhow::Result;
use std::{fs, path::Path};

/// Puts it all below `target/c-library/<core>`.
pub fn package(board: &Board, archive: &Path) -> Result<()> {
    let place = paths::target().join("c-library").join(board.cpu);
    let cmake = place.join("lib/cmake/spikewire");
    let pkgconfig = place.join("lib/pkgconfig");
    for directory in [&cmake, &pkgconfig] {
        fs::create_dir_all(directory)?;
    }
    fs::copy(archive, place.join("lib/libspikewire.a"))?;
    shell::run(shell::command("cp").arg("-r").arg(room().join("include")).arg(&place))?;
    put(&cmake.join("spikewireConfig.cmake"), CMAKE)?;
    put(&cmake.join("spikewireConfigVersion.cmake"), CMAKE_VERSION)?;
    put(&pkgconfig.join("spikewire.pc"), PKG_CONFIG)?;
    println!("{}: {}", board.cpu, place.strip_prefix(work()).unwrap_or(&place).display());
    Ok(())
}

const CMAKE: &str = "\
# find_package(spikewire CONFIG) defines spikewire::spikewire.
get_filename_component(_spikewire \"${CMAKE_CURRENT_LIST_DIR}/../../..\" ABSOLUTE)
if(NOT TARGET spikewire::spikewire)
  add_library(spikewire::spikewire STATIC IMPORTED)
  set_target_properties(spikewire::spikewire PROPERTIES
    IMPORTED_LOCATION \"${_spikewire}/lib/libspikewire.a\"
    INTERFACE_INCLUDE_DIRECTORIES \"${_spikewire}/include\")
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
Libs: -L${prefix}/lib -lspikewire
";
