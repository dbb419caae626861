//! Counts the cycles of what a board executes, by the tables of the technical reference manuals, for memory without
//! wait states.
//!
//! Counts for a Cortex-M0+ and a Cortex-M0 are exact (ARM DDI 0484C and 0432C, single-cycle multiplier). Those for a
//! Cortex-M3 and a Cortex-M4F are bounds (ARM DDI 0337I and 0439B, section 3.3): it is not known how a load pairs with
//! its neighbours, how much of the pipeline a branch refills, and how long a division takes.

use super::listing::{self, Instruction};
use crate::common::{paths, shell};
use crate::programs::{boards::Board, qemu};
use anyhow::{Context, Result, bail};
use std::{
    fmt::Write,
    fs,
    path::{Path, PathBuf},
    sync::Mutex,
};

/// The manual that is followed. Of each pair of counts, the first is the lower bound.
#[derive(Clone, Copy, PartialEq)]
pub enum Model {
    /// Cortex-M0+ and Cortex-M0: the pair holds an exact count for each.
    M0,
    M3,
    M4,
}

/// Cycles of an instruction, and the additional ones if it branches.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cycles {
    pub once: [u32; 2],
    pub taken: [u32; 2],
}

const fn always(least: u32, most: u32) -> Cycles {
    Cycles { once: [least, most], taken: [0, 0] }
}

const fn exactly(cycles: u32) -> Cycles {
    always(cycles, cycles)
}

const fn if_taken(more: [u32; 2]) -> Cycles {
    Cycles { once: [1, 1], taken: more }
}

impl Model {
    /// Returns the model of a board's core, if there is one.
    pub fn of(board: &Board) -> Option<Self> {
        match board.core {
            "M0" => Some(Self::M0),
            "M3" => Some(Self::M3),
            "M4F" => Some(Self::M4),
            _ => None,
        }
    }

    /// Returns the cycles of an instruction, given the one before it in memory; an error if it is in no table.
    pub fn cycles(self, before: Option<&Instruction>, one: &Instruction) -> Result<Cycles> {
        let found = match self {
            Self::M0 => small(one),
            Self::M3 | Self::M4 => self.large(before, one),
        };
        let found = found.with_context(|| format!("no cycles are known of `{}`", one.text()))?;
        if !one.is_conditional {
            return Ok(found);
        }
        // What is not executed takes one, and what branches is known by where it goes on.
        if one.is_branch() {
            let more = found.once.map(|cycles| cycles.saturating_sub(1));
            return Ok(if_taken(more));
        }
        Ok(always(found.once[0].min(1), found.once[1]))
    }

    fn large(self, before: Option<&Instruction>, one: &Instruction) -> Option<Cycles> {
        /// Cycles to refill the pipeline.
        const REFILL: [u32; 2] = [1, 3];
        let [least, most] = REFILL;
        if one.is_conditional_branch() {
            return Some(if_taken(REFILL));
        }
        if let Some(float) = self.float(before, one) {
            return Some(float);
        }
        // The register bank is written before an address is made of it.
        let waits = u32::from(before.is_some_and(|before| before.is_address_of(one)));
        Some(match one.name.as_str() {
            "b" | "bl" | "bx" | "blx" => always(1 + least, 1 + most),
            // Table and notes differ: 2 and a refill, or at least six.
            "tbb" | "tbh" => always(2 + least, 3 + most),
            "pop" | "ldm" | "ldmia" | "ldmdb" | "push" | "stm" | "stmia" | "stmdb" => {
                let all = 1 + one.registers();
                let refill = if one.is_branch() { REFILL } else { [0, 0] };
                always(all + refill[0], all + refill[1] + waits)
            }
            "ldrd" | "strd" => always(3, 3 + waits),
            name if name.starts_with("ldr") && one.is_branch() => {
                always(2 + least, 2 + most + waits)
            }
            name if name.starts_with("ldr") => {
                let pairs = before.is_some_and(|before| before.pairs_with(one));
                let literal = u32::from(one.operands.contains("[pc"));
                always(2 - u32::from(pairs), 2 + waits + literal)
            }
            name if name.starts_with("str") => always(1, 2 + waits),
            "sdiv" | "udiv" => always(2, 12),
            "mla" | "mls" if self == Self::M3 => exactly(2),
            "smull" | "umull" if self == Self::M3 => always(3, 5),
            "smlal" | "umlal" if self == Self::M3 => always(4, 7),
            "it" => always(0, 1),
            "cps" | "cpsie" | "cpsid" | "mrs" | "msr" => always(1, 2),
            "dmb" | "dsb" => always(1, 1 + most),
            "isb" => always(1 + least, 1 + most),
            "bkpt" => exactly(0),
            _ if one.is_branch() => always(1 + least, 1 + most),
            name if is_simple(name) || is_simple_dsp(name) => exactly(1),
            _ => return None,
        })
    }

