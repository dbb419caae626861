//! Measures the size of a codec's code, from the image's symbols and its disassembly.

use super::{listing, measured::Compilers};
use crate::common::shell;
use anyhow::{Context, Result};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

/// Rust functions by their address. Those of the runtime (`memcpy`, software floating point) are left out: a program
/// has them once, whatever codecs it uses.
pub struct Code(BTreeMap<u32, Function>);

#[derive(Default)]
struct Function {
    bytes: u32,
    /// Addresses to which it branches, including those of its own loops.
    branches: BTreeSet<u32>,
}

impl Code {
    pub fn read(image: &Path) -> Result<Self> {
        let symbols = shell::output(shell::command("arm-none-eabi-nm").arg("-S").arg(image))?;
        let mut functions: BTreeMap<u32, Function> = symbols.lines().filter_map(function).collect();

        for one in listing::of(image)? {
            let function = functions.range_mut(..=one.address).next_back();
            if let (Some((_, function)), Some(to)) = (function, one.target()) {
                function.branches.insert(to);
            }
        }
        Ok(Self(functions))
    }

    /// Returns the size in bytes of the function at this address, with the functions that it calls and that were not
    /// inlined.
    ///
    /// If a slice form calls the sample form, for samples before the first one or not finite, that form is included, as
    /// the slice form does not work without it. Users of single samples link only the sample form, which is measured by
    /// itself.
    pub fn bytes(&self, address: u32) -> u32 {
        let (mut found, mut waiting) = (BTreeSet::new(), vec![address & !1]);
        let mut bytes = 0;
        while let Some(address) = waiting.pop() {
            if let Some(function) = self.0.get(&address)
                && found.insert(address)
            {
                bytes += function.bytes;
                waiting.extend(&function.branches);
            }
        }
        bytes
    }
}

/// Parses `08000400 0000003e t _RNv…`: address, size, kind and name.
fn function(line: &str) -> Option<(u32, Function)> {
    let mut words = line.split(' ');
    let address = u32::from_str_radix(words.next()?, 16).ok()?;
    let bytes = u32::from_str_radix(words.next()?, 16).ok()?;
    let (kind, name) = (words.next()?, words.next()?);
    let counts = kind.eq_ignore_ascii_case("t") && name.starts_with("_R");
    counts.then(|| (address, Function { bytes, ..Function::default() }))
}

/// Returns `rustc version 1.96.0 (…)`, as the compiler wrote it into the image, and the first line of GCC's version.
pub fn compilers(image: &Path) -> Result<Compilers> {
    let mut readelf = shell::command("arm-none-eabi-readelf");
    let comment = shell::output(readelf.args(["-p", ".comment"]).arg(image))?;
    let line = comment.lines().find_map(|line| line.find("rustc").map(|at| line[at..].to_owned()));
    let rustc = line.context("the image does not say which compiler made it")?;
    let gcc = shell::output(shell::command("arm-none-eabi-gcc").arg("--version"))?;
    Ok(Compilers { rustc, gcc: gcc.lines().next().unwrap_or_default().to_owned() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn callees_count_once_and_the_runtime_does_not() {
        let function = |bytes, branches: [u32; 2]| Function { bytes, branches: branches.into() };
        let code = Code([(16, function(10, [16, 32])), (32, function(6, [16, 64]))].into());
        assert_eq!(code.bytes(17), 16);
    }
}
