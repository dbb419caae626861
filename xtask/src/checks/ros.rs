//! `cargo verify ros`: the nodes in a ROS 1 of the distribution; `cargo verify ros2`: those of ROS 2 against another DDS.

use crate::common::{cargo, command, output, paths, run};
use crate::figures::drawing;
use crate::programs::{host, python};
use crate::setup;
use anyhow::{Context, Result, ensure};
use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

/// ROS 1, what builds its packages, and what its nodes and their tests import.
const PACKAGES: [&str; 11] = [
    "catkin",
    "g++",
    "make",
    "python3-diagnostic-msgs",
    "python3-numpy",
    "python3-rosbag",
    "python3-roslaunch",
    "python3-rospy",
    "python3-sensor-msgs",
    "python3-yaml",
    "ros-message-generation",
];
/// The programs of the distribution, and no others: its Python has its ROS.
const PATH: &str = "/usr/bin:/bin";

/// The paper's figure of its ROS package, of the inputs that a bag of the node has.
const FIGURE: &str = "docs/ros.svg";

/// A flight through every scheme, what goes wrong, the toolbox's bags and launch files, and the figure.
pub fn ros() -> Result<()> {
    let ros = Ros::ready()?;
    run(&mut ros.test("core.py"))?;
    let (demo, mut spikewire) = (host::example("demo")?, host::spikewire("")?);
    let mut flight = ros.test("flight.py");
    flight.arg(paths::root().join("data/hexarotor.csv")).arg(demo).arg(spikewire.get_program());
    run(flight.arg(ros.room("flight")?))?;
    run(ros.test("faults.py").arg(ros.room("faults")?))?;
    run(ros.test("toolbox.py").arg(spikewire.get_program()).arg(ros.room("toolbox")?))?;
    run(ros.test("old_launch.py").arg(ros.room("old_launch")?))?;
    drawing::ensure_kept(&ros.figure()?, FIGURE, "cargo xtask write ros")?;
    let bag = ros.room("figure")?.join("encoding.bag");
    ensure_decoded(&output(spikewire.arg("decode").arg(bag))?, &ros.table()?)
}

/// Tests the Rust nodes, installs them as colcon does, and runs them against Eclipse Cyclone DDS.
///
/// All that they send stays in a network namespace with nothing but loopback in it.
pub fn ros2() -> Result<()> {
    setup::packages("what installs the nodes, and a network of their own", &["cmake", "iproute2"])?;
    let top = paths::target().join("ros2");
    let manifest = "--locked --manifest-path bindings/ros/node/Cargo.toml --target-dir";
    for command in ["test", "clippy --all-targets"] {
        let mut cargo = cargo(&format!("{command} {manifest}"));
        cargo.arg(&top);
        if command != "test" {
            cargo.args(["--", "-D", "warnings"]);
        }
        run(&mut cargo)?;
    }
    run(cargo("fmt --check --manifest-path bindings/ros/node/Cargo.toml")
        .current_dir(paths::root()))?;
    let (build, prefix) = (top.join("build"), top.join("install"));
    let define = |name: &str, path: &Path| format!("-D{name}={}", path.display());
    let mut cmake = command("cmake");
    cmake.args(["-S", "bindings/ros/ros2/spikewire_ros", "-DCARGO_PROFILE=dev", "-B"]).arg(&build);
    output(cmake.args([define("BUILT", &top), define("CMAKE_INSTALL_PREFIX", &prefix)]))?;
    output(command("cmake").arg("--build").arg(&build))?;
    output(command("cmake").arg("--install").arg(&build))?;

    let python = python::environment("ros2/cyclone")?;
    run(python::pip(&python).arg("--requirement").arg(tests().join("ros2.txt")))?;
    let room = top.join("room");
    fs::create_dir_all(&room)?;
    let mut test = command("unshare");
    test.args(["--map-root-user", "--net", "--pid", "--fork", "--kill-child"])
        .arg(python)
        .arg(tests().join("ros2.py"));
    test.arg(prefix).arg(paths::root().join("data/hexarotor.csv")).arg(host::example("demo")?);
    run(test.arg(room).env("PYTHONPATH", sources()).env("PYTHONDONTWRITEBYTECODE", "1"))
}

/// Draws the figure into the page.
pub fn write() -> Result<()> {
    drawing::keep(&Ros::ready()?.figure()?, FIGURE)
}

/// The package `spikewire` and the catkin packages, built and installed below `target`.
struct Ros {
    /// All that is generated.
    top: PathBuf,
    /// Where Python finds `spikewire`.
    site: PathBuf,
}

impl Ros {
    fn ready() -> Result<Self> {
        setup::packages("ROS 1 and what builds its packages", &PACKAGES)?;
        let top = paths::target().join("ros");
        let ros = Self { site: top.join("site"), top };
        let mut pip = python::pip(&python::environment("ros/pip")?);
        pip.args(["--no-deps", "--upgrade", "--target"]).arg(&ros.site).arg("./bindings/python");
        // Compiled as the tests are, with which it shares its dependencies.
        run(pip.env("MATURIN_PEP517_ARGS", "--profile dev").env("CARGO_INCREMENTAL", "0"))?;
        let mut catkin = command("catkin_make_isolated");
        catkin.args(["--source".into(), paths::root().join("bindings/ros/ros1")]);
        for space in ["build", "devel", "install-space"] {
            catkin.arg(format!("--{space}")).arg(ros.top.join(space));
        }
        // Quiet: what it says fills pages. It leaves a mark where it is started.
        output(catkin.arg("--install").current_dir(&ros.top).env("PATH", PATH))?;
        Ok(ros)
    }

    /// A directory for what a test leaves behind.
    fn room(&self, name: &str) -> Result<PathBuf> {
        let room = self.top.join(name);
        fs::create_dir_all(&room)?;
        Ok(room)
    }

    /// A test with the nodes as catkin has installed them.
    fn test(&self, name: &str) -> Command {
        let mut test = command(self.top.join("install-space/env.sh"));
        test.arg("python3").arg(tests().join(name));
        test.env("PATH", PATH).env("PYTHONPATH", &self.site).env("PYTHONDONTWRITEBYTECODE", "1");
        test
    }

    /// Records the figure's bag and draws it.
    fn figure(&self) -> Result<PathBuf> {
        let room = self.room("figure")?;
        run(self.test("figure.py").arg(&room))?;
        let drawn = room.join("ros.svg");
        let plot = host::spikewire("plot --scheme sf --threshold 0.35 --column input -o");
        run(plot?.arg(&drawn).arg(self.table()?))?;
        Ok(drawn)
    }

    /// What the figure's bag holds.
    fn table(&self) -> Result<PathBuf> {
        Ok(self.room("figure")?.join("figure.csv"))
    }
}

/// Fails if these lines of `index,value,time_us` have other values than the table of the bag, as numbers of 32 bits.
fn ensure_decoded(lines: &str, table: &Path) -> Result<()> {
    let column = |text: &str, column: usize| {
        let values = text.lines().skip(1).map(|line| line.split(',').nth(column)?.parse().ok());
        values.collect::<Option<Vec<f32>>>().context("the decoded values are no table")
    };
    let wanted = column(&fs::read_to_string(table)?, 2)?;
    ensure!(
        column(lines, 1)? == wanted,
        "`spikewire decode` and the node decode the bag to other values"
    );
    println!("`spikewire decode` makes of the bag what the node decoded.");
    Ok(())
}

fn tests() -> PathBuf {
    paths::root().join("bindings/ros/tests")
}

fn sources() -> PathBuf {
    paths::root().join("bindings/ros/ros1/spikewire_ros/src")
}
