"""Compares `spikewire.tune` with SciPy's differential evolution and optuna's TPE.

Signals, six unless told, through every code that has parameters to search, with 100, 300 and 1000 settings. All three minimise the RMSE
at an efficiency that random settings reach, and all search between the bounds of the catalogue. The settings found are also
scored on the next flight, which none of them has seen.

    python tune_peers.py RESULTS.json SEED LOG:CHANNEL,CHANNEL… [LOG:CHANNEL…]... [--only CODE]... [--skip CODE]...
        [--signals COUNT] [--tpe SETTINGS]

TPE, which takes long, ends after `--tpe` settings; larger budgets are then compared with what it found until there.
The seed draws the signals out of the logs' channels, the stretches of them and the efficiencies. The peers' results are
kept in the JSON file and not computed again: remove it if codecs or bounds have changed. Needs the package `spikewire`, SciPy and optuna. Prints a row for each problem
and budget, and for each code the median over the signals. Ends with status 1 if a code's median is above 1.01 of the better
peer; if a search is worse with more settings than with fewer; or if for a number of settings the median of all next flights is above 1.01.
"""

import argparse
import json
import math
import os
import statistics
import sys
import time

import numpy as np
import spikewire as sw

BUDGETS = [100, 300, 1000]
SAMPLES = 1000
SHAPES = ["triang", "hann", "gauss"]


class Spent(Exception):
    """The budget of settings is spent."""


class Space:
    """The searched parameters of a code, between the bounds of the catalogue."""

    def __init__(self, code, x):
        self.code, self.low, self.high = code, float(x.min()), float(x.max())
        self.parameters = [own for own in sw.schemes[code]._info["parameters"] if own["search"]]
        # The bounds of a filter need its length; what is relative to the filter comes after it.
        self.parameters.sort(key=lambda own: own["search"][0] == "of filter")
        self.is_random = any(own["name"] == "seed" for own in sw.schemes[code]._info["parameters"])
        self.box, self.whole = [], []
        for own in self.parameters:
            kind, low, high, _ = own["search"]
            if kind in ("log", "times"):
                self.box.append((math.log(low), math.log(high)))
                self.whole.append(False)
            elif kind == "filter":
                self.box += [(1, 64), (0, 2), (math.log(0.1), math.log(8)), (math.log(low), math.log(high))]
                self.whole += [True, True, False, False]
            else:
                self.box.append((low, high))
                self.whole.append(kind in ("whole", "words"))

    def scheme(self, point):
        """The scheme that a point means."""
        point, keywords, total = [float(value) for value in point], {}, 1.0
        spread = self.high - self.low
        for own in self.parameters:
            kind, value = own["search"][0], point.pop(0)
            if kind == "log":
                value = math.exp(value) * (spread if own["unit"] == "the signal's unit" else 1.0)
            elif kind == "times":
                value = f"{math.exp(value)!r}x"
            elif kind == "whole":
                value = round(value)
            elif kind == "words":
                value = own["search"][3][round(value)]
            elif kind == "around":
                value = (self.high if own["found"] == "the signal's maximum" else self.low) + value * spread
            elif kind == "of filter":
                value *= total
            else:
                shape, alpha = SHAPES[round(point.pop(0))], math.exp(point.pop(0))
                total = math.exp(point.pop(0)) * spread
                shaped = f":{alpha!r}" if shape == "gauss" else ""
                value = f"{shape}:{round(value)}{shaped},sum={total!r}"
            keywords[own["name"]] = value
        if self.is_random:
            keywords["seed"] = 0
        return sw.schemes[self.code](**keywords)

    def random(self, rng):
        """A point, drawn evenly."""
        return [
            rng.integers(round(low), round(high), endpoint=True) if is_whole else rng.uniform(low, high)
            for (low, high), is_whole in zip(self.box, self.whole)
        ]


def figures(scheme, x):
    """The efficiency and the RMSE of a scheme; none if it cannot be built."""
    try:
        spikes = scheme.encode(x)
        decoded = np.asarray(spikes.decode(), float)
    except ValueError:
        return None
    return 100 * (1 - spikes.count / len(x)), float(np.sqrt(np.mean((decoded - x) ** 2)))


