//! Edits of a text that may be nested.

use std::ops::Range;

/// Replaces a range of the text by pieces, some of which are ranges within it.
pub struct Edit {
    pub range: Range<usize>,
    pub pieces: Vec<Piece>,
}

pub enum Piece {
    New(String),
    Old(Range<usize>),
}

/// Applies all edits to the text. Two edits must be disjoint, or one must lie within an old piece of the other. Edits
/// of an empty range insert, and belong to the widest edit that ends or begins there.
pub fn edited(text: &str, edits: &mut [Edit]) -> String {
    // The outer one first; of insertions and edits that begin at one place, the insertions.
    edits.sort_by_key(|edit| {
        let length = edit.range.len();
        (edit.range.start, if length == 0 { 0 } else { usize::MAX - length })
    });
    let mut out = String::new();
    render(text, edits, 0..text.len(), &mut out);
    out
}

fn render(text: &str, edits: &[Edit], range: Range<usize>, out: &mut String) {
    let mut at = range.start;
    let first = edits.partition_point(|edit| edit.range.start < range.start);
    for (index, edit) in edits.iter().enumerate().skip(first) {
        let Range { start, end } = edit.range;
        if start >= range.end {
            break;
        }
        if start < at {
            continue; // within the edit before
        }
        out.push_str(&text[at..start]);
        for piece in &edit.pieces {
            match piece {
                Piece::New(new) => out.push_str(new),
                Piece::Old(old) => render(text, &edits[index + 1..], old.clone(), out),
            }
        }
        at = end;
    }
    out.push_str(&text[at..range.end]);
}
