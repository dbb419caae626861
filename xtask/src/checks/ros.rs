//! `cargo verify ros`: tests the nodes with the distribution's ROS 1.

use crate::common::{command, output, paths, run};
use crate::figures::drawing;
use crate::programs::{host, python};
use crate::setup;
use anyhow::{Context, Result, ensure};
use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

/// Packages of ROS 1: what builds its packages, and what the nodes and their tests import.
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
/// Path with the distribution's programs only, as its Python has its ROS.
const PATH: &str = "/usr/bin:/bin";

/// Picture for docs: the figure of the paper's ROS package, with the inputs from a bag of the node.
const FIGURE: &str = "docs/ros.svg";

/// Tests a flight through every scheme, faults, the toolbox's bags and launch files, and the figure.
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

/// Links a package into a workspace.
fn link(package: &Path, source: &Path) -> Result<()> {
    fs::create_dir_all(source)?;
    output(command("ln").args(["-s", "-f", "-n"]).arg(package).arg(source)).map(drop)
}

/// Draws the figure into docs.
pub fn write() -> Result<()> {
    drawing::keep(&Ros::ready()?.figure()?, FIGURE)
}

/// The package `spikewire` and the catkin packages, built and installed below `target`.
struct Ros {
    /// Directory of all generated files.
    top: PathBuf,
    /// Directory from which Python imports `spikewire`.
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
        catkin.arg("--source").arg(ros.linked()?);
        for space in ["build", "devel", "install-space"] {
            catkin.arg(format!("--{space}")).arg(ros.top.join(space));
        }
        // Quiet: what it says fills pages. It leaves a mark where it is started.
        output(catkin.arg("--install").current_dir(&ros.top).env("PATH", PATH))?;
        Ok(ros)
    }

    /// Makes a source space with links to the packages, as the README does. What is built here is hidden from a colcon
    /// that finds the repository in its workspace.
    fn linked(&self) -> Result<PathBuf> {
        let source = self.room("src")?;
        fs::write(self.top.join("COLCON_IGNORE"), "")?;
        for package in ["spikewire_ros", "spyke_coding", "spyke_msgs"] {
            link(&paths::root().join("bindings/ros/ros1").join(package), &source)?;
        }
        Ok(source)
    }

    /// Makes a directory for the files of a test.
    fn room(&self, name: &str) -> Result<PathBuf> {
        let room = self.top.join(name);
        fs::create_dir_all(&room)?;
        Ok(room)
    }

    /// Returns a test, to be run with the nodes as installed by catkin.
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

    /// Returns the table of the values in the figure's bag.
    fn table(&self) -> Result<PathBuf> {
        Ok(self.room("figure")?.join("figure.csv"))
    }
}

/// Fails if lines of `index,value,time_us` have other values than the bag's table, compared as 32-bit numbers.
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

pub fn tests() -> PathBuf {
    paths::root().join("bindings/ros/tests")
}

pub fn sources() -> PathBuf {
    paths::root().join("bindings/ros/ros1/spikewire_ros/src")
}