    /// Returns the cycles of a floating-point instruction (ARM DDI 0439B, table 7-1).
    fn float(self, before: Option<&Instruction>, one: &Instruction) -> Option<Cycles> {
        if !one.name.starts_with('v') {
            return None;
        }
        // A result that the next instruction takes is late by one.
        let late = before.is_some_and(|before| before.is_arithmetic() && before.gives(one));
        let waits = before.is_some_and(|before| before.is_address_of(one));
        let more = u32::from(late) + u32::from(waits);
        let [least, most] = match one.name.as_str() {
            // Two registers of 32 bits, or one of 64, come one after the other.
            "vldr" if one.operands.starts_with('d') => [3, 3],
            "vldr" => [2, 2],
            "vstr" if one.operands.starts_with('d') => [2, 3],
            "vstr" => [1, 2],
            "vldmia" | "vldmdb" | "vstmia" | "vstmdb" | "vpush" | "vpop" => {
                [1 + one.registers(); 2]
            }
            // Integer instructions go on while they work.
            "vdiv" | "vsqrt" => [1, 14],
            "vmla" | "vmls" | "vnmla" | "vnmls" | "vfma" | "vfms" | "vfnma" | "vfnms" => [3, 3],
            "vmov" if one.operands.split(", ").count() > 2 => [2, 2],
            "vmov" | "vmrs" | "vmsr" | "vadd" | "vsub" | "vmul" | "vnmul" | "vneg" | "vabs"
            | "vcmp" | "vcmpe" | "vcvt" | "vcvtr" => [1, 1],
            _ => return None,
        };
        Some(always(least, most + more))
    }
}

/// Returns the cycles on a Cortex-M0+ and on a Cortex-M0.
fn small(one: &Instruction) -> Option<Cycles> {
    if one.is_conditional_branch() {
        return Some(if_taken([1, 2]));
    }
    Some(match one.name.as_str() {
        "bl" => always(3, 4),
        "b" | "bx" | "blx" => always(2, 3),
        "pop" if one.is_branch() => always(3 + one.registers(), 4 + one.registers()),
        "pop" | "ldmia" | "push" | "stmia" => exactly(1 + one.registers()),
        "mrs" | "msr" | "dmb" | "dsb" | "isb" => always(3, 4),
        "cpsie" | "cpsid" => exactly(1),
        "bkpt" => exactly(0),
        _ if one.is_branch() => always(2, 3),
        name if name.starts_with("ldr") || name.starts_with("str") => exactly(2),
        name if is_simple(name) => exactly(1),
        _ => return None,
    })
}

/// Returns whether the instruction takes one cycle on every core.
fn is_simple(name: &str) -> bool {
    const NAMES: &str = " mov movw movt mvn add addw adc sub subw sbc rsb neg mul and orr orn eor bic cmp cmn tst teq \
        lsl lsr asr ror rrx rev rev16 revsh rbit clz uxtb uxth sxtb sxth uxtab uxtah sxtab sxtah ubfx sbfx bfi bfc \
        ssat usat adr nop udf svc wfi wfe sev yield clrex pld ";
    let is_in = |name: &str| NAMES.contains(&format!(" {name} "));
    is_in(name) || name.strip_suffix('s').is_some_and(is_in)
}

