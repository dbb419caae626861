//! Checks the templates of `examples/templates`: each becomes a project, as a user would make it, is built, and runs in the
//! emulator of its part with every fault of its sensor.

use crate::checks::emulator;
use crate::common::{lint, output, paths, run};
use crate::products::new_firmware::{self, Origin};
use crate::products::templates::{TEMPLATES, Template};
use crate::programs::{host, published};
use crate::setup::toolchain::cargo_for;
use anyhow::{Context, Result, ensure};
use std::{
    fs,
    path::{Path, PathBuf},
};

/// Maximum number of lines of a template, without blank lines and imports.
const MOST_LINES: usize = 120;
