//! `cargo xtask page`: builds the laptop library as WebAssembly in one HTML file, serves it, and checks it in a
//! browser.

use crate::common::{cargo, command, lint, paths, run, shell, usage};
use crate::figures::drawing;
use crate::setup;
use crate::setup::{distribution, toolchain};
use anyhow::{Context, Result};
use std::{
    env, fs,
    io::{BufRead, BufReader, Write},
    net::{Ipv4Addr, TcpListener, TcpStream},
    path::{Path, PathBuf},
    process::Command,
};

const TARGET: &str = "wasm32-unknown-unknown";
/// Port on which the page is served, if it is free.
const PORT: u16 = 8000;
/// Browsers that drive the page: the package, and the names that the program may have.
const BROWSERS: [(&str, [&str; 2]); 2] =
    [("chromium", ["chromium", "chromium-browser"]), ("firefox-esr", ["firefox-esr", "firefox"])];

/// Builds the page, and serves it on request.
pub fn page(args: &[String]) -> Result<()> {
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    let serves = match args[..] {
        [] => false,
        ["--serve"] => true,
        _ => return Err(usage("cargo xtask page [--serve]".into())),
    };
    let page = build()?;
    if serves {
        serve(&page)?;
    }
    println!("Open it in a browser, or put it on any host: {}", page.display());
    Ok(())
}

/// Builds the page; returns its path.
pub fn build() -> Result<PathBuf> {
    let site = installed()?;
    run(&mut library()?)?;
    let module = target().join(TARGET).join("release/page.wasm");
    let page = target().join("index.html");
    run(command("node").current_dir(site).arg("build.mjs").arg(module).arg(&page))?;
    Ok(page)
}

fn target() -> PathBuf {
    paths::target().join("page")
}

/// Copies the page's sources beside the packages that they import, and installs these.
fn installed() -> Result<PathBuf> {
    let (from, site) = (paths::root().join("laptop/page"), target().join("site"));
    for part in ["", "js", "test"] {
        fs::create_dir_all(site.join(part))?;
        for file in fs::read_dir(from.join(part))? {
            let file = file?;
            if file.file_type()?.is_file() {
                fs::copy(file.path(), site.join(part).join(file.file_name()))?;
            }
        }
    }
    if !["node", "npm"].iter().all(|program| shell::has(program)) {
        setup::packages("Node.js, which bundles the page", &["nodejs", "npm"])?;
    }
    let lock = |directory: &Path| fs::read(directory.join("package-lock.json")).ok();
    let packages = site.join("node_modules");
    if lock(&packages) != lock(&site) {
        run(command("npm").current_dir(&site).args(["ci", "--silent", "--no-audit", "--no-fund"]))
            .context("npm and Node.js 18 or newer are needed")?;
        fs::copy(site.join("package-lock.json"), packages.join("package-lock.json"))?;
    }
    Ok(site)
}

/// Prepares cargo for WebAssembly: of the current toolchain if it has the standard library, or else of the
/// distribution's compiler, which builds that from source. Clippy replaces the compiler for the page's own crate.
fn library() -> Result<Command> {
    setup::wasm(TARGET)?;
    let by_default = toolchain::has_core(TARGET)?;
    let mut build = command(if by_default { "cargo" } else { distribution::CARGO });
    build.args(["build", "--release", "--locked", "--manifest-path", "laptop/page/Cargo.toml"]);
    build.args(["--target", TARGET]);
    build.env("CARGO_TARGET_DIR", target()).env("CARGO_INCREMENTAL", "0");
    lint(&mut build);
    if !by_default {
        build.arg("-Zbuild-std=std,panic_abort");
        build.env("RUSTC", distribution::RUSTC).env("RUSTC_BOOTSTRAP", "1"); // -Zbuild-std on a stable compiler
        build.env("RUSTC_WORKSPACE_WRAPPER", distribution::CLIPPY);
    }
    Ok(build)
}

/// Serves the page on this machine only, until the program is ended.
fn serve(page: &Path) -> Result<()> {
    let content = fs::read(page)?;
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, PORT))
        .or_else(|_| TcpListener::bind((Ipv4Addr::LOCALHOST, 0)))?;
    println!("http://{} until Ctrl-C", listener.local_addr()?);
    for stream in listener.incoming() {
        // A browser that goes away is no error.
        let _ = stream.map_err(Into::into).and_then(|stream| respond(stream, &content));
    }
    Ok(())
}

fn respond(mut stream: TcpStream, page: &[u8]) -> Result<()> {
    let mut lines = BufReader::new(stream.try_clone()?).lines();
    let request = lines.next().context("no request")??;
    while lines.next().context("cut short")??.as_str() != "" {}
    let (status, body) = match request.split(' ').nth(1) {
        Some("/" | "/index.html") => ("200 OK", page),
        _ => ("404 Not Found", &b"not here"[..]),
    };
    let length = body.len();
    write!(
        stream,
        "HTTP/1.1 {status}\r\ncontent-type: text/html; charset=utf-8\r\ncontent-length: {length}\r\n\
         connection: close\r\n\r\n"
    )?;
    stream.write_all(body)?;
    Ok(())
}

/// Drives the page in a browser, and compares it with the laptop program.
pub fn verify() -> Result<()> {
    drive(None, env::var_os("PICTURES").map(|pictures| paths::root().join(pictures)))
}

/// Takes the documentation's picture of the page.
pub fn write() -> Result<()> {
    let pictures = target().join("pictures");
    fs::create_dir_all(&pictures)?;
    drive(Some("compares settings"), Some(pictures.clone()))?;
    drawing::keep(&pictures.join("page.png"), "docs/page.png")
}

/// Runs all checks, or the one of this name; keeps pictures of the page in a directory if one is given.
fn drive(only: Option<&str>, pictures: Option<PathBuf>) -> Result<()> {
    let page = build()?;
    let mut browsers = Vec::new();
    for (package, names) in BROWSERS {
        let found = || names.into_iter().find(|name| shell::has(name));
        if found().is_none() {
            setup::packages("a browser, without a window", &[package])?;
        }
        browsers.push(found().with_context(|| format!("no {package} on the path"))?);
    }
    let logs = target().join("logs");
    fs::create_dir_all(&logs)?;
    run(&mut cargo("build --package spikewire-cli --bins --examples"))?;
    let built = paths::target().join("debug");
    run(command(built.join("examples/made-logs")).arg(&logs))?;
    let mut test = command("node");
    test.current_dir(target().join("site")).arg("test/run.mjs").args(only);
    test.env("PAGE", page).env("LOGS", logs).env("SPIKEWIRE", built.join("spikewire"));
    test.env("CHROMIUM", browsers[0]).env("FIREFOX", browsers[1]);
    test.env("DATA", paths::root().join("data"));
    if let Some(pictures) = pictures {
        test.env("PICTURES", pictures);
    }
    run(&mut test)
}
