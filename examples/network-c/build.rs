//! The network, from the file that `NETWORK` names or that of `trained`.

use std::{env, fs, path::Path};

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed=NETWORK");
    let path = env::var("NETWORK").unwrap_or_else(|_| "../trained/src/braille.rs".to_owned());
    println!("cargo:rerun-if-changed={path}");
    let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
    let place = env::var("OUT_DIR").unwrap();
    let module = Path::new(&place).join("network.rs");
    fs::write(&module, text).unwrap();
    // A file with documentation of its own is a module, and not included.
    let declared = format!("#[path = {module:?}]\nmod network;\n");
    fs::write(Path::new(&place).join("declared.rs"), declared).unwrap();
}
