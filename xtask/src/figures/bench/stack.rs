//! Bounds the stack of a function: adds up the frames of the functions in the image along the deepest chain of calls.
//!
//! Both are read from the compiler's instructions. Every push and every decrement of the stack pointer in a function is
//! added, even if some lie on paths that exclude each other; a jump to another function counts as a call. Only calls
//! through a pointer are left out, of which the crate has one: the waker of the program that waits on a queue.

use super::listing::{self, Instruction};
use crate::common::shell;
use anyhow::{Context, Result, bail, ensure};
use std::{
    cell::RefCell,
    collections::{BTreeMap, BTreeSet, HashMap},
    path::Path,
};

/// Distance in bytes of a false jump: the linker fills gaps between functions with D4 D4, which reads as a jump
/// backwards, and is never reached.
const FILLING: u32 = 84;

/// All functions of an image, by address.
pub struct Stack {
    functions: BTreeMap<u32, Function>,
    known: RefCell<HashMap<u32, Depth>>,
}

#[derive(Default)]
struct Function {
    name: String,
    frame: u32,
    calls: BTreeSet<u32>,
    /// Whether it calls through a pointer.
    is_blind: bool,
    /// An instruction that uses the stack in an unknown way, if there is one.
    unknown: Option<String>,
}

/// Depth of the stack in a function.
#[derive(Clone, Copy)]
pub struct Depth {
    pub bytes: u32,
    /// Whether a call through a pointer may add to it.
    pub is_blind: bool,
}

impl Stack {
    pub fn read(image: &Path) -> Result<Self> {
        let symbols = shell::output(shell::command("arm-none-eabi-nm").arg("-C").arg(image))?;
        let mut functions: BTreeMap<u32, Function> = symbols.lines().filter_map(symbol).collect();
        for one in listing::of(image)? {
            let (at, target) = (one.address, one.target());
            if one.name == "bmi" && target == Some(at.wrapping_sub(FILLING)) {
                continue;
            }
            let owner = |at: u32| functions.range(..=at).next_back().map(|(own, _)| *own);
            let (Some(own), to) = (owner(at), target.and_then(owner)) else { continue };
            let function = functions.get_mut(&own).context("an owner is a function")?;
            match frame(&one) {
                Ok(bytes) => function.frame += bytes,
                Err(error) => function.unknown = Some(format!("{error}: {}", one.text())),
            }
            match to {
                // To its own start a loop is no call, but `bl` is; a Cortex-M0 also jumps far with it within a function.
                Some(to) if to != own || one.name == "bl" && target == Some(own) => {
                    function.calls.extend([to])
                }
                _ => {}
            }
            let is_call = one.name == "blx" && target.is_none();
            function.is_blind |=
                is_call || one.name == "bx" && !["lr", "pc"].contains(&one.operands.as_str());
        }
        Ok(Self { functions, known: RefCell::default() })
    }

    /// Returns the depth of the function at this address: its own frame, and the deepest of those that it calls.
    pub fn depth(&self, address: u32) -> Result<Depth> {
        self.deepest(address & !1, &mut Vec::new())
    }

    /// Returns the frame of the closure between the function and the code that paints the stack, if the closure was not
    /// inlined.
    pub fn between(&self, address: u32) -> u32 {
        let address = address & !1;
        let painters =
            self.functions.values().filter(|one| one.name.contains("stopwatch::stack_depth"));
        let closures = painters.flat_map(|one| &one.calls).filter_map(|at| self.functions.get(at));
        let calling = closures.filter(|closure| closure.calls.contains(&address));
        calling.map(|closure| closure.frame).max().unwrap_or(0)
    }

    /// Returns the deepest function below these paths, with its name.
    pub fn deepest_of(&self, paths: &[&str]) -> Result<Option<(Depth, &str)>> {
        let within =
            |name: &str| paths.iter().any(|path| name.trim_start_matches('<').starts_with(path));
        let mut deepest: Option<(Depth, &str)> = None;
        for (address, function) in self.functions.iter().filter(|(_, one)| within(&one.name)) {
            let depth = self.depth(*address)?;
            if deepest.is_none_or(|(most, _)| depth.bytes > most.bytes) {
                deepest = Some((depth, &function.name));
            }
        }
        Ok(deepest)
    }

