//! What the checks need of a machine, and what of it is missing.

use crate::common::shell;
use crate::setup::{distribution, toolchain};
use anyhow::{Result, ensure};

/// A program that a package of the distribution contains.
pub struct Tool {
    pub package: &'static str,
    pub program: &'static str,
    pub why: &'static str,
}

pub const TOOLS: [Tool; 5] = [
    Tool { package: "qemu-system-arm", program: "qemu-system-arm", why: "emulates the boards" },
    Tool {
        package: "binutils-arm-none-eabi",
        program: "arm-none-eabi-nm",
        why: "reads the firmware's size and symbols",
    },
    Tool {
        package: "gcc-arm-none-eabi",
        program: "arm-none-eabi-gcc",
        why: "compiles the tests of the library for C, and C to compare counts with",
    },
    Tool {
        package: "qemu-system-misc",
        program: "qemu-system-riscv32",
        why: "emulates a RISC-V machine",
    },
    Tool { package: "g++", program: "g++", why: "compiles its header as C++" },
];

/// What a command needs of a machine.
pub struct Needs {
    pub targets: &'static [&'static str],
    pub tools: &'static [Tool],
}

impl Needs {
    /// Lists the programs in words.
    pub fn words(&self) -> String {
        let tools = self.tools.iter().map(|tool| tool.program);
        ["compiler for microcontrollers"].into_iter().chain(tools).collect::<Vec<_>>().join(", ")
    }
}

/// The needs of all checks together.
pub const CHECKS: Needs = Needs { targets: &toolchain::TARGETS, tools: &TOOLS };

/// The needs of the demo, which flies on one emulated board and compiles nothing in C.
pub const DEMO: Needs = Needs { targets: &["thumbv7em-none-eabihf"], tools: TOOLS.split_at(1).0 };

/// What is missing.
pub struct Missing {
    /// Targets for which neither compiler has a core library.
    pub targets: Vec<&'static str>,
    pub tools: Vec<&'static Tool>,
}

impl Missing {
    pub fn is_empty(&self) -> bool {
        self.targets.is_empty() && self.tools.is_empty()
    }

    /// Returns a line for each.
    pub fn lines(&self) -> Vec<String> {
        let targets = self.targets.iter().map(|target| format!("the core library for {target}"));
        let tools = self.tools.iter().map(|tool| format!("{}, which {}", tool.program, tool.why));
        targets.chain(tools).collect()
    }
}

pub fn missing(needs: &Needs) -> Result<Missing> {
    let mut targets = Vec::new();
    for &target in needs.targets {
        if !toolchain::has_core(target)? && !distribution::has_core(target)? {
            targets.push(target);
        }
    }
    let tools = needs.tools.iter().filter(|tool| !shell::has(tool.program)).collect();
    Ok(Missing { targets, tools })
}

/// Fails if something is missing; the error names the command that installs it.
pub fn ensure_met() -> Result<()> {
    let missing = missing(&CHECKS)?;
    ensure!(
        missing.is_empty(),
        "`cargo xtask setup` installs what is missing:\n  {}",
        missing.lines().join("\n  ")
    );
    Ok(())
}
