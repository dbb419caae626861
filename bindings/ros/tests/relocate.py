"""Points the CMake files of ROS 2's wheels to the Python that runs this: they name the one of the machine that built them."""

import re
import sys
import sysconfig
from pathlib import Path

PLACES = {
    r"/opt/python/cp\d+-cp\d+/include/python[\d.]+": sysconfig.get_path("include"),
    r"/opt/python/cp\d+-cp\d+/lib/python[\d.]+/site-packages": sysconfig.get_path("purelib"),
}

for file in Path(sys.prefix, "share").glob("*/cmake/*.cmake"):
    old = new = file.read_text()
    for place, own in PLACES.items():
        new = re.sub(place, own, new)
    if new != old:
        file.write_text(new)
