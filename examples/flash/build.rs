//! Which codec is linked, and with which calls: `CODEC` is `sample/` or `slice/`, then a name in `src/codec.rs`.

use std::env;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed=CODEC");
    println!("cargo:rustc-check-cfg=cfg(calls, values(any()))");
    println!("cargo:rustc-check-cfg=cfg(codec, values(any()))");
    let chosen = env::var("CODEC").unwrap_or_default();
    let (calls, codec) = chosen.split_once('/').unwrap_or_default();
    println!("cargo:rustc-cfg=calls=\"{calls}\"");
    println!("cargo:rustc-cfg=codec=\"{codec}\"");
}
