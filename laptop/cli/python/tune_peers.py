"""Compares `spikewire tune` with SciPy's differential evolution and optuna's TPE at equal numbers of settings.

Six signals through six schemes, with 100, 300 and 1000 settings. All three minimise the RMSE over the whole signal at an
efficiency that the scheme can reach; the peers score a point with `spikewire score`. Peers have the bounds that `tune` has.

    python3 cli/python/tune_peers.py target/release/spikewire data/hexarotor.csv results.json [scheme | signal]...

The peers' results are kept in the JSON file and not computed again. Needs SciPy and optuna. Prints a row for each problem
and budget, and ends with status 1 if `tune` is worse than 1.01 of the better peer anywhere, or not better at the median.
"""

import json
import math
import os
import statistics
import subprocess
import sys
import tempfile
import time

BUDGETS = [100, 300, 1000]
SEED = 1
RATE = [("shift", "around", -0.25, 0.25), ("filter", "filter", 0.3, 8.0)]
# The scheme, the efficiency asked for on the flight and on the paper's signal, and the parameters with their bounds.
PROBLEMS = [
    ("sf", 90.0, 73.0, [("threshold", "log", 1e-3, 0.5)]),
    ("tbr", 90.0, 46.0, [("threshold", "log", 1e-5, 0.5), ("step", "times", 0.1, 20.0)]),
    ("mw", 90.0, 60.0, [("threshold", "log", 1e-4, 0.5), ("window", "whole", 0, 127)]),
    ("hsa", 70.0, 62.0, RATE),
    ("t-hsa", 60.0, 55.0, [*RATE, ("threshold", "of filter", 0.0, 1.0)]),
    ("bsa", 60.0, 50.0, [*RATE, ("threshold", "of filter", 0.0, 1.0)]),
]
CHANNELS = ["gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_z"]
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


class Spent(Exception):
    """The budget of settings is spent."""


class Objective:
    """Scores points of a problem and keeps the best after each."""

    def __init__(self, program, log, channel, problem, budget):
        with open(log) as table:
            place = table.readline().strip().split(",").index(channel)
            values = [float(line.split(",")[place]) for line in table]
        self.minimum, self.spread = min(values), max(values) - min(values)
        self.command = [program, "score", "--json", "--scheme", problem[0], "--column", channel, log]
        self.efficiency, self.axes = problem[1:]
        self.budget, self.trace = budget, []

    def __call__(self, point):
        if len(self.trace) == self.budget:
            raise Spent
        words = options(self.axes, point, self.minimum, self.spread)
        ran = subprocess.run(self.command + words, capture_output=True, text=True)
        value = 1e9
        if ran.returncode == 0:
            figures = json.loads(ran.stdout)["logs"][0]["schemes"][0]
            lacking = self.efficiency - figures["efficiency"]
            value = figures["rmse"] if lacking <= 0 else 1e6 + lacking
        self.trace.append(min(value, self.trace[-1] if self.trace else math.inf))
        return value


def evolution(objective, box, whole):
    """SciPy's differential evolution with a population for some ten generations."""
    from scipy.optimize import differential_evolution

    population = max(1, round(objective.budget / 10 / len(box)))
    try:
        differential_evolution(
            objective, box, seed=SEED, integrality=whole, popsize=min(15, population), maxiter=10**6, polish=False, tol=0.0
        )
    except Spent:
        pass


def parzen(objective, box, whole):
    """Optuna's tree-structured Parzen estimator."""
    import optuna

    optuna.logging.set_verbosity(optuna.logging.ERROR)

    def trial(trial):
        point = [
            trial.suggest_int(str(place), low, high) if is_whole else trial.suggest_float(str(place), low, high)
            for place, ((low, high), is_whole) in enumerate(zip(box, whole))
        ]
        return objective(point)

    study = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=SEED))
    study.optimize(trial, n_trials=objective.budget)


def peers(program, log, channel, problem):
    """The best RMSE of each peer by budget."""
    box, whole = bounds(problem[2])
    found = {"de": {}, "tpe": {}}
    for budget in BUDGETS:
        objective = Objective(program, log, channel, problem, budget)
        evolution(objective, box, whole)
        found["de"][str(budget)] = objective.trace[-1]
    objective = Objective(program, log, channel, problem, BUDGETS[-1])
    parzen(objective, box, whole)
    for budget in BUDGETS:
        found["tpe"][str(budget)] = objective.trace[budget - 1]
    return found


def tuned(program, log, channel, problem, budget):
    """What `tune` reaches, with how many settings, and its seconds."""
    start = time.time()
    command = [program, "tune", log, "--channel", channel, "--scheme", problem[0], "--hold-out", "0", "--json"]
    command += ["--min-efficiency", str(problem[1]), "--evaluations", str(budget), "--seed", str(SEED)]
    ran = subprocess.run(command, capture_output=True, text=True)
    seconds = time.time() - start
    if ran.returncode != 0:
        return math.inf, budget, seconds
    row = json.loads(ran.stdout)["summary"]["channels"][channel][0]
    return row["tuned_on"]["rmse"], row["evaluated"], seconds


def main():
    """Runs all problems, prints their rows, and says whether the goal is reached."""
    program, log, results, *names = sys.argv[1:]
    kept = {}
    if os.path.exists(results):
        with open(results) as file:
            kept = json.load(file)
    with tempfile.TemporaryDirectory() as directory:
        paper = os.path.join(directory, "signal.csv")
        subprocess.run([program, "signal", "--seconds", "15", "--seed", "3", "-o", paper], check=True)
        signals = [(log, channel) for channel in CHANNELS] + [(paper, "signal")]
        print("| signal | scheme | settings | SciPy | optuna | tune | to the better | s |")
        print("|---|---|--:|--:|--:|--:|--:|--:|")
        ratios = {budget: [] for budget in BUDGETS}
        for path, channel in signals:
            for scheme, on_flight, on_paper, axes in PROBLEMS:
                if names and scheme not in names and channel not in names:
                    continue
                problem = (scheme, on_paper if channel == "signal" else on_flight, axes)
                key = f"{channel} {scheme}"
                if key not in kept:
                    kept[key] = peers(program, path, channel, problem)
                    with open(results, "w") as file:
                        json.dump(kept, file, indent=1)
                for budget in BUDGETS:
                    de, tpe = (kept[key][peer][str(budget)] for peer in ("de", "tpe"))
                    own, count, seconds = tuned(program, path, channel, problem, budget)
                    assert count <= budget, f"{key}: {count} settings, where {budget} were allowed"
                    ratio = own / min(de, tpe)
                    ratios[budget].append(ratio)
                    print(
                        f"| {channel} | {scheme} | {budget} | {de:.5g} | {tpe:.5g} | {own:.5g} | {ratio:.4f} | {seconds:.1f} |",
                        flush=True,
                    )
    reached = True
    for budget, all_of in ratios.items():
        tied = sum(abs(ratio - 1) <= 1e-4 for ratio in all_of)
        won = sum(ratio < 1 - 1e-4 for ratio in all_of)
        median, worst = statistics.median(all_of), max(all_of)
        reached &= worst <= 1.01 and median <= 1.0
        print(f"{budget} settings: {won} won, {tied} tied, {len(all_of) - won - tied} lost; median {median:.4f}, worst {worst:.4f}")
    sys.exit(0 if reached else 1)


if __name__ == "__main__":
    main()
