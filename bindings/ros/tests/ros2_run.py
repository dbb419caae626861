"""`ros2 run` where no ROS 2 is installed.

    ros2_run.py PACKAGE PROGRAM ARGUMENT...

`ros2cli` beside this file has the code of ros2run and ros2pkg 0.36.1 that finds and starts a program, unchanged. Only the
class that the command derives from is missing: it belongs to the command line's plug-ins. `ament_index_python`, which
reads `AMENT_PREFIX_PATH`, is the distribution's.
"""

import argparse
import sys
import types
from pathlib import Path

plugins = types.ModuleType("ros2cli.command")
plugins.CommandExtension = object
sys.modules |= {"ros2cli": types.ModuleType("ros2cli"), "ros2cli.command": plugins}
sys.path.insert(0, str(Path(__file__).parent / "ros2cli"))

from ros2run.command.run import RunCommand  # noqa: E402: it imports what is set above


def main() -> None:
    command, parser = RunCommand(), argparse.ArgumentParser()
    command.add_arguments(parser, "ros2 run")
    try:
        sys.exit(command.main(parser=parser, args=parser.parse_args()))
    except RuntimeError as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
