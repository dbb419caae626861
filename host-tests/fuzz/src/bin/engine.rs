//! A target under libFuzzer: the one that `FUZZ_TARGET` names.
#![no_main]
#![allow(unsafe_code, missing_docs)]

use libfuzzer_sys::fuzz_target;
use std::sync::OnceLock;

static CHOSEN: OnceLock<fn(&[u8])> = OnceLock::new();

fn chosen() -> fn(&[u8]) {
    let name = std::env::var("FUZZ_TARGET").expect("FUZZ_TARGET names a target");
    fuzz::named(&name).unwrap_or_else(|| panic!("there is no target `{name}`")).run
}

fuzz_target!(|bytes: &[u8]| CHOSEN.get_or_init(chosen)(bytes));
