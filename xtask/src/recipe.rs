//! `cargo verify recipe`: the guide's firmware, built in a directory outside this workspace as a reader would build it.

use crate::{
    package, paths,
    shell::{output, run},
    toolchain::cargo_for,
};
use anyhow::{Context, Result, ensure};
use std::{fs, process::Command};

const GUIDE: &str = "docs/firmware.md";
const TARGET: &str = "thumbv7em-none-eabihf";
/// The block that is no file but what the program prints.
const OUTPUT: &str = "output";

/// Writes the guide's blocks into their files, and runs them with the crate as it would be published.
pub fn recipe() -> Result<()> {
    let guide = fs::read_to_string(paths::root().join(GUIDE)).context(GUIDE)?;
    let blocks = blocks(&guide);
    let expected = blocks.iter().find(|(name, _)| *name == OUTPUT);
    let (_, expected) = expected.with_context(|| format!("{GUIDE} has no block `{OUTPUT}`"))?;

    let project = tempfile::tempdir()?;
    for (name, text) in blocks.iter().filter(|(name, _)| *name != OUTPUT) {
        let path = project.path().join(name);
        fs::create_dir_all(path.parent().context("a file lies in a directory")?)?;
        fs::write(&path, text)?;
        println!("{name}: {} lines", text.lines().count());
    }
    let package = package::unpacked()?;
    let patch = format!("patch.crates-io.spikewire.path={:?}", package.display().to_string());
    // There, cargo does not see this repository's settings.
    let cargo = |args| -> Result<Command> {
        let mut cargo = cargo_for(TARGET, args)?;
        cargo.current_dir(project.path()).arg("--config").arg(&patch);
        cargo.env("CARGO_TARGET_DIR", paths::thumb_target().join("recipe"));
        Ok(cargo)
    };
    run(&mut cargo("build --release")?)?;
    let printed = output(&mut cargo("run --release --quiet")?)?;
    print!("{printed}");
    ensure!(printed == *expected, "the firmware prints this, and {GUIDE} says\n{expected}");
    Ok(())
}

/// The fenced blocks that follow a line such as **`src/main.rs`**, each with its name.
fn blocks(guide: &str) -> Vec<(&str, String)> {
    let mut blocks = Vec::new();
    let (mut name, mut block) = (None, None::<String>);
    for line in guide.lines() {
        match &mut block {
            Some(text) if line == "```" => {
                blocks.extend(name.take().map(|name| (name, std::mem::take(text))));
                block = None;
            }
            Some(text) => *text += &format!("{line}\n"),
            None if line.starts_with("```") => block = Some(String::new()),
            None => {
                let named = line.strip_prefix("**`").and_then(|rest| rest.split_once("`**"));
                name = named.map(|(named, _)| named).or(name);
            }
        }
    }
    blocks
}

#[cfg(test)]
mod tests {
    use super::blocks;

    #[test]
    fn named_blocks_alone_are_taken() {
        let guide =
            "a\n```sh\nls\n```\n**`b.rs`**, the program\n\n```rust\nc\n\nd\n```\n```\ne\n```\n";
        assert_eq!(blocks(guide), [("b.rs", "c\n\nd\n".to_owned())]);
    }
}
