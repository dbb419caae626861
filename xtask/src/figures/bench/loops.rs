//! Small loops whose cycles were calculated by hand from the manuals' tables, compared with what is counted.

use super::cycles::{self, Model};
use crate::programs::{boards::Board, image};
use anyhow::{Context, Result, ensure};

const PROGRAM: &str = "loops";

/// A piece of `bench-target`'s assembly, without its return: its instructions; its cycles on a Cortex-M0+ and on a
/// Cortex-M0; and bounds for a Cortex-M3 and a Cortex-M4F.
struct Piece {
    name: &'static str,
    instructions: u32,
    /// Cycles; `None` if the core does not have these instructions.
    small: Option<[u32; 2]>,
    large: [u32; 2],
}

const fn piece(name: &'static str, instructions: u32, small: [u32; 2], large: [u32; 2]) -> Piece {
    Piece { name, instructions, small: Some(small), large }
}

const fn large(name: &'static str, instructions: u32, large: [u32; 2]) -> Piece {
    Piece { name, instructions, small: None, large }
}

/// Calculations in the order of the source: before the loop, in the loop, and its branches, of which the last is not
/// taken.
const PIECES: [Piece; 10] = [
    piece(
        "count-down",
        1 + 10 * 2,
        [1 + 10 + (9 * 2 + 1), 1 + 10 + (9 * 3 + 1)],
        [1 + 10 + (9 * 2 + 1), 1 + 10 + (9 * 4 + 1)],
    ),
    // A load and a store, three additions, and the branch.
    piece(
        "copy",
        5 + 8 * 6 + 1,
        [5 + 8 * (2 + 2 + 3) + (7 * 2 + 1) + 1, 5 + 8 * (2 + 2 + 3) + (7 * 3 + 1) + 1],
        [5 + 8 * (2 + 1 + 3) + (7 * 2 + 1) + 1, 5 + 8 * (2 + 2 + 3) + (7 * 4 + 1) + 1],
    ),
    // Call, return, one subtraction, and the branch.
    piece(
        "call",
        2 + 5 * 4,
        [2 + 5 * (3 + 2 + 1) + (4 * 2 + 1), 2 + 5 * (4 + 3 + 1) + (4 * 3 + 1)],
        [2 + 5 * (2 + 2 + 1) + (4 * 2 + 1), 2 + 5 * (4 + 4 + 1) + (4 * 4 + 1)],
    ),
    // Four registers away, and four back with a branch.
    piece(
        "save",
        4,
        [1 + 3 + (1 + 4) + (3 + 4), 1 + 4 + (1 + 4) + (4 + 4)],
        [1 + 2 + (1 + 4) + (1 + 4 + 1), 1 + 4 + (1 + 4) + (1 + 4 + 3)],
    ),
    // The address may wait for its register.
    piece("multiple", 2, [1 + (1 + 3), 1 + (1 + 3)], [1 + (1 + 3), 1 + (1 + 3) + 1]),
    large("divide", 3, [1 + 1 + 2, 1 + 1 + 12]),
    // `ite` may be folded into what is before it.
    large("block", 5, [1 + 1 + 1 + 1, 1 + 1 + 1 + 1 + 1]),
    large("pairs", 4, [1 + 2 + 1 + 1, 1 + (2 + 1) + 2 + 2]),
    // A word at an odd byte takes two cycles more.
    large("unaligned", 2, [1 + 2 + 2, 1 + (2 + 1) + 2]),
    // What makes a float takes a cycle more if the next instruction has it as an operand.
    large("floats", 6, [6, 1 + 1 + (1 + 1) + (14 + 1) + (14 + 1) + (1 + 1)]),
];

/// Fails if a loop takes other cycles than calculated.
pub fn verify(board: &Board) -> Result<()> {
    let Some(model) = Model::of(board) else { return Ok(()) };
    let image = image::build_all("bench-target", &[PROGRAM], board)?.join(PROGRAM);
    let printed = cycles::run_counting(board, &image)?;
    let known = |piece: &&Piece| match model {
        Model::M0 => piece.small.is_some(),
        Model::M3 => piece.name != "floats",
        Model::M4 => true,
    };
    for Piece { name, instructions, small, large } in PIECES.iter().filter(known) {
        let [least, most] = if model == Model::M0 { small.unwrap_or_default() } else { *large };
        let expected = format!("{name} {instructions} {least} {most}");
        let line = printed.lines().find(|line| line.split(' ').next() == Some(name));
        let line = line.with_context(|| format!("`{name}` is not counted:\n{printed}"))?;
        ensure!(line == expected, "by hand `{expected}`, counted `{line}`");
    }
    let count = PIECES.iter().filter(known).count();
    println!("{}: {count} small loops take the cycles that were worked out by hand.", board.core);
    Ok(())
}
