"""From a folder of logs to a spiking classifier, trained in snnTorch on the manifest's split.

    python bindings/python/examples/fleet.py [FOLDER X Y Z [THRESHOLD]]

FOLDER holds flight logs of one kind, and X, Y and Z name its three turn rates, in rad/s. Without a folder, the recordings of
this repository, a hexarotor's flight and an aircraft at rest, are cut into logs of two seconds. Every log becomes
spikes and a row of a manifest; from a second of spikes, leaky neurons learn whether the aircraft flies. Logs that the
manifest keeps for testing are not trained on. By default these are other pieces of the same recordings, and the number of
spikes alone tells them apart.

Needs torch 1.13 or later, and snnTorch.
"""

# %% A folder of logs
import json
import sys
import tempfile
from pathlib import Path

import numpy as np
import snntorch as snn
import torch

import spikewire as sw

temporary = tempfile.TemporaryDirectory()
place = Path(temporary.name)
folder, channels, threshold = place / "logs", ["gyro_x", "gyro_y", "gyro_z"], 0.02
if sys.argv[1:]:
    folder, channels, *given = Path(sys.argv[1]), sys.argv[2:5], *map(float, sys.argv[5:])
    threshold = given[0] if given else threshold
else:
    folder.mkdir()
    for recording in ("hexarotor", "vtol_at_rest"):
        header, *rows = (Path(__file__).parents[3] / "data" / f"{recording}.csv").read_text().splitlines(keepends=True)
        for start in range(0, len(rows), 400):
            (folder / f"{recording}-{start}.csv").write_text(header + "".join(rows[start : start + 400]))

# %% Spikes of the code that flies, and the manifest
scheme = sw.StepForward(threshold=threshold)
counts = sw.dataset(folder, scheme, place / "spikes", channels=channels, test=0.3, skip_non_finite=True)
print(counts)
rows = [json.loads(line) for line in (place / "spikes/manifest.jsonl").read_text().splitlines()]

# %% Seconds, each a quarter after the one before: the spikes up and down of each channel in 50 steps, and whether it flies,
# as the roll rate's deviation tells
STEPS, FLIES = 50, 0.05


def seconds(row):
    """The seconds of a log: spikes (steps, seconds, 6), and whether it flies in each."""
    roll = sw.read(place / "spikes" / row["values"]).x[0]
    index, channel, polarity = np.empty((3, 0), int)
    if any(row["spikes"]):
        index, channel, polarity = sw.read(place / "spikes" / row["events"], "index", "channel", "polarity").x.astype(int)
    second = round(row["rate"] or 0)
    assert second >= 4, f"{row['log']}: a log needs times, and 4 samples a second at least"
    starts = range(0, len(roll) - second + 1, second // 4)
    spikes = np.zeros((STEPS, len(starts), 6), np.float32)
    for number, start in enumerate(starts):
        own = (index >= start) & (index < start + second)
        step = (index[own] - start) * STEPS // second
        np.add.at(spikes[:, number], (step, channel[own] + 3 * (polarity[own] < 0)), 1)
    return spikes, np.array([np.nanstd(roll[start : start + second]) > FLIES for start in starts], int)


def side(split):
    """All seconds on one side of the split."""
    all_seconds = [seconds(row) for row in rows if row["split"] == split]
    assert all_seconds, f"no log is on the side {split}: give more logs"
    spikes, flies = zip(*all_seconds)
    return torch.tensor(np.concatenate(spikes, axis=1)), torch.tensor(np.concatenate(flies))


train, test = side("train"), side("test")
print(f"{len(train[1])} seconds to train on, {len(test[1])} to test")


# %% Two layers of leaky neurons; the output that fires more often is the answer
class Classifier(torch.nn.Module):
    def __init__(self):
        super().__init__()
        self.hidden, self.output = torch.nn.Linear(6, 24), torch.nn.Linear(24, 2)
        self.leaky, self.leaky_output = snn.Leaky(beta=0.9), snn.Leaky(beta=0.9)

    def forward(self, spikes):
        potential, potential_output = self.leaky.init_leaky(), self.leaky_output.init_leaky()
        fired = 0
        for step in spikes:
            hidden, potential = self.leaky(self.hidden(step), potential)
            output, potential_output = self.leaky_output(self.output(hidden), potential_output)
            fired = fired + output
        return fired


torch.manual_seed(1)
classifier = Classifier()
optimiser = torch.optim.Adam(classifier.parameters(), lr=5e-3)
for _ in range(150):
    optimiser.zero_grad()
    loss = torch.nn.functional.cross_entropy(classifier(train[0]), train[1])
    loss.backward()
    optimiser.step()

# %% Logs that it has not seen
with torch.no_grad():
    right = (classifier(test[0]).argmax(1) == test[1]).float().mean().item()
flying = test[1].float().mean().item()
print(f"right on {right:.1%} of the seconds of unseen logs; the commonest answer alone is on {max(flying, 1 - flying):.1%}")
if not sys.argv[1:]:
    assert right > 0.85 > max(flying, 1 - flying)
