"""Million samples a second of each scheme, beside plain Python, NumPy and other libraries, in one run.

    python bindings/python/examples/speed.py            # tables: medians, with the least and the most of all rounds
    python bindings/python/examples/speed.py --shapes   # only arrays as batches have them
    python bindings/python/examples/speed.py --check    # fails if a scheme is not as many times faster as it should be

Plain Python is the pseudo-code of the paper line by line, on NumPy arrays: what one writes first. NumPy is the same
work on whole arrays, where a code has such a form. All run on one thread, as processor time adds up that of all threads.
"""

import argparse
import importlib.util
import os
import sys
import time
from pathlib import Path

import numpy as np

os.environ["RAYON_NUM_THREADS"] = "1"  # read at the first work

import spikewire as sw

BENCH = Path(__file__).parents[3] / "laptop" / "cli" / "python" / "toolbox_bench.py"

#: The signal: ten thousand samples for loops in Python, and more of the same for all else.
SHORT, TIMES = 10_000, 400

#: What is compared takes turns, so that a machine with other work slows both.
ROUNDS = 9


def plain():
    """The transcriptions."""
    spec = importlib.util.spec_from_file_location("toolbox_bench", BENCH)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def gaussian(x, neurons):
    """The winner of Gaussian receptive fields, by their responses."""
    low, spacing = x.min(), (x.max() - x.min()) / (neurons - 2)
    centres = low + (2 * np.arange(neurons) - 1) / 2 * spacing
    spikes = np.zeros((len(x), neurons))
    for i in range(len(x)):
        response = np.exp(-((x[i] - centres) ** 2) / (2 * (spacing / 1.5) ** 2))
        spikes[i, np.argmax(response)] = 1
    return spikes


def seconds(call):
    """One run: of processor time, which leaves out what else the machine does."""
    start = time.process_time()
    call()
    return time.process_time() - start


def rates(call, samples, rounds=ROUNDS):
    """Million samples a second, round by round."""
    return np.array([samples / seconds(call) * 1e-6 for _ in range(rounds)])


def spread(values, digits=1):
    """Median, least and most."""
    low, middle, high = (f"{value:.{digits}f}" for value in (values.min(), np.median(values), values.max()))
    return f"{middle} ({low} to {high})"


def signal(samples):
    t = np.arange(samples) / 100
    clean = 2 * np.sin(2 * np.pi * t) - 0.5 * np.cos(0.5 * np.pi * t) + 0.75 * np.sin(10 * np.pi * t)
    return (clean - 0.5 * np.random.default_rng(1).random(samples)).astype(np.float32)


def vectors(ends):
    """The same work on whole arrays in NumPy, in its shortest form, and the scheme: name, call of array and axis, scheme."""
    low, range_ = np.float32(ends["min"]), np.float32(ends["max"] - ends["min"])
    random = np.random.default_rng(2)

    def contrast(x, axis):
        time, later, earlier = (slice(None),) * (axis % x.ndim), slice(1, None), slice(None, -1)
        spikes, steps = np.zeros(x.shape, np.int8), x[(*time, later)] - x[(*time, earlier)]
        np.subtract((steps > 0.3).view(np.int8), (steps < -0.3).view(np.int8), out=spikes[(*time, later)])
        return spikes

    def phase(x, _):
        digits = np.minimum((x - low) * (256 / range_), 255).astype(np.uint8)
        return np.unpackbits(digits[..., None], axis=-1)

    def chance(x, _):
        return (random.random(x.shape, dtype=np.float32) < (x - low) / range_).view(np.int8)

    yield "differences", contrast, sw.TemporalContrast(threshold=0.3)
    yield "`unpackbits`", phase, sw.WeightedPhase(slots=8, **ends)
    yield "`random`", chance, sw.Bernoulli(**ends)


def shapes(long, ends):
    """Arrays as batches have them, beside NumPy: samples in a second, and what one channel takes."""
    still = np.broadcast_to(long[: 64 * 784].reshape(64, 784), (100, 64, 784))
    arrays = [
        ("(1000000,)", long[:1_000_000], -1),
        ("(64, 784, 100)", np.resize(long, (64, 784, 100)), -1),
        ("(100, 512, 6), time first", np.resize(long, (100, 512, 6)), 0),
        ("(64, 784) through 100 steps", still, 0),
        ("(120000, 10)", np.resize(long, (120_000, 10)), -1),
    ]
    print("\n| shape | NumPy | M samples/s | spikewire | M samples/s | times | µs a channel |")
    print("|---|---|--:|---|--:|--:|--:|")
    for shape, x, axis in arrays:
        for name, call, scheme in vectors(ends):
            pairs = [
                (rates(lambda: call(x, axis), x.size, 1)[0], rates(lambda: scheme.encode(x, False, axis), x.size, 1)[0])
                for _ in range(ROUNDS)
            ]
            theirs, own = np.array(pairs).T
            channel = x.shape[axis] / np.median(own)
            print(
                f"| {shape} | {name} | {spread(theirs)} | `{type(scheme).__name__}` | {spread(own)} "
                f"| {spread(own / theirs)} | {channel:.3f} |",
                flush=True,
            )


