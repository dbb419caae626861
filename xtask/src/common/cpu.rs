//! Processor time, which measures a check even if the machine is busy with other things.

/// Returns the seconds of processor time that this program and its finished children took.
#[cfg(unix)]
pub fn seconds() -> f64 {
    use nix::sys::{
        resource::{UsageWho, getrusage},
        time::TimeValLike,
    };
    let of = |who| {
        getrusage(who).map_or(0, |usage| {
            usage.user_time().num_microseconds() + usage.system_time().num_microseconds()
        })
    };
    (of(UsageWho::RUSAGE_SELF) + of(UsageWho::RUSAGE_CHILDREN)) as f64 / 1e6
}

/// Returns 0: processor time is not known on this system.
#[cfg(not(unix))]
pub fn seconds() -> f64 {
    0.0
}

#[cfg(all(test, unix))]
mod tests {
    use super::seconds;
    use std::process::Command;

    #[test]
    fn a_program_that_has_ended_is_counted() {
        let before = seconds();
        let script = "i=0; while [ $i -lt 200000 ]; do i=$((i + 1)); done";
        assert!(Command::new("sh").args(["-c", script]).status().unwrap().success());
        assert!(seconds() > before + 0.01);
    }
}
