//! Where things are.

use std::{env, path::PathBuf};

/// The repository's top. Cargo says where this package is, when it runs it; what it said when it compiled it
/// may be another checkout's place, if the two share a target directory.
pub fn root() -> PathBuf {
    let here =
        env::var_os("CARGO_MANIFEST_DIR").unwrap_or_else(|| env!("CARGO_MANIFEST_DIR").into());
    let here = PathBuf::from(here);
    here.parent().map(PathBuf::from).unwrap_or(here)
}

/// Everything generated goes below here.
pub fn target() -> PathBuf {
    root().join(env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into()))
}

/// What the Cortex-M compiler builds. Kept apart: it may be another compiler than the host's.
pub fn thumb_target() -> PathBuf {
    target().join("thumb")
}

/// The firmware workspace.
pub fn examples() -> PathBuf {
    root().join("examples")
}