def others(x, long, ends):
    """What other libraries encode the same signal with, where they are installed, and the nearest scheme."""
    try:
        from spikify.encoders.temporal import contrast, global_referenced

        short = x.astype(np.float64)
        window = sw.MovingWindow(threshold=0.25, window=5)
        each = np.repeat(short, 8)  # its phase code has one value for as many samples as digits
        # Both find the threshold in the differences of the signal, as it is.
        yield "spikify `threshold_based_representation`", (
            lambda: contrast.threshold_based_representation(long, 1.0)
        ), len(long), sw.TemporalContrast(factor=1.0)
        yield "spikify `step_forward`", lambda: contrast.step_forward(short, 0.5), len(x), sw.StepForward(threshold=0.5)
        yield "spikify `moving_window`", lambda: contrast.moving_window(short, 5, 0.25), len(x), window
        yield "spikify `phase`", (
            lambda: global_referenced.phase(each, 8)
        ), len(x), sw.WeightedPhase(slots=8, **ends)
    except ImportError:
        pass
    try:
        from spikes.encoder import TBR

        # Its recordings are (flights, samples, channels).
        yield "pyspikes `TBR`", (
            lambda: TBR(long[None, :, None], 1.0).get_spikes()
        ), len(long), sw.TemporalContrast(factor=1.0, magnitudes=True)
    except ImportError:
        pass
    try:
        import torch

        torch.set_num_threads(1)
    except ImportError:
        return
    data = torch.from_numpy(long)
    # SpikingJelly takes values from 0 to less than 1.
    unit = (data - ends["min"]) / (ends["max"] - ends["min"]) * (1 - 2**-8)
    try:
        from snntorch import spikegen

        delta = sw.TemporalContrast(threshold=0.3)
        yield "snnTorch `spikegen.delta`", (
            lambda: spikegen.delta(data, threshold=0.3, off_spike=True)
        ), len(long), delta
    except ImportError:
        pass
    try:
        from norse.torch.functional.encode import poisson_encode

        chance = sw.Bernoulli(**ends)
        yield "Norse `poisson_encode`", lambda: poisson_encode(unit, 1, f_max=1000), len(long), chance
    except ImportError:
        pass
    try:
        from spikingjelly.activation_based import encoding

        phase, first = sw.WeightedPhase(slots=8, **ends), sw.FirstSpike(slots=8, **ends)
        yield "SpikingJelly `PoissonEncoder`", lambda: encoding.PoissonEncoder()(unit), len(long), sw.Bernoulli(**ends)
        yield "SpikingJelly `WeightedPhaseEncoder`", lambda: encoding.WeightedPhaseEncoder(8)(unit), len(long), phase
        yield "SpikingJelly `LatencyEncoder`", lambda: encoding.LatencyEncoder(8)(unit), len(long), first
    except ImportError:
        pass


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="fail where it is slower than it should be")
    parser.add_argument("--shapes", action="store_true", help="print only arrays as batches have them")
    given = parser.parse_args()
    x = signal(SHORT)
    long = np.tile(x, TIMES)
    low = {"shift": float(x.min())}
    ends = {"min": float(x.min()), "max": float(x.max())}
    if given.shapes:
        return shapes(long, ends)
    bench = plain()
    nine, fifteen = bench.triang(9), bench.triang(15)
    rows = [
        ("TBR", 10, sw.TemporalContrast(threshold=0.3), lambda: bench.contrast(x, 0.5)),
        ("MW", 10, sw.MovingWindow(threshold=0.25, window=5), lambda: bench.moving_window(x, 0.25, 5)),
        ("SF", 10, sw.StepForward(threshold=0.5), lambda: bench.step_forward(x, 0.5)),
        ("BSA", 100, sw.Bsa(form="toolbox", filter="triang:9", threshold=1.15, **low), lambda: bench.ben(x, nine, 1.15)),
        ("HSA", 100, sw.Hough(filter="triang:15", **low), lambda: bench.hough(x, fifteen)),
        (
            "T-HSA",
            100,
            sw.ThresholdHough(filter="triang:15", threshold=0.85, **low),
            lambda: bench.threshold_hough(x, fifteen, 0.85),
        ),
        ("GRF", 100, sw.Gaussian(neurons=20, **ends), lambda: gaussian(x, 20)),
    ]
    slow = []
    print("| scheme | plain Python, M samples/s | spikewire | times | decode | six channels | times |")
    print("|---|--:|--:|--:|--:|--:|--:|")
    six = np.stack([np.roll(x, shift) for shift in range(6)])
    for name, wanted, scheme, transcription in rows:
        by_hand = rates(transcription, len(x), rounds=1)[0]
        own = rates(lambda: scheme.encode(long, progress=False), len(long))
        side = rates(lambda: scheme.encode(six, progress=False), six.size)
        spikes = scheme.encode(long, progress=False)
        back = rates(lambda: spikes.decode(progress=False), len(long))
        times = np.median(own) / by_hand
        print(
            f"| {name} | {by_hand:.3f} | {spread(own)} | {times:.0f} | {spread(back)} "
            f"| {spread(side)} | {np.median(side) / by_hand:.0f} |",
            flush=True,
        )
        if times < wanted:
            slow.append(f"{name} is {times:.0f} times as fast, not {wanted}")
    print("\n| on whole arrays | M samples/s | spikewire | M samples/s | times |")
    print("|---|--:|---|--:|--:|")
    for name, call, samples, scheme in others(x, long, ends):
        pairs = [
            (samples / seconds(call) * 1e-6, len(long) / seconds(lambda: scheme.encode(long, progress=False)) * 1e-6)
            for _ in range(ROUNDS)
        ]
        theirs, own = np.array(pairs).T
        print(
            f"| {name} | {spread(theirs, 1 if theirs.max() > 1 else 3)} | `{type(scheme).__name__}` | {spread(own)} "
            f"| {spread(own / theirs)} |",
            flush=True,
        )
    shapes(long, ends)
    if given.check and slow:
        sys.exit("; ".join(slow))


if __name__ == "__main__":
    main()
