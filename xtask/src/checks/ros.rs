//! `cargo verify ros`: tests the nodes with the distribution's ROS 1. `cargo verify ros2`: tests those for ROS 2 with
//! another DDS.

use crate::common::{cargo, command, output, paths, run};
use crate::figures::drawing;
use crate::programs::{host, python};
use crate::setup;
use anyhow::{Context, Result, bail, ensure};
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
/// Packages for building a ROS 2 package, for `ros2 run` to find it, and for a network namespace.
const PACKAGES_2: [&str; 4] = ["ament-cmake", "cmake", "iproute2", "python3-ament-index"];
/// Option that selects the Python with ament's modules, even if another is first on the path.
const PYTHON: &str = "-DPython3_EXECUTABLE=/usr/bin/python3";
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

/// Tests the Rust nodes, builds their package with colcon, and runs them with Eclipse Cyclone DDS.
///
/// All their traffic stays in a network namespace with only a loopback device.
pub fn ros2() -> Result<()> {
    setup::packages("what builds the nodes' package, and a network of their own", &PACKAGES_2)?;
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
    let workspace = Workspace::ready(&top)?;
    workspace.ensure_clone_is_unambiguous()?;
    workspace.ensure_copy_asks_for_a_clone()?;
    workspace.build()?;

    let python = python::environment("ros2/cyclone")?;
    run(python::pip(&python).arg("--requirement").arg(tests().join("ros2.txt")))?;
    let room = top.join("room");
    fs::create_dir_all(&room)?;
    let mut test = command("unshare");
    test.args(["--map-root-user", "--net", "--pid", "--fork", "--kill-child"])
        .arg(python)
        .arg(tests().join("ros2.py"));
    test.arg(workspace.place.join("install"));
    test.arg(paths::root().join("data/hexarotor.csv")).arg(host::example("demo")?);
    run(test.arg(room).env("PYTHONPATH", sources()).env("PYTHONDONTWRITEBYTECODE", "1"))
}

/// A workspace of ROS 2 with the nodes' package, set up as the README says. It does not contain `spyke_msgs`, which
/// needs generators of messages that only a full ROS 2 has.
struct Workspace {
    /// Directory beside cargo's output.
    place: PathBuf,
    /// Directory in which cargo builds what the tests share.
    built: PathBuf,
    colcon: PathBuf,
}

impl Workspace {
    fn ready(top: &Path) -> Result<Self> {
        let python = python::environment("ros2/colcon")?;
        run(python::pip(&python).arg("--requirement").arg(tests().join("colcon.txt")))?;
        let place = top.join("workspace");
        link(&package_2(), &place.join("src"))?;
        let colcon = python.with_file_name("colcon");
        Ok(Self { place, built: top.into(), colcon })
    }

    fn colcon(&self, verb: &str) -> Command {
        let mut colcon = command(&self.colcon);
        colcon.current_dir(&self.place).arg(verb);
        colcon
    }

    /// Fails if colcon finds packages in a clone of the repository that are not of ROS 2, or finds one twice.
    fn ensure_clone_is_unambiguous(&self) -> Result<()> {
        let listed = output(self.colcon("list").arg("--base-paths").arg(paths::root()))?;
        let mut found: Vec<_> = listed.lines().filter_map(|line| line.split('\t').nth(1)).collect();
        found.sort_unstable();
        let of = |name: &str| paths::root().join("bindings/ros/ros2").join(name);
        let wanted = [of("spikewire_ros"), of("spyke_msgs")];
        ensure!(
            found.iter().map(Path::new).eq(wanted.iter().map(PathBuf::as_path)),
            "in a clone colcon finds\n{listed}"
        );
        println!("In a clone of the repository colcon finds the two packages of ROS 2, once each.");
        Ok(())
    }

    /// Checks a copy of the package outside a clone. It cannot know where the nodes' code is, must say so, and must
    /// accept a clone's path.
    fn ensure_copy_asks_for_a_clone(&self) -> Result<()> {
        let copy = self.place.join("copied");
        fs::create_dir_all(&copy)?;
        fs::write(copy.join("COLCON_IGNORE"), "")?;
        for file in ["CMakeLists.txt", "package.xml"] {
            fs::copy(package_2().join(file), copy.join(file))?;
        }
        let configure = |clone: &Path| {
            let mut cmake = command("cmake");
            cmake.arg("-S").arg(&copy).arg("-B").arg(copy.join("build"));
            cmake.args([PYTHON.into(), format!("-DSPIKEWIRE={}", clone.display())]);
            output(&mut cmake)
        };
        let Err(refusal) = configure(&copy) else {
            bail!("a copy configures without the nodes' code")
        };
        ensure!(refusal.to_string().contains("=/path/to/spikewire"), "a copy says: {refusal}");
        configure(paths::root().as_path())?;
        println!("A copy of the package asks for a clone, and takes one.");
        Ok(())
    }

    /// Builds as the README says, in the tests' profile.
    fn build(&self) -> Result<()> {
        let mut colcon = self.colcon("build");
        colcon.args(["--cmake-args", "-DCARGO_PROFILE=dev", PYTHON]);
        output(colcon.arg(format!("-DBUILT={}", self.built.display()))).map(drop)
    }
}

/// Links a package into a workspace.
fn link(package: &Path, source: &Path) -> Result<()> {
    fs::create_dir_all(source)?;
    output(command("ln").args(["-s", "-f", "-n"]).arg(package).arg(source)).map(drop)
}

fn package_2() -> PathBuf {
    paths::root().join("bindings/ros/ros2/spikewire_ros")
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

fn tests() -> PathBuf {
    paths::root().join("bindings/ros/tests")
}

fn sources() -> PathBuf {
    paths::root().join("bindings/ros/ros1/spikewire_ros/src")
}
