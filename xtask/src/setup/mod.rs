//! `cargo xtask setup`: installs what a machine lacks. It says first what it will do, and leaves alone what is
//! installed.
//!
//! Nothing else in this program acts as root or removes directories. `cargo demo` and `cargo verify` begin with it.

mod core_library;
pub mod distribution;
pub mod needs;
mod packages;
pub mod toolchain;

use crate::common::shell;
use anyhow::Result;
use needs::{Missing, Needs, missing};
use std::env;

/// Installs what the checks need.
pub fn setup() -> Result<()> {
    provide(&needs::CHECKS)
}

/// Installs these needs, and no more.
pub fn provide(needs: &Needs) -> Result<()> {
    let missing = missing(needs)?;
    if missing.is_empty() {
        println!("All is there: {}.", needs.words());
        return Ok(());
    }
    println!("Missing:\n  {}", missing.lines().join("\n  "));
    println!("To do:\n  {}", plan(&missing).join("\n  "));

    packages::install(&wanted(&missing))?;
    if !missing.targets.is_empty() {
        compiler(&missing.targets)?;
    }
    println!("Done: {}.", needs.words());
    Ok(())
}

/// Installs packages that a single check needs, if they are missing, and says so first.
pub fn packages(what: &str, wanted: &[&str]) -> Result<()> {
    let missing = packages::missing(wanted);
    if !missing.is_empty() {
        println!("Missing: {what}\nTo do:\n  as root: apt-get install {}", missing.join(" "));
        packages::install(&missing)?;
    }
    Ok(())
}

/// Installs what builds for WebAssembly, if it is missing, and says so first.
pub fn wasm(target: &str) -> Result<()> {
    if toolchain::has_core(target)? {
        return Ok(());
    }
    if rustup_may_fetch() {
        println!(
            "Missing: the standard library for {target}\nTo do:\n  rustup target add {target}"
        );
        return shell::run(shell::command("rustup").args(["target", "add", target]));
    }
    packages("a compiler for WebAssembly", &distribution::PACKAGES)
}

/// Returns whether rustup may fetch anything: `RUSTUP_AUTO_INSTALL=0` forbids it.
fn rustup_may_fetch() -> bool {
    shell::has("rustup") && env::var("RUSTUP_AUTO_INSTALL").as_deref() != Ok("0")
}

/// Returns the packages that provide what is missing, installed or not.
fn wanted(missing: &Missing) -> Vec<&'static str> {
    let mut wanted: Vec<_> = missing.tools.iter().map(|tool| tool.package).collect();
    if !missing.targets.is_empty() && !rustup_may_fetch() {
        wanted.extend(distribution::PACKAGES);
    }
    wanted
}

/// Lists what will be done, a line each.
fn plan(missing: &Missing) -> Vec<String> {
    let mut plan = Vec::new();
    let packages = packages::missing(&wanted(missing));
    if !packages.is_empty() {
        plan.push(format!("as root: apt-get install {}", packages.join(" ")));
    }
    if missing.targets.is_empty() {
        return plan;
    }
    if rustup_may_fetch() {
        plan.push(format!("rustup target add {}", missing.targets.join(" ")));
        return plan;
    }
    if !distribution::is_linked() {
        plan.push("rustup toolchain link thumb /usr".into());
    }
    for target in &missing.targets {
        let place = distribution::libraries(target);
        plan.push(format!("build the core library; as root: write {}", place.display()));
    }
    if missing.targets.iter().any(|target| distribution::libraries(target).exists()) {
        plan.push("remove target/thumb, which another core library made".into());
    }
    plan
}

/// Installs a compiler with a core library for these targets.
fn compiler(targets: &[&str]) -> Result<()> {
    if rustup_may_fetch() {
        let mut rustup = shell::command("rustup");
        rustup.args(["target", "add"]).args(targets);
        return shell::run(&mut rustup);
    }
    if !distribution::is_linked() {
        shell::run(shell::command("rustup").args(["toolchain", "link", "thumb", "/usr"]))?;
    }
    for target in targets {
        // Linking the toolchain may have been all.
        if !distribution::has_core(target)? {
            core_library::install(target)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::{fs, path::Path};

    /// Only this module may act as root or remove directories.
    #[test]
    fn nothing_else_acts_as_root_or_removes_directories() {
        let mut waiting = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("src")];
        let mut read = 0;
        while let Some(path) = waiting.pop() {
            if path.ends_with("src/setup") {
                continue;
            }
            if path.is_dir() {
                waiting.extend(fs::read_dir(&path).unwrap().map(|entry| entry.unwrap().path()));
                continue;
            }
            let text = fs::read_to_string(&path).unwrap();
            for word in ["as_root", "remove_dir_all", "packages::install", "sudo"] {
                assert!(!text.contains(word), "{} has `{word}`", path.display());
            }
            read += 1;
        }
        assert!(read > 60, "{read} files are read");
    }
}
