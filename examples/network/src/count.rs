//! Counts the instructions of a step of four networks: A, 12 inputs, 100 LIF and 4 LI; B, 6 values, 150 `CubaLIF`, 150
//! recurrent ones and 2 sums; C, 8 values, 130 recurrent `CubaLIF` and 3 sums; D, 16 inputs, 256 recurrent `CubaLIF` and 4
//! LI; with `PLAIN_C` in the environment of the build D also in C. In every step another share of the inputs and neurons
//! fires, chosen at random.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(plain_c)]
mod plain;
mod sizes;
mod weights;

use core::fmt;

fn run(out: &mut impl fmt::Write) -> fmt::Result {
    writeln!(
        out,
        "network,numbers,percent firing,instructions mean,instructions most,bytes of state"
    )?;
    sizes::integer::a(out)?;
    sizes::integer::d(out)?;
    #[cfg(plain_c)]
    plain::integer(out)?;
    // A core without FPU has no use for these, and the weights of D leave no room in 256 KiB.
    if cfg!(any(not(target_os = "none"), target_abi = "eabihf")) {
        sizes::float::a(out)?;
        sizes::float::b(out)?;
        sizes::float::c(out)?;
        sizes::float::d(out)?;
        #[cfg(plain_c)]
        plain::float(out)?;
    }
    Ok(())
}

#[cfg_attr(target_os = "none", board::entry)]
fn main() -> ! {
    let result = run(&mut board::console());
    board::finish(result)
}