    fn deepest(&self, address: u32, way: &mut Vec<u32>) -> Result<Depth> {
        if let Some(known) = self.known.borrow().get(&address) {
            return Ok(*known);
        }
        let function =
            self.functions.get(&address).with_context(|| format!("no function at {address:#x}"))?;
        ensure!(!way.contains(&address), "{} calls itself: its stack has no bound", function.name);
        if let Some(unknown) = &function.unknown {
            bail!("{}: {unknown}", function.name);
        }
        way.push(address);
        let mut depth = Depth { bytes: 0, is_blind: function.is_blind };
        for callee in &function.calls {
            let below = self.deepest(*callee, way)?;
            depth.bytes = depth.bytes.max(below.bytes);
            depth.is_blind |= below.is_blind;
        }
        way.pop();
        depth.bytes += function.frame;
        self.known.borrow_mut().insert(address, depth);
        Ok(depth)
    }
}

/// Parses `08000400 t name`: a function, by its address without the Thumb bit.
fn symbol(line: &str) -> Option<(u32, Function)> {
    let (address, rest) = line.split_once(' ')?;
    let (kind, name) = rest.split_once(' ')?;
    let address = u32::from_str_radix(address, 16).ok()? & !1;
    let is_code = matches!(kind, "t" | "T" | "w" | "W");
    (is_code && !name.starts_with('$'))
        .then(|| (address, Function { name: name.into(), ..Function::default() }))
}

/// Returns how far an instruction lowers the stack pointer, in bytes.
fn frame(one: &Instruction) -> Result<u32> {
    let operands = one.operands.as_str();
    let number = |text: &str| -> Result<u32> { Ok(text.trim_end_matches(['!', ']']).parse()?) };
    match one.name.as_str() {
        "push" | "vpush" => Ok(4 * one.registers()),
        "stmdb" | "stmfd" | "vstmdb" if operands.starts_with("sp!") => Ok(4 * one.registers()),
        "sub" | "subw" | "subs" if operands.starts_with("sp, ") => {
            match operands.rsplit_once('#') {
                Some((_, bytes)) => number(bytes),
                None => bail!("the stack grows by what is not known"),
            }
        }
        "add" if operands.starts_with("sp, ") && !operands.contains('#') => {
            // So a Cortex-M0 takes frames of more than half a kibibyte; none of what is bounded here does.
            bail!("the stack moves by what a register holds")
        }
        _ => match operands.split_once("[sp, #-") {
            Some((_, bytes)) if bytes.ends_with("]!") => number(bytes),
            _ => Ok(0),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_read() {
        let of = |line: &str| {
            let listing = format!(" 8000404:\tbf00\t{line}");
            frame(&listing::instructions(&listing)[0]).ok()
        };
        assert_eq!(of("push\t{r4, r5, r6, lr}"), Some(16));
        assert_eq!(of("stmdb\tsp!, {r4-r11, lr}"), Some(36));
        assert_eq!(of("vpush\t{d8-d10}"), Some(24));
        assert_eq!(of("sub.w\tsp, sp, #1040\t@ 0x410"), Some(1040));
        assert_eq!(of("str.w\tfp, [sp, #-4]!"), Some(4));
        assert_eq!(of("str\tr0, [sp, #4]"), Some(0));
        assert_eq!(of("sub.w\tsp, sp, r4"), None, "a frame without a bound");
    }

    #[test]
    fn the_deepest_way_counts_and_a_circle_has_no_bound() {
        let function = |frame, calls: &[u32]| Function {
            frame,
            calls: calls.iter().copied().collect(),
            ..Function::default()
        };
        let stack = |functions: [(u32, Function); 3]| Stack {
            functions: functions.into(),
            known: RefCell::default(),
        };
        let tree = stack([
            (16, function(8, &[32, 48])),
            (32, function(4, &[48])),
            (48, function(100, &[])),
        ]);
        assert_eq!(tree.depth(17).unwrap().bytes, 112);
        let circle =
            stack([(16, function(8, &[32])), (32, function(4, &[16])), (48, function(1, &[]))]);
        assert!(circle.depth(16).is_err());
    }
}
