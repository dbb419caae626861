//! Writes one small generated log of each format into the directory given as the argument, for the check of the web
//! page.

use flight_logs::made as logs;
use std::{env, fs, io, path::Path};

fn main() -> io::Result<()> {
    let directory = env::args().nth(1).ok_or(io::ErrorKind::InvalidInput)?;
    let write = |name: &str, bytes: Vec<u8>| fs::write(Path::new(&directory).join(name), bytes);
    for kind in logs::KINDS {
        write(kind.name(), kind.log(kind.packings().last().unwrap_or(&"none")))?;
    }
    write("log.bin", logs::dataflash())?;
    write("log.log", logs::dataflash_text().into_bytes())?;
    write("log.tlog", logs::tlog())?;
    write("log.bbl", logs::blackbox())
}
