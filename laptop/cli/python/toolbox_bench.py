"""The paper's benchmark in plain Python: its pseudo-code as it stands, corrected by the toolbox's indices.

Written for comparison with `spikewire bench`: the same signals, schemes, parameters and figures.

    python3 cli/python/toolbox_bench.py --tests 10
"""

import argparse
import time

import numpy as np

CASES = [1, 5, 15, 50, 100]


def triang(length):
    middle = (length + 1) // 2
    rising = 2 * np.arange(1, middle + 1) / (length + 1)
    return np.concatenate([rising, rising[-2::-1]])


def contrast(x, factor):
    length = len(x)
    diff = np.zeros(length - 1)
    for i in range(length - 1):
        diff[i] = x[i + 1] - x[i]
    threshold = np.mean(diff) + factor * np.std(diff, ddof=1)
    diff = np.concatenate([[diff[0]], diff])
    spikes = np.zeros(length)
    for i in range(length):
        if diff[i] > threshold:
            spikes[i] = 1
        elif diff[i] < -threshold:
            spikes[i] = -1
    return spikes, threshold


def moving_window(x, threshold, window):
    spikes = np.zeros(len(x))
    for i in range(len(x)):
        base = np.mean(x[: window + 1] if i <= window else x[i - window - 1 : i])
        if x[i] > base + threshold:
            spikes[i] = 1
        elif x[i] < base - threshold:
            spikes[i] = -1
    return spikes


def step_forward(x, threshold):
    spikes = np.zeros(len(x))
    base = x[0]
    for i in range(1, len(x)):
        if x[i] > base + threshold:
            spikes[i] = 1
            base += threshold
        elif x[i] < base - threshold:
            spikes[i] = -1
            base -= threshold
    return spikes


def step_decode(spikes, step, start):
    y = np.zeros(len(spikes))
    y[0] = start
    for i in range(1, len(spikes)):
        y[i] = y[i - 1] + step * spikes[i]
    return y


def ben(x, taps, threshold):
    length, size = len(x), len(taps)
    x = x - np.min(x)
    spikes = np.zeros(length)
    for i in range(length - size):
        with_filter = without = 0.0
        for j in range(size):
            with_filter += abs(x[i + j + 1] - taps[j])
            without += abs(x[i + j])
        if with_filter <= without * threshold:
            spikes[i] = 1
            for j in range(size):
                if i + j + 2 < length:
                    x[i + j + 2] -= taps[j]
    return spikes


def hough(x, taps):
    length, size = len(x), len(taps)
    x = x - np.min(x)
    spikes = np.zeros(length)
    for i in range(length):
        count = 0
        for j in range(size):
            if i + j < length - 1 and x[i + j] >= taps[j]:
                count += 1
        if count == size:
            spikes[i] = 1
            for j in range(size):
                if i + j < length - 1:
                    x[i + j] -= taps[j]
    return spikes


def threshold_hough(x, taps, threshold):
    length, size = len(x), len(taps)
    x = x - np.min(x)
    spikes = np.zeros(length)
    for i in range(length):
        error = 0.0
        for j in range(size):
            if i + j < length - 1 and x[i + j] < taps[j]:
                error += taps[j] - x[i + j]
        if error <= threshold:
            spikes[i] = 1
            for j in range(size):
                if i + j < length - 1:
                    x[i + j] -= taps[j]
    return spikes


def rate_decode(spikes, taps, shift):
    return np.convolve(spikes, taps)[: len(spikes)] + shift


def fields(x, neurons):
    spacing = (np.max(x) - np.min(x)) / (neurons - 2)
    return np.min(x) + (2 * np.arange(neurons) - 1) / 2 * spacing, spacing


def gaussian(x, neurons):
    centres, _ = fields(x, neurons)
    spikes = np.zeros((len(x), neurons))
    for i in range(len(x)):
        spikes[i, np.argmin(np.abs(x[i] - centres))] = 1
    return spikes, centres[np.argmax(spikes, axis=1)]


def gaussian_slots(x, neurons, slots, beta):
    centres, spacing = fields(x, neurons)
    sigma = spacing / beta
    count, y = 0, np.zeros(len(x))
    for i in range(len(x)):
        response = np.exp(-((x[i] - centres) ** 2) / (2 * sigma**2))
        level = np.floor(slots * response + 0.5)
        count += np.count_nonzero(level)
        y[i] = np.sum(centres * level) / np.sum(level)
    return count, y


def run(x):
    """Efficiency in percent and root mean square error of TBR, MW, SF, BSA, HSA, T-HSA, GRF and GRF with slots."""
    nine, fifteen, low = triang(9), triang(15), np.min(x)
    results = []

    def result(count, y):
        results.append(((1 - count / len(x)) * 100, np.sqrt(np.mean((x - y) ** 2))))

    spikes, threshold = contrast(x, 0.5)
    result(np.sum(np.abs(spikes)), 2 * step_decode(spikes, threshold, 0))
    spikes = moving_window(x, 0.25, 5)
    result(np.sum(np.abs(spikes)), step_decode(spikes, 0.25, x[0]))
    spikes = step_forward(x, 0.5)
    result(np.sum(np.abs(spikes)), step_decode(spikes, 0.5, x[0]))
    spikes = ben(x, nine, 1.15)
    result(np.sum(spikes), rate_decode(spikes, nine, low))
    spikes = hough(x, fifteen)
    result(np.sum(spikes), rate_decode(spikes, fifteen, low))
    spikes = threshold_hough(x, fifteen, 0.85)
    result(np.sum(spikes), rate_decode(spikes, fifteen, low))
    spikes, y = gaussian(x, 20)
    result(np.sum(spikes), y)
    result(*gaussian_slots(x, 15, 10, 1.5))
    return results


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tests", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    generator = np.random.default_rng(options.seed)
    start, samples = time.perf_counter(), 0
    for seconds in CASES:
        t = np.arange(1, 100 * seconds + 1) / 100
        clean = 2 * np.sin(2 * np.pi * t) - 0.5 * np.cos(0.5 * np.pi * t) + 0.75 * np.sin(10 * np.pi * t)
        results = np.array([run(clean - 0.5 * generator.random(len(t))) for _ in range(options.tests)])
        samples += len(t) * options.tests
        mean, deviation = results.mean(axis=0), results.std(axis=0, ddof=1) if options.tests > 1 else 0 * results[0]
        for column, name in enumerate(["efficiency", "RMSE"]):
            cells = (f"{m:9.3f} ± {d:.3f}" for m, d in zip(mean[:, column], deviation[:, column]))
            print(f"{seconds:3} s {name:10}", *cells)
    elapsed = time.perf_counter() - start
    print(f"{samples} samples through 8 schemes, there and back, in {elapsed:.1f} s: {elapsed / samples * 17.1e6:.0f} s for 1000 tests")


if __name__ == "__main__":
    main()
