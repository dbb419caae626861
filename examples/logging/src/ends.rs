//! What the crate's types look like in a log: defmt sends numbers for texts, and the host puts the texts back.
//!
//! On the board this logs, over semihosting; on the host it decodes what the board said, with the texts from the
//! board's image.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
mod decode;
#[cfg(target_os = "none")]
mod send;

#[cfg(target_os = "none")]
#[board::entry]
fn main() -> ! {
    board::finish(send::run())
}

#[cfg(not(target_os = "none"))]
fn main() -> anyhow::Result<()> {
    decode::run()
}
