#!/usr/bin/env python3
"""The toolbox's node, by its name."""

from spikewire_ros.ros1 import main
from spikewire_ros.toolbox import GenerateSpikes

main(GenerateSpikes)