/// Returns whether the instruction takes one cycle on a Cortex-M4; a Cortex-M3 has it not, or it was handled before.
fn is_simple_dsp(name: &str) -> bool {
    let beginnings = [
        "mla", "mls", "smul", "umul", "smla", "umla", "umaal", "smm", "smu", "sml", "qadd", "qsub",
        "qd", "uqadd", "uqsub", "sadd", "ssub", "uadd", "usub", "uhadd", "shadd", "sel", "pkh",
        "usad", "uxtb16", "sxtb16", "ssat16", "usat16",
    ];
    beginnings.iter().any(|beginning| name.starts_with(beginning))
}

/// Returns the image's instructions with their cycles.
pub fn of_image(model: Model, image: &Path) -> Result<Vec<(Instruction, Cycles)>> {
    let all = listing::of(image)?;
    let mut found = Vec::new();
    for (at, one) in all.iter().enumerate() {
        let before = at.checked_sub(1).and_then(|at| all.get(at));
        let before = before.filter(|before| before.next() == one.address);
        found.push((one.clone(), model.cycles(before, one)?));
    }
    Ok(found)
}

/// Formats the image's instructions with their cycles for the emulator's plugin.
fn table(model: Model, image: &Path) -> Result<String> {
    let mut text = String::new();
    for (one, Cycles { once: [least, most], taken }) in of_image(model, image)? {
        let (address, next) = (one.address, one.next());
        writeln!(text, "{address:x} {next:x} {least} {most} {} {}", taken[0], taken[1])?;
    }
    Ok(text)
}

/// Makes the emulator count cycles for the image, if there is a model of its core. The firmware reads them from a file
/// in the directory in which the emulator runs.
pub fn run_counting(board: &Board, image: &Path) -> Result<String> {
    let Some(model) = Model::of(board) else { return qemu::run_counting(board, image) };
    let place = image.with_extension("cycles");
    fs::create_dir_all(&place)?;
    fs::write(place.join("table"), table(model, image)?)?;
    let plugin = format!(
        "{},table={},cycles={}",
        plugin()?.display(),
        place.join("table").display(),
        place.join("cycles").display()
    );
    qemu::run_counting_with(board, image, &place, &plugin)
}

/// Compiles the plugin for the installed emulator.
fn plugin() -> Result<PathBuf> {
    static ONE: Mutex<()> = Mutex::new(());
    let _one = ONE.lock();
    let (source, plugin) =
        (paths::root().join("xtask/src/figures/bench/cycles.c"), paths::target().join("cycles.so"));
    let changed = |path: &Path| fs::metadata(path).and_then(|of| of.modified()).ok();
    if changed(&plugin).is_some_and(|made| Some(made) > changed(&source)) {
        return Ok(plugin);
    }
    let version = shell::output(shell::command("qemu-system-arm").arg("--version"))?;
    let major = version.split_whitespace().nth(3).and_then(|version| version.split('.').next());
    let Some(Ok(major)) = major.map(str::parse::<u32>) else { bail!("which QEMU? {version}") };
    // From 9.0 on nothing older than the second version of the interface is taken.
    let interface = if major < 9 { 1 } else { 2 };
    let mut compiler = shell::command("cc");
    compiler.args(["-shared", "-fPIC", "-O2", "-Wall", "-Wextra", "-Werror"]);
    compiler.arg(format!("-DVERSION={interface}")).arg("-o").args([&plugin, &source]);
    shell::run(&mut compiler)?;
    Ok(plugin)
}

#[cfg(test)]
mod tests {
    use super::{listing::instructions, *};

    /// Returns the cycles of the lines of a disassembly.
    fn costs(model: Model, lines: &[&str]) -> Vec<Cycles> {
        let listing: String = lines
            .iter()
            .enumerate()
            .map(|(at, line)| format!(" {:x}:\tbf00\t{line}\n", 2 * at))
            .collect();
        let all = instructions(&listing);
        assert_eq!(all.len(), lines.len());
        (0..all.len())
            .map(|at| {
                let before = at.checked_sub(1).and_then(|at| all.get(at));
                model.cycles(before, &all[at]).unwrap()
            })
            .collect()
    }

