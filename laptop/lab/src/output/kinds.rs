//! Reasons for which a file cannot be written.

use crate::error::room;
use catalogue::kinds;

kinds! {
    /// The reason for which a file or a picture cannot be written.
    pub enum OutputKind by spell of subject {
        Ending { ending: String, others: String } => (
            "no file .{ending} is written here; there are .csv, .txt and names without an ending, as tables{others}"
        ),
        IsInput => ("the input itself; it would be lost"),
        NoFiles => ("a browser writes no files"),
        NothingThere => ("nothing stands there yet"),
        StartIsLast => ("its start is written last, so it goes to a file only"),
        Unwritten { error: std::io::Error } => ("cannot be written: {error}"),
        PictureEnding => ("a picture ends in .svg or .png"),
        NoFont => ("the font does not load"),
        NoSize => ("the picture has no size"),
        NotDrawn { why: String } => ("the picture cannot be drawn: {why}"),
    }
}
room!(OutputKind, Output);
