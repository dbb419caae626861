//! The network, from the file that `NETWORK` names or from `src/braille.rs`, and its spikes, from `SPIKES` or those that
//! it was published with; and the linker script of cortex-m-rt, said once and here: a second `-Tlink.x` fails to link.

use std::{env, fmt::Write, fs, path::Path};

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let place = env::var("OUT_DIR").unwrap();
    let read = |name: &str, usual: &str| {
        println!("cargo:rerun-if-env-changed={name}");
        let path = env::var(name).unwrap_or_else(|_| usual.to_owned());
        println!("cargo:rerun-if-changed={path}");
        fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
    };
    let network = Path::new(&place).join("network.rs");
    fs::write(&network, read("NETWORK", "src/braille.rs")).unwrap();
    // A file with documentation of its own is a module, and not included.
    let mut text = format!("#[path = {network:?}]\nmod network;\n\n");
    let spikes = read("SPIKES", "../../laptop/cli/tests/peers/nir/braille.txt");
    writeln!(text, "static SPIKES: [&[u16]; {}] = [", spikes.lines().count()).unwrap();
    for line in spikes.lines() {
        let inputs: Vec<&str> = line.split_whitespace().collect();
        writeln!(text, "    &[{}],", inputs.join(", ")).unwrap();
    }
    text += "];\n";
    fs::write(Path::new(&place).join("trained.rs"), text).unwrap();
    if env::var("CARGO_CFG_TARGET_OS").unwrap() == "none" {
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
    }
}
