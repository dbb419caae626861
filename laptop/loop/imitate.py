"""Trains the network of `chip.py` to do what the cascade does, and writes it as a NIR graph, in a minute: `imitate.py`.

1. The cascade flies at random; what it hears and what it does about it is kept.
2. A layer of neurons that add up and fire learns to do the same. Its weights are those of tinyODIN, whole numbers from
   -8 to 7: what is trained are real numbers beside them, of which the chip's are the nearest. A spike has no slope, so
   that its neuron's is taken in its place: a drive of a threshold is a spike (the "straight-through" estimator).
3. The network flies, the cascade says beside it what it would have done, and that is learnt too (DAgger: Ross, Gordon
   and Bagnell, 2011). Once more from 2.
"""

from __future__ import annotations

import nir
import numpy as np

import flight
from chip import AXES, CENTRES, INPUTS, NETWORK, NEURONS, POSITION, WORTH, Chipped, Plain
from codes import Coded, schemes
from manoeuvres import at_random

#: A neuron fires here.
THRESHOLD = 16
#: What a neuron starts with as the weight of each input: two inputs come a sample, so that it fires every fourth.
BASE = 2
#: Which way an axis' neurons push.
SIGNS = np.repeat([1, -1], NEURONS // 2)
#: A spike says little by itself: wishes are compared through a low pass of so many samples, as motors have one.
LAG = 5
#: Samples of a stretch that is learnt from, and stretches of a step.
STRETCH, BATCH = 150, 96
#: Flights of a round, rounds, and steps of a round.
FLIGHTS, ROUNDS, STEPS = 16, 3, 150
#: How fast is learnt, and how much of its neighbours' weights an input takes on a step.
LEARN, SMOOTH = 0.5, 0.005


def watched(network, seeds) -> list[np.ndarray]:
    """Flights on a network, or on the cascade: rates, turns and the cascade's wishes by axis, a row each."""
    rows = []
    for seed in seeds:
        control = Chipped(network and network())
        flown = flight.fly(at_random(seed), Coded(schemes("sod")), seed, control=control)
        heard = np.array(control.heard, float).reshape(-1, 3, AXES)
        # What holds for an axis holds for the other, and the other way around.
        rows += [way * heard[:, :, axis].T for axis in range(AXES) for way in (1, -1)]
        if flown.lost:
            print(f"seed {seed} is lost after {flown.seconds:.1f} s")
    return [row for row in rows if row.shape[1] > STRETCH]


def inputs(rates: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """The inputs that each sample of an axis drives: (samples, 2)."""
    rate, turn = (POSITION.encoder().encode(own).argmax(axis=1) for own in (rates, turns))
    return np.stack([rate, CENTRES + turn], axis=1)


def quantised(weights: np.ndarray) -> np.ndarray:
    """The chip's weights."""
    return np.clip(np.rint(weights), -8, 7)


def run(whole: np.ndarray, driven: np.ndarray, potentials: np.ndarray) -> np.ndarray:
    """Spikes that push one way less those that push the other, (recordings, samples), in whole numbers."""
    counts = np.empty(driven.shape[:2])
    for time in range(driven.shape[1]):
        fired = np.zeros_like(potentials)
        for event in range(driven.shape[2]):
            potentials += whole[driven[:, time, event]]
            fires = potentials >= THRESHOLD
            potentials[fires] = 0
            fired += fires
        counts[:, time] = fired @ SIGNS
    return counts


def lagged(values: np.ndarray) -> np.ndarray:
    """A low pass along the last axis."""
    low = np.zeros_like(values)
    for at in range(values.shape[-1]):
        low[..., at] = low[..., at - 1] + (values[..., at] - low[..., at - 1]) / LAG
    return low


def train(weights: np.ndarray, data: list[tuple], random) -> np.ndarray:
    """Real numbers whose nearest whole ones do what was watched: (inputs, neurons)."""
    for step in range(STEPS):
        chosen = [data[at] for at in random.integers(len(data), size=BATCH)]
        starts = [random.integers(len(own[1]) - STRETCH) for own in chosen]
        driven = np.stack([own[0][at : at + STRETCH] for own, at in zip(chosen, starts)])
        wishes = np.stack([own[1][at : at + STRETCH] for own, at in zip(chosen, starts)])
        counts = run(quantised(weights), driven, random.uniform(0, THRESHOLD, (BATCH, NEURONS)).round())
        wrong = lagged(WORTH * counts - wishes)
        # Of an error's past the latest counts most: the low pass backwards.
        blame = lagged(wrong[:, ::-1])[:, ::-1] / (WORTH * NEURONS / THRESHOLD)
        sums, visits = np.zeros(INPUTS), np.full(INPUTS, 20.0)
        for event in range(driven.shape[2]):
            np.add.at(sums, driven[:, :, event], blame)
            np.add.at(visits, driven[:, :, event], 1)
        weights -= LEARN * (1 - step / STEPS) * np.outer(sums / visits, SIGNS)
        # Inputs that hardly ever come do what their neighbours do.
        for first in (0, CENTRES):
            table = weights[first : first + CENTRES]
            table[1:-1] += SMOOTH * (table[2:] - 2 * table[1:-1] + table[:-2])
        if step % 50 == 49:
            print(f"  step {step + 1}: wishes of {lagged(wishes).std():.1f}, {wrong.std():.1f} off (rad/s²)", flush=True)
    return weights


def write(weights: np.ndarray) -> None:
    """The network of both axes, (inputs, neurons), as a graph. A neuron fires above its threshold, and has no leak."""
    inputs, neurons = weights.shape
    each = np.ones(neurons)
    nodes = {
        "input": nir.Input({"input": np.array([inputs])}),
        "weights": nir.Linear(weights.T),
        "neurons": nir.IF(r=each, v_threshold=(THRESHOLD - 0.5) * each, v_reset=0 * each),
        "output": nir.Output({"output": np.array([neurons])}),
    }
    nir.write(NETWORK, nir.NIRGraph(nodes, list(zip(nodes, list(nodes)[1:]))))


def main() -> None:
    random = np.random.default_rng(1)
    # Neurons round differently, so that their sum is finer than a weight.
    weights = BASE + random.uniform(-0.5, 0.5, (INPUTS, NEURONS))
    data, network = [], None
    for number in range(ROUNDS):
        flights = watched(network, range(FLIGHTS * number, FLIGHTS * (number + 1)))
        data += [(inputs(rate, turn), wish) for rate, turn, wish in flights]
        print(f"round {number + 1}: {len(data)} recordings", flush=True)
        weights = train(weights, data, random)
        both = np.kron(np.eye(AXES), quantised(weights))
        network = lambda both=both: Plain(both, THRESHOLD)
    write(both)


if __name__ == "__main__":
    main()
