//! Packages of the Linux distribution.

use crate::common::shell;
use anyhow::{Context, Result, bail};
use std::process::Command;

/// Returns the packages that are not installed.
pub fn missing<'a>(packages: &[&'a str]) -> Vec<&'a str> {
    let is_there = |package: &str| shell::succeeds(shell::command("dpkg").args(["-s", package]));
    packages.iter().copied().filter(|package| !is_there(package)).collect()
}

/// Installs the packages that are missing, as root.
pub fn install(packages: &[&str]) -> Result<()> {
    let missing = missing(packages);
    if missing.is_empty() {
        return Ok(());
    }
    let list = missing.join(" ");
    if !shell::has("apt-get") {
        bail!("please install what your system calls: {list}");
    }
    let by_hand = || format!("please install by hand: apt-get install {list}");
    apt_get("update").with_context(by_hand)?;
    apt_get(&format!("install --yes --no-install-recommends {list}")).with_context(by_hand)
}

/// Runs apt-get quietly: its output is shown only if it fails.
fn apt_get(args: &str) -> Result<()> {
    let mut apt_get = as_root("env")?;
    apt_get.args(["DEBIAN_FRONTEND=noninteractive", "apt-get", "-qq"]);
    apt_get.args(args.split_whitespace());
    eprintln!("$ apt-get {args}");
    shell::output(&mut apt_get).map(drop)
}

/// Prepares a program to be started as root.
pub fn as_root(program: &str) -> Result<Command> {
    let user = shell::output(shell::command("id").arg("-u"))?;
    if user.trim() == "0" {
        return Ok(shell::command(program));
    }
    if !shell::has("sudo") {
        bail!("this needs root, and there is no sudo");
    }
    let mut sudo = shell::command("sudo");
    sudo.arg(program);
    Ok(sudo)
}
