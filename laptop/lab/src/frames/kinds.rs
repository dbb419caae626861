//! Reasons for which a video cannot be read or written.

use crate::error::room;
use catalogue::kinds;
use spikewire_cameras::format::FormatError;

kinds! {
    /// The reason for which a video, its events or its preview cannot be read or written.
    pub enum FramesKind by spell of subject {
        NoFfmpeg { program: String } => (
            "neither YUV4MPEG2 nor a picture, and {program} is not there to read it; install it, or name it in FFMPEG, \
             or convert the video elsewhere: `ffmpeg -i VIDEO -pix_fmt gray video.y4m`"
        ),
        NotStarted { program: String, error: std::io::Error } => ("{program} cannot be started: {error}"),
        NoOutput => ("no output of ffmpeg"),
        Ffmpeg { said: String } => ("ffmpeg says: {said}"),
        FfmpegEnded { status: std::process::ExitStatus, said: String } => ("ffmpeg says, {status}: {said}"),
        NoPicture { error: image::ImageError } => ("cannot be read as a picture: {error}"),
        NoPictures => ("no pictures in this directory (.png, .jpg, .pgm, .ppm)"),
        DeepPixels => ("pixels of more than the 8 bits that are taken"),
        DeepVideo { bits: usize } => ("pixels of {bits} bits, where 8 are taken"),
        Size { width: u32, height: u32 } =>
            ("{width} x {height} pixels, where 1 to 65535 columns and rows are taken"),
        OtherSize { frame: usize, width: u32, height: u32, first: String, of_first: (u16, u16) } => (
            "frame {frame} has {width} x {height} pixels, where {first} has {} x {}",
            of_first.0,
            of_first.1
        ),
        Length { digits: String, field: &'static str } =>
            ("`{digits}` {field} of pixels, where 1 to 65535 are taken"),
        PixelFormat =>
            ("unknown pixel format in the header; 4:2:0, 4:2:2, 4:4:4 and mono of 8 bits are read"),
        CutHeader { byte: u64 } => ("cut short at byte {byte}, within the header"),
        NoHeader { error: y4m::Error } => ("no header of YUV4MPEG2: {error}"),
        Cut { byte: u64 } => ("cut short at byte {byte}"),
        NoFrame { byte: u64, error: y4m::Error } => ("byte {byte}: {error}"),
        Rate { text: String } => ("{text} frames a second: must be a number above 0, or two such as 30000/1001"),
        LargeGif { columns: usize, rows: usize } => ("{columns} x {rows} pixels are too many for a GIF"),
        PreviewEnding => ("a preview is a .png, or animated a .gif"),
        LargeEvt2 { width: u16, height: u16 } => ("EVT2 holds up to 2048 columns and rows, not {width} x {height}"),
        EventsEnding => (
            "events go into .es (Event Stream), .raw (EVT2) or .csv; `spikewire convert` makes EVT3 of these, other programs \
             AEDAT4"
        ),
        NoWord { error: FormatError } => ("{error}"),
    }
}
room!(FramesKind, Frames);
