"""User code that a type checker must accept."""
import numpy as np
import torch
from torch import nn
from torch.utils.data import DataLoader

import spikewire as sw
from spikewire.torch import Controller, Encode, ReckOn, TinyOdin, Windows

layer = Encode(sw.StepForward(threshold=0.1), time=1, split=True, gradient="straight")
own = Encode(sw.Bernoulli(min=0, max=1), 25, dtype=torch.bfloat16, gradient=lambda x: 1 / (1 + x.abs()))
network = nn.Sequential(layer, nn.Linear(12, 3))
loader = DataLoader(Windows(np.zeros((100, 6), np.float32), np.zeros(100), 20), batch_size=4)
for samples, labels in loader:
    out: torch.Tensor = network(samples)
    spikes: torch.Tensor = layer(samples)
    print(spikes.shape, out.shape, labels)

flown = Controller(12, 20, 3, recurrent=True)
for chip in (ReckOn(12, 20, 3), TinyOdin(12, 20, 3)):
    out = chip(layer(torch.zeros(4, 50, 6)))
rust: str = flown.network().to_rust([[0, 1], [2]])
array = sw.StepForward(threshold=0.1).encode(np.zeros(9))
same: np.ndarray = np.asarray(array) * 2

one = sw.StepForward(threshold=np.float32(0.1)).encode(np.zeros((2, 9), np.float32))
two = sw.Gaussian(neurons=np.int64(9), min=np.float64(0), max=1, sample="f32")
x = np.zeros((2, 900))
best = sw.advise(x[0], rate=np.float64(200)).best
if best is not None:
    print(best.scheme.name)
print([own.page for own in sw.advise(x)], sw.advise([0.0, 1.0]).page, sw.low_pass(np.float32(20), rate=np.int64(1000)))
events: np.ndarray = one.events(period=np.timedelta64(1, "ms"))
names: list[str] | None = one.names
frames: list[bytes] = sw.Sender(two, period=np.int32(1000)).encode(x[0, :6])
again: sw.Scheme = sw.Scheme.from_toml(two.to_toml())
