//! Helpers of the tests: run the program `spikewire`, parse its output, and write and find input files.
#![allow(dead_code, unreachable_pub, unused_imports, unused_macros)]

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Exit status, standard output and standard error of a run whose output is text.
pub struct Ran {
    pub status: i32,
    pub output: String,
    pub stderr: String,
}

impl Ran {
    /// Parses standard output as JSON.
    pub fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.output).unwrap()
    }

    /// Returns the entry of the only log in a report of `--json`.
    pub fn log(&self) -> serde_json::Value {
        let mut report = self.json();
        assert_eq!(report["logs"].as_array().unwrap().len(), 1, "{report:#}");
        report["logs"][0].take()
    }

    /// Returns what a report of `score --json` has of each scheme on the only log.
    pub fn schemes(&self) -> Vec<serde_json::Value> {
        self.log()["schemes"].as_array().unwrap().clone()
    }
}

/// Runs `spikewire` without input, and returns its output as [`Ran`]. The macro's arguments are those of `format!`; the
/// text that they give is the command line after `spikewire`. The test fails if the exit status is not 0.
macro_rules! ran {
    ($($words:tt)*) => { $crate::common::good(&format!($($words)*), "") };
}
pub(crate) use ran;

/// Runs `spikewire` with arguments separated by blanks, and with `input` on standard input.
pub fn spikewire(arguments: &str, input: &str) -> Ran {
    let RanBytes { status, output, stderr } = spikewire_bytes(arguments, input.as_bytes());
    Ran { status, output: String::from_utf8(output).unwrap(), stderr }
}

/// Exit status, standard output and standard error of a run whose output may be binary.
pub struct RanBytes {
    pub status: i32,
    pub output: Vec<u8>,
    pub stderr: String,
}

/// Runs `spikewire` with arguments separated by blanks, and with the bytes of `input` on standard input.
pub fn spikewire_bytes(arguments: &str, input: &[u8]) -> RanBytes {
    use std::io::Write;
    let mut child = Command::new(env!("CARGO_BIN_EXE_spikewire"))
        .args(arguments.split_whitespace())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let done = std::thread::scope(|scope| {
        // In a thread: the program may end without reading, or fill its output before it has read.
        scope.spawn(move || {
            let _ = stdin.write_all(input);
        });
        child.wait_with_output().unwrap()
    });
    let stderr = String::from_utf8(done.stderr).unwrap();
    // No name in a message controls the terminal or turns a line around.
    let controls = |letter: char| letter != '\n' && letter.is_control() || letter == '\u{202e}';
    assert!(!stderr.contains(controls), "spikewire {arguments}: {stderr:?}");
    RanBytes { status: done.status.code().unwrap(), output: done.stdout, stderr }
}

/// Runs `spikewire` with bytes as input and output. The test fails if the exit status is not 0.
pub fn good_bytes(arguments: &str, input: &[u8]) -> RanBytes {
    let ran = spikewire_bytes(arguments, input);
    assert_eq!(ran.status, 0, "spikewire {arguments}: {}", ran.stderr);
    ran
}

/// Runs `spikewire` with text as input and output. The test fails if the exit status is not 0.
pub fn good(arguments: &str, input: &str) -> Ran {
    let ran = spikewire(arguments, input);
    assert_eq!(ran.status, 0, "spikewire {arguments}: {}", ran.stderr);
    ran
}

/// Runs `spikewire`. The test fails unless the exit status is 2 and standard error contains each of `words`.
pub fn refused(arguments: &str, input: &str, words: &[&str]) {
    let ran = spikewire_bytes(arguments, input.as_bytes());
    assert_eq!(ran.status, 2, "spikewire {arguments}: {}", ran.stderr);
    for word in words {
        assert!(
            ran.stderr.contains(word),
            "spikewire {arguments}: `{word}` is not in: {}",
            ran.stderr
        );
    }
}

/// Runs the program; returns the largest amount of memory that it used, in MB. Kills the program once `is_due` returns
/// true; otherwise the test fails unless the exit status is 0. Reads the memory from Linux's `/proc`.
pub fn most_memory(arguments: &str, is_due: impl Fn() -> bool) -> f64 {
    let mut child = Command::new(env!("CARGO_BIN_EXE_spikewire"))
        .args(arguments.split_whitespace())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut most = 0.0_f64;
    while child.try_wait().unwrap().is_none() {
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id()));
        let status = status.unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kilobytes = line.and_then(|own| own.trim().trim_end_matches(" kB").parse::<f64>().ok());
        most = most.max(kilobytes.unwrap_or_default() / 1000.0);
        if is_due() {
            child.kill().unwrap();
            child.wait().unwrap();
            return most;
        }
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    assert!(child.wait().unwrap().success(), "spikewire {arguments}");
    most
}

/// Returns a CSV table with one column, `x`.
pub fn table(values: &[f64]) -> String {
    let lines = values.iter().map(|value| format!("{value}\n"));
    "x\n".to_owned() + &lines.collect::<String>()
}

/// Parses the events in the text of a file of spikes, as (index, address, polarity).
pub fn events(spikes: &str) -> Vec<(usize, usize, i32)> {
    let lines = spikes.lines().filter(|line| !line.starts_with('#')).skip(1);
    lines
        .map(|line| {
            let fields: Vec<i32> =
                line.split(',').take(3).map(|field| field.parse().unwrap()).collect();
            (fields[0] as usize, fields[1] as usize, fields[2])
        })
        .collect()
}

/// Parses a file of spikes with one neuron. Returns a number for each sample: 1 or -1 for a spike, 0 for no spike.
pub fn train(spikes: &str) -> Vec<i32> {
    let samples = spikes.lines().find_map(|line| line.strip_prefix("# samples=")).unwrap();
    let mut train = vec![0; samples.parse().unwrap()];
    for (index, _, polarity) in events(spikes) {
        train[index] = polarity;
    }
    train
}

/// Parses the column of values that `decode` wrote for one channel.
pub fn values(decoded: &str) -> Vec<f64> {
    decoded.lines().skip(1).map(|line| line.split(',').nth(1).unwrap().parse().unwrap()).collect()
}

/// Writes a file into a new temporary directory; returns the directory, which is deleted when dropped, and the file's
/// path.
pub fn file(name: &str, content: impl AsRef<[u8]>) -> (tempfile::TempDir, String) {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join(name);
    std::fs::write(&path, content).unwrap();
    (directory, path.display().to_string())
}

/// Returns the path of a flight recording in the repository's directory `data`.
pub fn flight(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data").join(name).display().to_string()
}

/// Returns the paths of two PX4 logs, which come with the crates `ulog-rs` and `yule_log`.
pub fn flight_logs() -> [PathBuf; 2] {
    let metadata = cargo_metadata::MetadataCommand::new()
        .manifest_path(Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml"))
        // Dependencies of other platforms may not have been downloaded.
        .other_options(["--offline", "--filter-platform", "host-tuple"].map(str::to_owned))
        .exec()
        .unwrap();
    let file = |package: &str, file: &str| {
        let package = metadata.packages.iter().find(|found| found.name == package).unwrap();
        package.manifest_path.parent().unwrap().join(file).into_std_path_buf()
    };
    [file("ulog-rs", "test_data/sample-small.ulg"), file("yule_log", "data/sample_log_small.ulg")]
}
