# Adds the archive of the board's core to the link; PlatformIO runs this for each project that uses the library.
import os

Import("env")  # noqa: F821: SCons defines both

ARCHIVES = {
    "cortex-m0": "cortex-m0plus",
    "cortex-m0plus": "cortex-m0plus",
    "cortex-m3": "cortex-m3",
    "cortex-m4": "cortex-m4/fpv4-sp-d16-hard",
    "cortex-m7": "cortex-m7/fpv4-sp-d16-hard",
    "cortex-m33": "cortex-m33/fpv5-sp-d16-hard",
    "esp32c3": "esp32c3",
}

board = env.BoardConfig()  # noqa: F821
core = board.get("build.cpu", board.get("build.mcu", ""))
if core not in ARCHIVES:
    raise SystemExit("spikewire has no archive for %r, only for %s" % (core, ", ".join(sorted(ARCHIVES))))
DefaultEnvironment().Append(  # noqa: F821
    LIBPATH=[os.path.join(os.getcwd(), "src", ARCHIVES[core])], LIBS=["spikewire"]
)
