"""Million samples a second of each scheme, beside plain Python and other libraries, in one run.

    python python/examples/speed.py            # a table
    python python/examples/speed.py --check    # fails if a scheme is not as many times faster as it should be

Plain Python is the pseudo-code of the paper line by line, on NumPy arrays: what one writes first.
"""

import argparse
import importlib.util
import sys
import time
from pathlib import Path

import numpy as np

import spikewire as sw

BENCH = Path(__file__).parents[2] / "cli" / "python" / "toolbox_bench.py"

#: The signal: ten thousand samples for plain Python, as long as it likes, and more of the same for the package.
SHORT, TIMES = 10_000, 400


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


def seconds(call, times=7, clock=time.process_time):
    """The least of several runs: of processor time, which leaves out what else the machine does."""
    least = float("inf")
    for _ in range(times):
        start = clock()
        call()
        least = min(least, clock() - start)
    return least


def signal(samples):
    t = np.arange(samples) / 100
    clean = 2 * np.sin(2 * np.pi * t) - 0.5 * np.cos(0.5 * np.pi * t) + 0.75 * np.sin(10 * np.pi * t)
    return (clean - 0.5 * np.random.default_rng(1).random(samples)).astype(np.float32)


def others(long, ends):
    """What other libraries encode the same signal with, where they are installed, and the scheme that is nearest."""
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
        yield "snnTorch `spikegen.delta`", lambda: spikegen.delta(data, threshold=0.3, off_spike=True), delta
    except ImportError:
        pass
    try:
        from spikingjelly.activation_based import encoding

        phase, first = sw.WeightedPhase(slots=8, **ends), sw.FirstSpike(slots=8, **ends)
        yield "SpikingJelly `PoissonEncoder`", lambda: encoding.PoissonEncoder()(unit), sw.Bernoulli(**ends)
        yield "SpikingJelly `WeightedPhaseEncoder`", lambda: encoding.WeightedPhaseEncoder(8)(unit), phase
        yield "SpikingJelly `LatencyEncoder`", lambda: encoding.LatencyEncoder(8)(unit), first
    except ImportError:
        pass


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="fail where it is slower than it should be")
    check = parser.parse_args().check
    bench = plain()
    x = signal(SHORT)
    long = np.tile(x, TIMES)
    low = {"shift": float(x.min())}
    ends = {"min": float(x.min()), "max": float(x.max())}
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
    print("| scheme | plain Python, M samples/s | spikewire | times | decode | two channels |")
    print("|---|--:|--:|--:|--:|--:|")
    both = np.stack([long, long])
    for name, wanted, scheme, transcription in rows:
        by_hand = len(x) / seconds(transcription, times=1)
        own = len(long) / seconds(lambda: scheme.encode(long, progress=False))
        two = both.size / seconds(lambda: scheme.encode(both, progress=False), clock=time.perf_counter)
        spikes = scheme.encode(long, progress=False)
        back = len(long) / seconds(lambda: spikes.decode(progress=False))
        times = own / by_hand
        print(
            f"| {name} | {by_hand * 1e-6:.3f} | {own * 1e-6:.1f} | {times:.0f} | {back * 1e-6:.1f} | {two * 1e-6:.1f} |",
            flush=True,
        )
        if times < wanted:
            slow.append(f"{name} is {times:.0f} times as fast, not {wanted}")
    beside = list(others(long, ends))
    print("\n| another library, M samples/s | | spikewire | | times |" if beside else "\nNo other library is installed.")
    print("|---|--:|---|--:|--:|" if beside else "`pip install snntorch spikingjelly` beside the package does it.")
    for name, call, scheme in beside:
        theirs = len(long) / seconds(call)
        own = len(long) / seconds(lambda: scheme.encode(long, progress=False))
        kind = type(scheme).__name__
        print(f"| {name} | {theirs * 1e-6:.1f} | `{kind}` | {own * 1e-6:.1f} | {own / theirs:.1f} |", flush=True)
    if check and slow:
        sys.exit("; ".join(slow))


if __name__ == "__main__":
    main()
