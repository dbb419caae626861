//! Parses the output of a disassembler, instruction by instruction.

use crate::common::shell;
use anyhow::Result;
use std::path::Path;

/// One line of the output: an instruction.
#[derive(Clone, Debug)]
pub struct Instruction {
    pub address: u32,
    /// Size in bytes.
    size: u32,
    /// Mnemonic without what follows a dot, and without the condition of a block after `it`.
    pub name: String,
    pub operands: String,
    /// Whether it is in a block after `it`.
    pub is_conditional: bool,
}

const CONDITIONS: [&str; 16] = [
    "eq", "ne", "cs", "hs", "cc", "lo", "mi", "pl", "vs", "vc", "hi", "ls", "ge", "lt", "gt", "le",
];

/// Disassembles an image.
pub fn of(image: &Path) -> Result<Vec<Instruction>> {
    let mut objdump = shell::command("arm-none-eabi-objdump");
    Ok(instructions(&shell::output(objdump.arg("-d").arg(image))?))
}

/// Parses the instructions in order; leaves out data.
pub fn instructions(listing: &str) -> Vec<Instruction> {
    let mut conditional = 0;
    let mut all = Vec::new();
    for line in listing.lines() {
        let Some(mut one) = Instruction::read(line) else { continue };
        if is_block(&one.name) {
            conditional = one.name.len() - 1;
            one.name = "it".into();
        } else if conditional > 0 {
            conditional -= 1;
            one.is_conditional = true;
            let bare = CONDITIONS.iter().find_map(|condition| one.name.strip_suffix(condition));
            if let Some(bare) = bare {
                one.name = bare.into();
            }
        }
        all.push(one);
    }
    all
}

/// Returns whether this is `it`, `itt`, `ite` or similar.
fn is_block(name: &str) -> bool {
    name.strip_prefix("it").is_some_and(|rest| rest.chars().all(|at| matches!(at, 't' | 'e')))
}

impl Instruction {
    /// Parses ` 8000404:`, a tab, `f7ff fffe`, a tab, `ldr.w`, a tab, `r0, [r1, #4]`.
    fn read(line: &str) -> Option<Self> {
        let (address, rest) = line.trim_start().split_once(":\t")?;
        let (bytes, text) = rest.split_once('\t')?;
        let (name, operands) = text.split_once('\t').unwrap_or((text, ""));
        if name.starts_with('.') {
            return None;
        }
        let operands = operands.split(['@', ';']).next()?.trim();
        Some(Self {
            address: u32::from_str_radix(address, 16).ok()?,
            size: if bytes.trim().len() > 4 { 4 } else { 2 },
            name: name.split('.').next()?.trim().to_owned(),
            operands: operands.to_owned(),
            is_conditional: false,
        })
    }

    /// Returns the address after the instruction.
    pub fn next(&self) -> u32 {
        self.address + self.size
    }

    pub fn text(&self) -> String {
        format!("{} {}", self.name, self.operands)
    }

    /// Returns whether it is a branch with a condition of its own.
    pub fn is_conditional_branch(&self) -> bool {
        let condition = self.name.strip_prefix('b');
        matches!(self.name.as_str(), "cbz" | "cbnz")
            || condition.is_some_and(|condition| CONDITIONS.contains(&condition))
    }

    /// Returns whether it may branch.
    pub fn is_branch(&self) -> bool {
        let loads = matches!(self.name.as_str(), "pop" | "ldm" | "ldmia" | "ldmdb");
        matches!(self.name.as_str(), "b" | "bl" | "bx" | "blx" | "tbb" | "tbh")
            || self.is_conditional_branch()
            || loads && self.operands.contains("pc}")
            || !loads && self.operands.starts_with("pc,")
    }

    /// Returns the address to which it may branch, if the instruction contains it.
    pub fn target(&self) -> Option<u32> {
        let target = match self.name.as_str() {
            "cbz" | "cbnz" => self.operands.split_once(", ")?.1,
            _ if self.is_branch() => &self.operands,
            _ => return None,
        };
        u32::from_str_radix(target.split(' ').next()?, 16).ok()
    }

    /// Returns the number of registers in its list.
    pub fn registers(&self) -> u32 {
        let Some((_, list)) = self.operands.split_once('{') else { return 0 };
        let number = |name: &str| name[1..].parse::<u32>().ok();
        let ranges = list.trim_end_matches(['}', '^']).split(", ").map(|range| {
            let words = if range.starts_with('d') { 2 } else { 1 };
            let many = range.split_once('-').and_then(|(first, last)| {
                let first = number(first)?;
                Some(1 + named(last)?.checked_sub(first)?)
            });
            words * many.unwrap_or(1)
        });
        ranges.sum()
    }

