//! Paths of directories.

use std::{env, path::PathBuf};

/// Returns the repository's top directory, as cargo gives it at run time. The one at compile time may be that of
/// another checkout, if the two share a target directory.
pub fn root() -> PathBuf {
    let here =
        env::var_os("CARGO_MANIFEST_DIR").unwrap_or_else(|| env!("CARGO_MANIFEST_DIR").into());
    let here = PathBuf::from(here);
    here.parent().map(PathBuf::from).unwrap_or(here)
}

/// Returns the directory below which everything is generated.
pub fn target() -> PathBuf {
    root().join(env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into()))
}

/// Returns the output directory for Cortex-M. It is separate, as its compiler may differ from the host's.
pub fn thumb_target() -> PathBuf {
    target().join("thumb")
}

/// Returns the directory of the firmware workspace.
pub fn examples() -> PathBuf {
    root().join("examples")
}
