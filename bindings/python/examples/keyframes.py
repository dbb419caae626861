"""How often a link needs a keyframe: a recorded flight over a link that loses frames.

    python bindings/python/examples/keyframes.py

Six inertial channels, 198.5 samples a second, through send-on-delta; each sample's spikes are a frame. Prints how much of
the time all six values were exact, and the longest time that they were not, the mean of ten runs of 18 s.
"""

from pathlib import Path

import numpy as np

import spikewire as sw

RUNS = 10


def table():
    """A row for each rate of keyframes."""
    log = sw.read(Path(__file__).parents[3] / "data" / "hexarotor.csv")
    period = round(1e6 / log.rate)
    bank = [sw.SendOnDelta(threshold=0.1, spikes=4)] * 3 + [sw.SendOnDelta(threshold=0.5, spikes=4)] * 3
    random = np.random.default_rng(1)
    for hertz in (1, 5, 20, 50):
        sender = sw.Sender(bank, period=period, keyframe_every=round(log.rate / hertz))
        frames = [sender.encode(sample) for sample in log.x.T]
        speed = sum(len(frame) for sent in frames for frame in sent) / (len(frames) / log.rate)
        cells = [flights(bank, period, frames, loss, random) for loss in (0.001, 0.01, 0.1)]
        yield f"| {hertz} | {speed / 1000:.1f} | " + " | ".join(cells) + " |"


def flights(bank, period, frames, loss, random):
    """The share of exact samples, and the longest run of others, in s."""
    shares, longest = [], []
    for _ in range(RUNS):
        receiver, exact = sw.Receiver(bank, period=period), [True]
        for number, sent in enumerate(frames, start=1):
            for frame in sent:
                if random.random() >= loss:
                    receiver.hear(frame)
            receiver.advance(number * period)
            exact.append(receiver.exact.all())
        gaps = np.diff(np.flatnonzero([*exact, True])) - 1
        shares.append(np.mean(exact))
        longest.append(gaps.max() * period / 1e6)
    return f"{100 * np.mean(shares):.1f} %, {np.mean(longest):.2f} s"


if __name__ == "__main__":
    print("| keyframes a second | kB a second | 0.1 % of frames lost | 1 % | 10 % |")
    print("|---:|---:|---:|---:|---:|")
    print(*table(), sep="\n")