class Objective:
    """Scores points of a problem, and keeps the best after each."""

    def __init__(self, space, x, goal, budget):
        self.space, self.x, self.goal, self.budget = space, x, goal, budget
        self.trace = []

    def __call__(self, point):
        if len(self.trace) == self.budget:
            raise Spent
        try:
            scheme = self.space.scheme(point)
        except ValueError:
            scheme = None
        found = scheme and figures(scheme, self.x)
        value = 1e9
        if found:
            value = found[1] if found[0] >= self.goal - 1e-9 else 1e6 + self.goal - found[0]
        known = self.trace[-1] if self.trace else (math.inf, None)
        self.trace.append((value, list(map(float, point))) if value < known[0] else known)
        return value


def evolution(objective, seed):
    """SciPy's differential evolution with a population for some ten generations."""
    from scipy.optimize import differential_evolution

    box, whole = objective.space.box, objective.space.whole
    population = max(1, round(objective.budget / 10 / len(box)))
    try:
        differential_evolution(
            objective, box, rng=seed, integrality=whole, popsize=min(15, population), maxiter=10**6, polish=False, tol=0.0
        )
    except Spent:
        pass


def parzen(objective, seed):
    """Optuna's tree-structured Parzen estimator."""
    import optuna

    optuna.logging.set_verbosity(optuna.logging.ERROR)

    def trial(trial):
        point = [
            trial.suggest_int(str(place), round(low), round(high)) if is_whole else trial.suggest_float(str(place), low, high)
            for place, ((low, high), is_whole) in enumerate(zip(objective.space.box, objective.space.whole))
        ]
        return objective(point)

    study = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=seed))
    study.optimize(trial, n_trials=objective.budget)


def peers(space, x, goal, seed, most):
    """The best point of each peer by budget, with its RMSE. TPE scores at most `most` settings."""
    found = {"de": {}, "tpe": {}}
    for budget in BUDGETS:
        objective = Objective(space, x, goal, budget)
        evolution(objective, seed)
        found["de"][str(budget)] = objective.trace[-1]
    objective = Objective(space, x, goal, min(BUDGETS[-1], most))
    parzen(objective, seed)
    for budget in BUDGETS:
        found["tpe"][str(budget)] = objective.trace[min(budget, most) - 1]
    return found


