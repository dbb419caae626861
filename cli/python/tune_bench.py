"""`spikewire tune` beside SciPy's differential evolution on the same objective.

SciPy drives `spikewire score` a process at a time: least RMSE on the whole log at an efficiency of at least E percent,
2000 evaluations, several seeds. `tune` gets the same log with nothing held out, and its own budget: it is to be no worse, and
faster by the clock.

    python3 cli/python/tune_bench.py target/release/spikewire data/hexarotor.csv gyro_x

Names of schemes after the channel choose among them. Needs SciPy. Prints a row a scheme and seed, and ends with status 1 if `tune` was worse anywhere.
"""

import json
import math
import subprocess
import sys
import time

from scipy.optimize import differential_evolution

EVALUATIONS = 2000
SEEDS = range(1, 6)
# The scheme, the efficiency asked for, and by name the bounds that `tune` has, too.
PROBLEMS = [
    ("sf", 90.0, [("threshold", "log", 1e-3, 0.5)]),
    ("tbr", 90.0, [("threshold", "log", 1e-5, 0.5), ("step", "times", 0.1, 20.0)]),
    ("mw", 90.0, [("threshold", "log", 1e-4, 0.5), ("window", "whole", 0, 127)]),
    ("hsa", 70.0, [("shift", "around", -0.25, 0.25), ("filter", "filter", 0.3, 8.0)]),
    ("t-hsa", 60.0, [("shift", "around", -0.25, 0.25), ("filter", "filter", 0.3, 8.0), ("threshold", "of filter", 0.0, 1.0)]),
    ("bsa", 60.0, [("shift", "around", -0.25, 0.25), ("filter", "filter", 0.3, 8.0), ("threshold", "of filter", 0.0, 1.0)]),
]
SHAPES = ["triang", "hann", "gauss"]


def bounds(axes):
    """The box of a problem, and which of its numbers are whole."""
    box, whole = [], []
    for _, kind, low, high in axes:
        if kind in ("log", "times"):
            box.append((math.log(low), math.log(high)))
            whole.append(False)
        elif kind == "filter":
            box += [(1, 64), (0, 2), (math.log(0.1), math.log(8)), (math.log(low), math.log(high))]
            whole += [True, True, False, False]
        else:
            box.append((low, high))
            whole.append(kind == "whole")
    return box, whole


def options(axes, point, minimum, spread):
    """The options of `spikewire score` that a point means."""
    point, words, total = [float(value) for value in point], [], 1.0
    for name, kind, _, _ in axes:
        value = point.pop(0)
        if kind == "log":
            text = repr(math.exp(value) * spread)
        elif kind == "times":
            text = f"{math.exp(value)!r}x"
        elif kind == "whole":
            text = str(round(value))
        elif kind == "around":
            text = repr(minimum + value * spread)
        elif kind == "of filter":
            text = repr(value * total)
        else:
            shape, alpha = SHAPES[round(point.pop(0))], math.exp(point.pop(0))
            total = math.exp(point.pop(0)) * spread
            shaped = f":{alpha!r}" if shape == "gauss" else ""
            text = f"{shape}:{round(value)}{shaped},sum={total!r}"
        words.append(f"--{name}={text}")
    return words


def main():
    """Runs all problems and seeds."""
    program, log, channel, *schemes = sys.argv[1:]
    with open(log) as table:
        names = table.readline().strip().split(",")
        place = names.index(channel)
        values = [float(line.split(",")[place]) for line in table]
    minimum, spread = min(values), max(values) - min(values)
    print("| scheme | seed | SciPy RMSE | evaluations | s | tune RMSE | evaluations | s |")
    print("|---|--:|--:|--:|--:|--:|--:|--:|")
    worse = 0
    for scheme, efficiency, axes in PROBLEMS:
        if schemes and scheme not in schemes:
            continue
        box, whole = bounds(axes)
        for seed in SEEDS:
            best, count = [math.inf], [0]

            def objective(point):
                if count[0] >= EVALUATIONS:
                    return 1e12
                count[0] += 1
                command = [program, "score", "--json", "--scheme", scheme, "--column", channel, log]
                ran = subprocess.run(
                    command + options(axes, point, minimum, spread), capture_output=True, text=True
                )
                if ran.returncode != 0:
                    return 1e9
                figures = json.loads(ran.stdout)[0]
                if figures["efficiency"] < efficiency:
                    return 1e6 + efficiency - figures["efficiency"]
                best[0] = min(best[0], figures["rmse"])
                return figures["rmse"]

            start = time.time()
            population = 15
            differential_evolution(
                objective,
                box,
                seed=seed,
                integrality=whole,
                popsize=population,
                maxiter=EVALUATIONS // (population * len(box)),
                polish=False,
                tol=0.0,
            )
            theirs = time.time() - start
            start = time.time()
            ran = subprocess.run(
                [program, "tune", log, "--channel", channel, "--scheme", scheme, "--hold-out", "0"]
                + ["--min-efficiency", str(efficiency), "--seconds", "600"]
                + ["--seed", str(seed), "--json"],
                capture_output=True,
                text=True,
                check=True,
            )
            ours = time.time() - start
            row = json.loads(ran.stdout)[channel][0]
            rmse = row["tuned_on"]["rmse"]
            # The last digits are rounding.
            worse += rmse > best[0] * (1 + 1e-6)
            print(
                f"| {scheme} | {seed} | {best[0]:.5f} | {count[0]} | {theirs:.1f} "
                f"| {rmse:.5f} | {row['evaluated']} | {ours:.2f} |",
                flush=True,
            )
    sys.exit(1 if worse else 0)


if __name__ == "__main__":
    main()
