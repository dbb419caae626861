//! `cargo verify ros`: the nodes in a ROS 1 of the distribution, and those of ROS 2 as far as they run without one.

use crate::{
    host, paths, ros_figure, setup,
    shell::{command, output, run},
    usage::usage,
};
use anyhow::Result;
use std::{env, fs, path::PathBuf, process::Command};

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

/// A flight through every scheme, what goes wrong, the toolbox's bags, the figure, and the wire format of ROS 2.
pub fn ros() -> Result<()> {
    let ros = Ros::ready()?;
    run(&mut ros.test("core.py"))?;
    ros.ros2()?;
    let (demo, mut spikewire) = (host::example("demo")?, host::spikewire("")?);
    let mut flight = ros.test("flight.py");
    flight.arg(paths::root().join("data/hexarotor.csv")).arg(demo).arg(spikewire.get_program());
    run(flight.arg(ros.room("flight")?))?;
    run(ros.test("faults.py").arg(ros.room("faults")?))?;
    run(ros.test("toolbox.py").arg(spikewire.get_program()).arg(ros.room("toolbox")?))?;
    ros_figure::ensure_drawn(&ros.figure()?)?;
    let bag = ros.room("figure")?.join("encoding.bag");
    ros_figure::ensure_decoded(&output(spikewire.arg("decode").arg(bag))?, &ros.table()?)
}

/// `cargo xtask ros-figure`
pub fn figure(args: &[String]) -> Result<()> {
    let write = match args {
        [] => false,
        [one] if one == "--write" => true,
        _ => return Err(usage("cargo xtask ros-figure [--write]".into())),
    };
    let drawn = Ros::ready()?.figure()?;
    println!("The picture: {}", drawn.display());
    if write { ros_figure::keep(&drawn) } else { Ok(()) }
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
        let pip = ros.environment("pip")?;
        let install = "-m pip install --quiet --disable-pip-version-check --no-deps --upgrade";
        let mut pip = command(pip);
        pip.args(install.split(' ')).arg("--target").arg(&ros.site).arg("./python");
        // Compiled as the tests are, with which it shares its dependencies.
        run(pip.env("MATURIN_PEP517_ARGS", "--profile dev").env("CARGO_INCREMENTAL", "0"))?;
        let mut catkin = command("catkin_make_isolated");
        catkin.args(["--source".into(), paths::root().join("ros/ros1")]);
        for space in ["build", "devel", "install-space"] {
            catkin.arg(format!("--{space}")).arg(ros.top.join(space));
        }
        // Quiet: what it says fills pages. It leaves a mark where it is started.
        output(catkin.arg("--install").current_dir(&ros.top).env("PATH", PATH))?;
        Ok(ros)
    }

    /// The Python of an environment of its own.
    fn environment(&self, name: &str) -> Result<PathBuf> {
        let environment = self.top.join(name);
        let python = environment.join("bin/python");
        if !python.is_file() {
            run(command("python3").args(["-m", "venv"]).arg(&environment))?;
        }
        Ok(python)
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

    /// The nodes of ROS 2, with other people's readers of what they send.
    fn ros2(&self) -> Result<()> {
        let python = self.environment("ros2")?;
        let install = "-m pip install --quiet --disable-pip-version-check --requirement";
        run(command(&python).args(install.split(' ')).arg(tests().join("ros2.txt")))?;
        let path = env::join_paths([&self.site, &sources()])?;
        let mut test = command(&python);
        test.arg(tests().join("ros2.py"));
        run(test.env("PYTHONPATH", path).env("PYTHONDONTWRITEBYTECODE", "1"))
    }

    /// Records the figure's bag and draws it.
    fn figure(&self) -> Result<PathBuf> {
        let room = self.room("figure")?;
        run(self.test("figure.py").arg(&room))?;
        let drawn = room.join("ros.svg");
        ros_figure::draw(&self.table()?, &drawn)?;
        Ok(drawn)
    }

    /// What the figure's bag holds.
    fn table(&self) -> Result<PathBuf> {
        Ok(self.room("figure")?.join("figure.csv"))
    }
}

fn tests() -> PathBuf {
    paths::root().join("ros/tests")
}

fn sources() -> PathBuf {
    paths::root().join("ros/ros1/spikewire_ros/src")
}