def signals(logs, rng, count):
    """This many signals, each of a drawn channel: a stretch to tune on, and one of the next flight."""
    channels = [(log, own) for log, names in logs for own in names]
    picked = [channels[place] for place in rng.permutation(len(channels))]
    for log, channel in (picked * count)[:count]:
        x = sw.read(log, channel, skip_non_finite=True).x[0]
        x = x[np.isfinite(x)]
        # A flight's rest at its ends says little.
        moving = np.flatnonzero(np.abs(x - np.median(x)) > 0.2 * np.std(x))
        x = x[moving[0] : moving[-1] + 1]
        length = min(SAMPLES, len(x) // 2)
        start = int(rng.integers(0, len(x) - 2 * length, endpoint=True))
        yield f"{os.path.basename(log)}:{channel}@{start}", x[start : start + length], x[start + length : start + 2 * length]


def goal_of(space, x, rng):
    """An efficiency that some of the random settings reach."""
    drawn = []
    for _ in range(60):
        try:
            drawn.append(figures(space.scheme(space.random(rng)), x))
        except ValueError:
            pass
    reached = sorted(own[0] for own in drawn if own and own[1] < 2 * np.std(x)) or sorted(own[0] for own in drawn if own)
    return reached[int(rng.uniform(0.3, 0.8) * len(reached))]


def tuned(space, x, goal, budget, seed):
    """The RMSE that `tune` reaches, the number of settings that it scored, and the scheme found."""
    try:
        own = sw.tune(x, space.code, min_efficiency=goal, hold_out=0, evaluations=budget, seed=seed, anyway=True)
    except ValueError as error:
        print(space.code, error, file=sys.stderr)
        return math.inf, 0, None
    assert own.figures["evaluated"] <= budget, f"{own.figures['evaluated']} settings, where {budget} were allowed"
    return own.figures["tuned_on"]["rmse"], own.figures["evaluated"], own.scheme


def main():
    """Runs all problems, prints their rows, and says whether the goal is reached."""
    parser = argparse.ArgumentParser()
    parser.add_argument("results")
    parser.add_argument("seed", type=int)
    parser.add_argument("logs", nargs="+")
    parser.add_argument("--only", action="append", default=[])
    parser.add_argument("--skip", action="append", default=[])
    parser.add_argument("--signals", type=int, default=6)
    parser.add_argument("--tpe", type=int, default=BUDGETS[-1])
    options = parser.parse_args()
    results, seed, only = options.results, options.seed, options.only
    logs = [(own.rsplit(":", 1)[0], own.rsplit(":", 1)[1].split(",")) for own in options.logs]
    kept = {}
    if os.path.exists(results):
        with open(results) as file:
            kept = json.load(file)
    print("| signal | code | goal % | settings | DE | TPE | tune | to the better | next flight | s |")
    print("|---|---|--:|--:|--:|--:|--:|--:|--:|--:|")
    ratios, unseen, less = {}, {budget: [] for budget in BUDGETS}, []
    for name, x, following in signals(logs, np.random.default_rng(seed), options.signals):
        for code in sw.schemes:
            space = Space(code, x)
            if not space.box or only and code not in only or code in options.skip:
                continue
            key = f"{seed} {options.tpe} {name} {code}"
            if key not in kept:
                goal = goal_of(space, x, np.random.default_rng(seed))
                start = time.time()
                kept[key] = {"goal": goal, **peers(space, x, goal, seed, options.tpe)}
                print(f"{key}: peers took {time.time() - start:.1f} s", file=sys.stderr, flush=True)
                with open(results, "w") as file:
                    json.dump(kept, file)
            goal, before = kept[key]["goal"], math.inf
            for budget in BUDGETS:
                others = [kept[key][peer][str(budget)] for peer in ("de", "tpe")]
                start = time.time()
                own, count, scheme = tuned(space, x, goal, budget, seed)
                seconds = time.time() - start
                better = min(others, key=lambda other: other[0])
                ratio = own / better[0] if own < math.inf or better[0] < 1e5 else 1.0
                ratios.setdefault(code, {}).setdefault(budget, []).append(ratio)
                if own > before * (1 + 1e-9):
                    less.append(f"{key} {budget}: {own / before:.4f}")
                before = own
                ahead = math.nan
                if scheme and better[0] < 1e5:
                    on_next = [figures(space.scheme(other[1]), following) for other in others if other[0] < 1e5]
                    ahead = figures(scheme, following)[1] / min(other[1] for other in on_next if other)
                    unseen[budget].append(ahead)
                print(
                    f"| {name} | {code} | {goal:.1f} | {budget} | {others[0][0]:.5g} | {others[1][0]:.5g} | {own:.5g} "
                    f"| {ratio:.4f} | {ahead:.4f} | {seconds:.1f} |",
                    flush=True,
                )
    print("\n| code | " + " | ".join(f"{budget} settings" for budget in BUDGETS) + " |")
    print("|---|" + "--:|" * len(BUDGETS))
    reached = not less
    for code, own in ratios.items():
        medians = [statistics.median(own[budget]) for budget in BUDGETS]
        reached &= max(medians) <= 1.01
        print(f"| {code} | " + " | ".join(f"{median:.3f}" for median in medians) + " |")
    for budget in BUDGETS:
        all_of = [ratio for own in ratios.values() for ratio in own[budget]]
        tied = sum(abs(ratio - 1) <= 1e-4 for ratio in all_of)
        won = sum(ratio < 1 - 1e-4 for ratio in all_of)
        above = sum(ratio > 1.01 for ratio in all_of)
        print(
            f"{budget} settings: {won} won, {tied} tied, {len(all_of) - won - tied} lost, {above} above 1.01; "
            f"median {statistics.median(all_of):.4f}, worst {max(all_of):.4f}"
        )
    print(f"worse with more settings: {len(less)} {less}")
    for budget, own in unseen.items():
        print(f"next flight, {budget} settings: median {statistics.median(own):.4f}, worst {max(own):.4f}")
        reached &= statistics.median(own) <= 1.01
    sys.exit(0 if reached else 1)


if __name__ == "__main__":
    main()