    fn sum(model: Model, lines: &[&str]) -> [u32; 2] {
        let all = costs(model, lines);
        [0, 1].map(|at| all.iter().map(|one| one.once[at]).sum())
    }

    /// The expected counts are the examples of ARM DDI 0337I, section 3.3.3, with its lower bounds.
    #[test]
    fn loads_pair_as_the_manual_says() {
        let least = |lines: &[&str]| sum(Model::M3, lines)[0];
        assert_eq!(least(&["ldr\tr0, [r1, #0]", "ldr\tr1, [r2, #0]"]), 3);
        assert_eq!(least(&["ldr\tr0, [r1, r2]", "str\tr0, [r3, #20]"]), 3);
        assert_eq!(least(&["ldr\tr0, [r1, r5]", "ldr\tr1, [r2, #0]", "ldr\tr2, [r3, #4]"]), 4);
        assert_eq!(
            least(&["ldr\tr0, [r1, #0]", "ldr\tr1, [r0, #0]"]),
            4,
            "an address that is loaded"
        );
        assert_eq!(
            least(&["str\tr0, [r1, #0]", "ldr\tr1, [r2, #0]"]),
            3,
            "nothing pairs after a store"
        );
    }

    #[test]
    fn an_address_waits_for_its_register() {
        assert_eq!(sum(Model::M4, &["adds\tr1, #4", "ldr\tr0, [r1, #0]"]), [3, 4]);
        assert_eq!(sum(Model::M4, &["adds\tr2, #4", "ldr\tr0, [r1, #0]"]), [3, 3]);
    }

    #[test]
    fn a_result_of_the_unit_for_floats_is_late_for_the_next_instruction() {
        assert_eq!(sum(Model::M4, &["vadd.f32\ts0, s1, s2", "vmul.f32\ts3, s0, s0"]), [2, 3]);
        assert_eq!(sum(Model::M4, &["vadd.f32\ts0, s1, s2", "vmul.f32\ts3, s1, s10"]), [2, 2]);
        assert_eq!(sum(Model::M4, &["vdiv.f32\ts0, s1, s2"]), [1, 14]);
    }

    #[test]
    fn branches_take_more_if_they_are_taken() {
        let branch = |model| costs(model, &["bne.n\t8 <a>"])[0];
        assert_eq!(branch(Model::M0), Cycles { once: [1, 1], taken: [1, 2] });
        assert_eq!(branch(Model::M4), Cycles { once: [1, 1], taken: [1, 3] });
        assert_eq!(costs(Model::M4, &["cbz\tr0, 8 <a>"])[0].taken, [1, 3]);
        assert_eq!(sum(Model::M0, &["bl\t8 <a>"]), [3, 4]);
        assert_eq!(sum(Model::M0, &["bls.n\t8 <a>"]), [1, 1]);
    }

    #[test]
    fn a_cortex_m0_takes_what_its_table_says() {
        assert_eq!(sum(Model::M0, &["push\t{r4, r5, lr}"]), [4, 4]);
        assert_eq!(sum(Model::M0, &["pop\t{r4, r5}"]), [3, 3]);
        assert_eq!(sum(Model::M0, &["pop\t{r4-r7, pc}"]), [8, 9]);
        assert_eq!(sum(Model::M0, &["ldrb\tr0, [r1, #0]", "strh\tr0, [r1, #0]"]), [4, 4]);
        assert_eq!(sum(Model::M0, &["muls\tr0, r1", "mov\tpc, r0"]), [3, 4]);
    }

    #[test]
    fn what_a_condition_skips_takes_one_at_least() {
        let lines = ["ite\tne", "ldrne.w\tr0, [r1, #0]", "moveq\tr0, #0", "it\teq", "bxeq\tlr"];
        let all = costs(Model::M4, &lines);
        assert_eq!(all[1].once, [1, 2]);
        assert_eq!(all[2].once, [1, 1]);
        assert_eq!(all[4], Cycles { once: [1, 1], taken: [1, 3] });
    }

    #[test]
    fn what_no_table_has_is_an_error() {
        let one = instructions(" 0:\tbf00\tvfrobnicate\tr0\n");
        assert!(Model::M4.cycles(None, &one[0]).is_err());
    }
}
