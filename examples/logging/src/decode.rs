//! The host: the log as text, from the board's image and what it said on standard input.

use anyhow::{Context, Result, ensure};
use defmt_decoder::{DecodeError, Table};
use std::{
    env, fs,
    io::{self, Read},
};

pub fn run() -> Result<()> {
    let image = env::args().nth(1).context("usage: logging IMAGE < what it said")?;
    let table = Table::parse(&fs::read(image)?)?.context("the image logs nothing")?;
    let mut said = Vec::new();
    io::stdin().read_to_end(&mut said)?;

    let mut decoder = table.new_stream_decoder();
    decoder.received(&said);
    loop {
        match decoder.decode() {
            Ok(frame) => println!("{}", frame.display(false)),
            Err(DecodeError::UnexpectedEof) => return Ok(()),
            // As where a board was reset in the midst of a line.
            Err(DecodeError::Malformed) if table.encoding().can_recover() => {}
            Err(DecodeError::Malformed) => ensure!(false, "what the board said is no log"),
        }
    }
}