    /// Returns whether LR or PC is in its list of registers.
    pub fn has_link(&self) -> bool {
        ["lr}", "pc}"].iter().any(|end| self.operands.ends_with(end))
    }

    /// Returns whether it writes to the register: most instructions write to their first operand, some to the first
    /// two.
    fn writes(&self, register: &str) -> bool {
        let many = if self.name.contains("ull") || self.name.contains("lal") { 2 } else { 1 };
        self.operands.split(", ").take(many).any(|operand| operand == register)
    }

    /// Returns the registers within brackets.
    fn address_registers(&self) -> impl Iterator<Item = &str> {
        let inside = self.operands.split_once('[').map_or("", |(_, rest)| rest);
        let base = match self.name.as_str() {
            "ldm" | "ldmia" | "ldmdb" | "stm" | "stmia" | "stmdb" | "vldmia" | "vstmia"
            | "vldmdb" | "vstmdb" => self.operands.as_str(),
            "push" | "pop" | "vpush" | "vpop" => "sp",
            _ => "",
        };
        let base = base.split(['!', ',']).next().into_iter();
        inside.split([',', ']']).map(str::trim).chain(base).filter(|name| !name.is_empty())
    }

    fn is_single_load(&self) -> bool {
        self.name.starts_with("ldr") && self.name != "ldrd" && !self.is_branch()
    }

    fn is_store(&self) -> bool {
        self.name.starts_with("str") || self.name.starts_with("stm") || self.name == "vstr"
    }

    /// Returns whether its result is used by `other` to compute an address, directly after it.
    pub fn is_address_of(&self, other: &Self) -> bool {
        let is_data_processing = !self.name.starts_with("ldr")
            && !self.is_store()
            && !self.is_branch()
            && !matches!(self.name.as_str(), "cmp" | "cmn" | "tst" | "teq" | "it" | "nop" | "push");
        is_data_processing && other.address_registers().any(|register| self.writes(register))
    }

    /// Returns whether it is a load that may be pipelined with its neighbour.
    pub fn pairs_with(&self, other: &Self) -> bool {
        self.is_single_load() && !other.address_registers().any(|register| self.writes(register))
    }

    /// Returns whether it is floating-point arithmetic, whose result is available later.
    pub fn is_arithmetic(&self) -> bool {
        const NAMES: [&str; 16] = [
            "vadd", "vsub", "vmul", "vnmul", "vdiv", "vsqrt", "vmla", "vmls", "vnmla", "vnmls",
            "vfma", "vfms", "vfnma", "vfnms", "vcvt", "vcvtr",
        ];
        NAMES.contains(&self.name.as_str())
    }

    /// Returns whether `other` uses its result.
    pub fn gives(&self, other: &Self) -> bool {
        other.operands.split([',', ' ', '{', '}']).any(|register| self.writes(register))
    }
}

/// Parses the name of a register; `r4` to `r15` have other names too.
fn named(register: &str) -> Option<u32> {
    match register {
        "sl" => Some(10),
        "fp" => Some(11),
        "ip" => Some(12),
        "lr" => Some(14),
        _ => register.get(1..)?.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_registers_are_counted() {
        let registers =
            |list: &str| instructions(&format!(" 0:\tbf00\tpop\t{list}\n"))[0].registers();
        assert_eq!(registers("{r4, r5, pc}"), 3);
        assert_eq!(registers("{r4-r7, lr}"), 5);
        assert_eq!(registers("{r4, r5, r6, r7, r8, r9, sl, fp, pc}"), 9);
        assert_eq!(registers("{r8-fp}"), 4);
        assert_eq!(registers("{s16-s19}"), 4);
        assert_eq!(registers("{d8-d9}"), 4);
    }

    #[test]
    fn branches_are_told_from_what_begins_alike() {
        let one = |text: &str| instructions(&format!(" 0:\tbf00\t{text}\n")).remove(0);
        assert_eq!(one("bl\t8000458 <_RNv>").target(), Some(0x800_0458));
        assert_eq!(one("cbz\tr0, 8 <a>").target(), Some(8));
        assert_eq!(one("bx\tlr").target(), None);
        for branch in
            ["b.n\t8", "beq.w\t8", "bls.n\t8", "pop\t{r4, pc}", "ldr.w\tpc, [r1]", "mov\tpc, lr"]
        {
            assert!(one(branch).is_branch(), "{branch}");
        }
        for other in [
            "bic.w\tr0, r1",
            "bics\tr0, r1",
            "bfi\tr0, r1, #0, #3",
            "ldr\tr0, [pc, #4]",
            "pop\t{r4}",
        ] {
            assert!(!one(other).is_branch(), "{other}");
        }
    }
}
