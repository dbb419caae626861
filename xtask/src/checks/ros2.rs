//! `cargo verify ros2`: builds a clone of the repository with colcon in a workspace of ROS 2, and tests its nodes with
//! two implementations of DDS.

use super::ros::{sources, tests};
use crate::common::{cargo, command, output, paths, run};
use crate::programs::{host, python};
use crate::setup;
use anyhow::{Result, bail};
use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

/// Packages of the distribution, for building messages and for a network namespace. ROS 2 itself comes as wheels.
const PACKAGES: [&str; 4] = ["cmake", "g++", "iproute2", "make"];

/// Tests the Rust nodes, builds their packages with colcon, and runs them with Eclipse Cyclone DDS and with ROS 2's own
/// rclpy.
///
/// All their traffic stays in a network namespace with only a loopback device.
pub fn ros2() -> Result<()> {
    setup::packages("what builds the packages, and a network of their own", &PACKAGES)?;
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
    run(&mut cargo("fmt --check --manifest-path bindings/ros/node/Cargo.toml"))?;
    let workspace = Workspace::ready(&top)?;
    workspace.build()?;
    workspace.ensure_copy_asks_for_a_clone()?;
    run(&mut workspace.test("ros2.py")?)?;
    run(&mut workspace.test("ros2_rclpy.py")?)
}

/// A workspace of ROS 2 with a clone of the repository in `src`.
struct Workspace {
    /// Directory beside cargo's output.
    place: PathBuf,
    /// Directory in which cargo builds what the tests share.
    built: PathBuf,
    /// The Python of the environment that stands for an installed ROS 2.
    python: PathBuf,
}

impl Workspace {
    fn ready(top: &Path) -> Result<Self> {
        let python = python::environment("ros2/installed")?;
        run(python::pip(&python).arg("--requirement").arg(tests().join("ros2.txt")))?;
        run(command(&python).arg(tests().join("relocate.py")))?;
        // A colcon that finds this repository in its workspace need not find the clone as well.
        fs::write(top.join("COLCON_IGNORE"), "")?;
        let workspace = Self { place: top.join("workspace"), built: top.into(), python };
        workspace.clone_repository()?;
        Ok(workspace)
    }

    /// Clones the repository as it is at the moment: with changes that are not committed, without files that git does
    /// not know yet.
    fn clone_repository(&self) -> Result<()> {
        let clone = self.place.join("src/spikewire");
        let git = |at: &Path| {
            let mut git = command("git");
            git.arg("-C").arg(at);
            git
        };
        if !clone.is_dir() {
            run(command("git").args(["clone", "--quiet"]).arg(paths::root()).arg(&clone))?;
        }
        let changed = output(git(&paths::root()).args(["stash", "create"]))?;
        let commit = if changed.is_empty() { "HEAD" } else { changed.trim() };
        run(git(&clone).args(["fetch", "--quiet"]).arg(paths::root()).arg(commit))?;
        run(git(&clone).args(["checkout", "--quiet", "--force", "FETCH_HEAD"]))
    }

    /// Prepares a program that finds ROS 2 as after reading its `setup.bash`, which wheels do not have.
    fn command(&self, program: &str) -> Result<Command> {
        let bin = self.python.parent().unwrap_or(Path::new(""));
        let prefix = bin.parent().unwrap_or(Path::new(""));
        let others = env::var_os("PATH").unwrap_or_default();
        let path = env::join_paths([bin.into()].into_iter().chain(env::split_paths(&others)))?;
        let mut command = command(program);
        command.current_dir(&self.place).env("PATH", path).env("VIRTUAL_ENV", prefix);
        command.env("AMENT_PREFIX_PATH", prefix).env("CMAKE_PREFIX_PATH", prefix);
        Ok(command)
    }

    /// Builds as the README says, in the tests' profile. A package that colcon should not find in a clone fails.
    fn build(&self) -> Result<()> {
        let found = output(self.command("colcon")?.args(["list", "--names-only"]))?;
        if found != "spikewire_msgs\nspikewire_ros\nspyke_msgs\n" {
            bail!("in a clone colcon finds\n{found}");
        }
        let mut colcon = self.command("colcon")?;
        colcon.args(["build", "--cmake-args", "-DCARGO_PROFILE=dev"]);
        run(colcon.arg(format!("-DBUILT={}", self.built.display())))
    }

    /// Checks a copy of the package outside a clone. It cannot know where the nodes' code is, must say so, and must
    /// accept a clone's path.
    fn ensure_copy_asks_for_a_clone(&self) -> Result<()> {
        let copy = self.place.join("copied");
        fs::create_dir_all(&copy)?;
        fs::write(copy.join("COLCON_IGNORE"), "")?;
        for file in ["CMakeLists.txt", "package.xml"] {
            let package = paths::root().join("bindings/ros/ros2/spikewire_ros");
            fs::copy(package.join(file), copy.join(file))?;
        }
        let configure = |clone: &Path| {
            let mut cmake = self.command("cmake")?;
            cmake.arg("-S").arg(&copy).arg("-B").arg(copy.join("build"));
            output(cmake.arg(format!("-DSPIKEWIRE={}", clone.display())))
        };
        let Err(refusal) = configure(&copy) else {
            bail!("a copy configures without the nodes' code")
        };
        if !refusal.to_string().contains("=/path/to/spikewire") {
            return Err(refusal);
        }
        configure(&paths::root())?;
        println!("A copy of the package asks for a clone, and takes one.");
        Ok(())
    }

    /// Returns a test, to be run in a shell that has read the workspace's `setup.bash`.
    fn test(&self, name: &str) -> Result<Command> {
        let room = self.place.join("room");
        fs::create_dir_all(&room)?;
        let installed = self.place.join("install");
        let mut test = self.command("unshare")?;
        test.args(["--map-root-user", "--net", "--pid", "--fork", "--kill-child", "bash", "-c"])
            .arg(r#". "$0/setup.bash" && PYTHONPATH="$MORE:$PYTHONPATH" exec "$@""#)
            .args([&installed, &self.python, &tests().join(name), &installed])
            .arg(paths::root().join("data/hexarotor.csv"))
            .args([&host::example("demo")?, &room])
            .arg(host::spikewire("")?.get_program())
            .env("MORE", sources())
            .env("PYTHONDONTWRITEBYTECODE", "1");
        Ok(test)
    }
}
