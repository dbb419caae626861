"""The settings that the firmware flies with, as keywords: this package's checks and those of ROS ask here."""


def settings(part, low, high):
    """The scheme of each line that the firmware prints, by its short name, and its keywords.

    `part` makes a setting of a part of the channel's range, which goes from `low` to `high`. Missing are those that are told
    otherwise: the threshold of `tbr` and the first values of `mw`'s window follow from the samples.
    """
    ends, shift = {"min": low, "max": high}, {"shift": low}
    peak = {"filter": f"triang:15,peak={part(0.1)!r}", **shift}
    hann = lambda of: {"filter": f"hann:24,sum={part(of)!r}", **shift}
    toolbox = {"form": "toolbox", "threshold": 1.15, "filter": f"triang:9,peak={part(0.2)!r}", **shift}
    companded = {"companding": 5, **ends}
    fires = {"threshold": part(0.2), "power": 3, "spikes": 8}
    return {
        "tbr": ("tbr", {}),
        "atbr": ("atbr", {"threshold": part(0.001), "doublings": 5}),
        "mw": ("mw", {"threshold": part(0.02), "window": 5}),
        "sf": ("sf", {"threshold": part(0.02)}),
        "sod": ("sod", {"threshold": part(0.02), "spikes": 4}),
        "asf": ("asf", {"threshold": part(0.02), "doublings": 4}),
        "bsa": ("bsa", {"threshold": part(0.955), **hann(1.0)}),
        "bsa-mul": ("bsa", {"criterion": "mul", "threshold": 0.92, **hann(2.0)}),
        "bsa-toolbox": ("bsa", toolbox),
        "hsa": ("hsa", peak),
        "t-hsa": ("t-hsa", {"threshold": part(0.085), **peak}),
        "if": ("if", fires),
        "lif": ("lif", fires),
        "sigma-delta": ("sigma-delta", ends),
        "sigma-delta-window": ("sigma-delta", {"mean": "window", "power": 6, **ends}),
        "bernoulli": ("bernoulli", {"seed": 1, **ends}),
        "burst-weighted": ("burst-weighted", {"weight": part(0.14), **ends}),
        "position": ("position", {"neurons": 20, **ends}),
        "position-gauss": ("position", {"centres": "gaussian", "neurons": 20, **ends}),
        "grf": ("grf", {"neurons": 20, **ends}),
        "grf-slots": ("grf-slots", {"neurons": 15, "slots": 10, **ends}),
        "grf-prob": ("grf-prob", {"neurons": 15, "seed": 1, **ends}),
        "grf-nonlinear": ("grf-nonlinear", {"neurons": 20, **companded}),
        "grf-nonlinear-slots": ("grf-nonlinear-slots", {"neurons": 15, "slots": 10, **companded}),
        "rank-order": ("rank-order", {"neurons": 15, "spikes": 3, **ends}),
        "ttfs": ("ttfs", ends),
        "ttfs-log": ("ttfs", {"edges": "log", **ends}),
        "latency-phase": ("latency-phase", ends),
        "weighted-phase": ("weighted-phase", ends),
        "burst": ("burst", ends),
    }
