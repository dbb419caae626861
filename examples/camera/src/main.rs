//! The same program on every board and on the host; `board` makes the difference.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg_attr(target_os = "none", board::entry)]
fn main() -> ! {
    board::finish(camera_frames::run(&mut board::console()))
}
