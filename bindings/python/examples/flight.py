"""From a flight log to a network trained on the very spikes that the firmware emits.

    python bindings/python/examples/flight.py

A hexarotor stands, takes off, flies, and lands hard. Its log is read, an encoder is tuned for each of six inertial channels,
and a layer of leaky neurons with a readout learns from the spikes alone whether the aircraft flies. At the end the flight's
spikes are compared, by their hash, with those that the firmware prints of the same flight.
"""

# %% The flight: three gyroscopes in rad/s and three accelerometers in m/s², 198.5 samples a second
import os
from pathlib import Path

import numpy as np

import spikewire as sw

HERE = Path(__file__).parent
log = sw.read(HERE.parents[2] / "data" / "hexarotor.csv")
x = log.x.astype(np.float32)
print(f"{len(log.names)} channels of {x.shape[1]} samples, {log.rate:.0f} a second")

# %% An encoder for each channel, tuned on the flight before its end: the least error with 20 % spikes
BEFORE = slice(0, 2200)
tuned = [
    sw.tune(own[BEFORE], "sf", rate=log.rate, min_efficiency=80, evaluations=100, name=name)
    for own, name in zip(x, log.names)
]
print(*tuned, sep="\n")
print(tuned[0].to_rust("ROLL"))

# %% The spikes of the code that flies
spikes = [own.scheme.encode(channel) for own, channel in zip(tuned, x)]
codes = np.stack([own.array for own in spikes])
print(f"{np.count_nonzero(codes)} spikes of {codes.size} samples")

# %% What is to be learnt: whether it flies, as the roll rate's deviation within a second tells
SECOND = 200
near = np.lib.stride_tricks.sliding_window_view(np.pad(x[0], (SECOND // 2, SECOND // 2 - 1), "edge"), SECOND)
flies = near.std(axis=1) > 0.05


# %% A layer of leaky neurons: each sums the spikes up, or down, of one channel, and forgets
def leaky(spikes, decay):
    state, states = np.zeros(len(spikes)), []
    for now in spikes.T:
        state = decay * state + now
        states.append(state)
    return np.array(states)


inputs = np.concatenate([codes == 1, codes == -1]).astype(float)
layer = np.hstack([leaky(inputs, decay) for decay in (0.9, 0.97)])
layer = np.hstack([layer / (1 + layer), np.ones((len(layer), 1))])  # between 0 and 1

# %% The readout, by gradient descent; every third second is kept back, and what is next to it left out
kept_back = np.arange(len(layer)) // SECOND % 3 == 2
learnt = np.convolve(kept_back, np.ones(SECOND // 2), "same") == 0
weights = np.zeros(layer.shape[1])
for _ in range(1000):
    error = flies - 1 / (1 + np.exp(-layer @ weights))
    weights += layer[learnt].T @ error[learnt] / learnt.sum()
right = np.mean((layer @ weights > 0)[kept_back] == flies[kept_back])
always = max(flies[kept_back].mean(), 1 - flies[kept_back].mean())
print(f"right on {right:.1%} of the seconds kept back; the commonest answer alone is on {always:.1%}")
assert right > 0.85 > always

# %% The firmware's step-forward encoders, at 2 % of each channel's range: the hash that every board prints of them
hash_of_flight = 0xCBF29CE484222325
for own in x:
    threshold = np.float32((float(own.max()) - float(own.min())) * 0.02)
    hash_of_flight = sw.StepForward(threshold=threshold).encode(own).fingerprint(hash_of_flight)
print(f"sf f32 hash={hash_of_flight:016x}")
if "FLIGHT_LOG" in os.environ:
    printed = Path(os.environ["FLIGHT_LOG"]).read_text().splitlines()
    line = next(line for line in printed if line.startswith("sf f32 "))
    assert line.endswith(f"hash={hash_of_flight:016x}"), line
    print("the firmware's, bit for bit")
