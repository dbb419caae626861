"""The layer of PyTorch, where torch is installed."""

import copy
import importlib.util
import json
import os
import pickle
import subprocess
import tomllib
from pathlib import Path

import numpy as np
import pytest

import spikewire as sw

torch = pytest.importorskip("torch")

from torch.utils.data import DataLoader

from spikewire import _from_torch
from spikewire.torch import Controller, Encode, ReckOn, TinyOdin, Windows

X = torch.sin(torch.linspace(0, 60, 4 * 50 * 6)).reshape(4, 50, 6)  # (batch, time, features)
SLOTS = sw.Slots(neurons=5, slots=3, min=-1, max=1)


@pytest.mark.parametrize("scheme", [sw.StepForward(threshold=0.1), sw.Gaussian(neurons=5, min=-1, max=1), SLOTS])
@pytest.mark.parametrize("time", [0, 1, -1])
@pytest.mark.parametrize("split", [False, True])
def test_cells_are_those_of_encode(scheme, time, split):
    spikes = Encode(scheme, time=time, split=split)(X)
    expected = np.moveaxis(scheme.encode(X.numpy(), axis=time).array.reshape(*X.shape, scheme.slots, scheme.neurons), time % 3, 0)
    steps, batch, features = expected.shape[:3]
    ups, downs = np.maximum(expected, 0), np.maximum(-expected, 0)
    signs = np.stack([ups, downs] if split else [expected])  # (signs, time, batch, features, slots, neurons)
    by_slot = signs.transpose(1, 4, 2, 0, 3, 5).reshape(steps * scheme.slots, batch, -1)
    assert spikes.dtype == torch.float32
    assert np.array_equal(spikes.numpy(), by_slot)


def test_time_is_an_axis_of_the_samples():
    step = sw.StepForward(threshold=0.1)
    for time in (3, 5, -4, True, 1.5):
        with pytest.raises(sw.Error, match="axis"):
            Encode(step, time=time)(X)
    with pytest.raises(sw.Error, match="not one number"):
        Encode(step)(torch.tensor(1.0))
    with pytest.raises(sw.Error, match="channel 0, sample 1: NaN is not finite"):
        Encode(step)(torch.tensor([0.0, float("nan")]))


def test_still_samples_are_drawn_by_step():
    still = torch.tensor([[0.0, 1.0, 0.5], [1.0, 0.0, 0.5]])
    spikes = Encode(sw.Bernoulli(min=0, max=1, seed=1), num_steps=400)(still)
    assert spikes.shape == (400, 2, 3)
    assert torch.allclose(spikes.mean(0), still, atol=0.08)
    assert not torch.equal(spikes[:, 0, 2], spikes[:, 1, 2])
    first = Encode(sw.FirstSpike(min=0, max=1, slots=8), num_steps=1)(still)
    assert first.shape == (8, 2, 3)
    assert Encode(sw.StepForward(threshold=0.5))(torch.zeros(7)).shape == (7, 1)


@pytest.mark.parametrize("dtype", [torch.bfloat16, torch.float16, torch.float64, torch.int8, torch.bool])
def test_types(dtype):
    scheme = sw.StepForward(threshold=0.1)
    spikes = Encode(scheme, time=1, split=True, dtype=dtype)(X)
    assert spikes.dtype == dtype
    assert torch.equal(spikes.float(), Encode(scheme, time=1, split=True)(X))
    rounded = Encode(scheme, time=1)(X.bfloat16())
    assert torch.equal(rounded, Encode(scheme, time=1)(X.bfloat16().float()))
    assert Encode(scheme, time=1)(X[:0]).shape == (50, 0, 6)
    assert Encode(sw.WeightedPhase(min=0, max=256), num_steps=1)(torch.arange(256, dtype=torch.uint8)).shape == (8, 256)


@pytest.mark.parametrize("split", [False, True])
def test_gradients(split):
    x = X.clone().requires_grad_()
    assert not Encode(sw.StepForward(threshold=0.1), time=1)(x).requires_grad
    weights = torch.arange(50.0)[:, None, None]
    Encode(SLOTS, time=1, split=split, gradient="straight")(x).unflatten(0, (50, 3)).sum(1).mul(weights).sum().backward()
    # Ups count 5 neurons' worth in 3 slots, downs the same with the other sign.
    expected = (15.0 - 15.0 * split) * weights.transpose(0, 1).expand_as(X)
    assert torch.equal(x.grad, expected)
    still = X[:, 0].clone().requires_grad_()
    draws = Encode(sw.Bernoulli(min=-1, max=1), num_steps=9, gradient=lambda x: 1 / (1 + x.abs()))
    draws(still).sum().backward()
    assert torch.allclose(still.grad, 9 / (1 + still.detach().abs()))
    half = X.bfloat16().requires_grad_()
    Encode(sw.StepForward(threshold=0.1), time=1, gradient="straight", dtype=torch.bfloat16)(half).sum().backward()
    assert half.grad.dtype == torch.bfloat16
    double = X.double().requires_grad_()
    Encode(sw.StepForward(threshold=0.1), time=1, gradient="straight", dtype=torch.float64)(double).div(3).sum().backward()
    assert torch.equal(double.grad, torch.full_like(double, 1 / 3))


@pytest.mark.parametrize("dtype", [torch.uint8, torch.bool])
def test_types_without_a_sign(dtype):
    with pytest.raises(ValueError, match="has no sign for spikes down"):
        Encode(sw.StepForward(threshold=0.1), dtype=dtype)
    assert torch.equal(Encode(SLOTS, time=1, dtype=dtype)(X).float(), Encode(SLOTS, time=1)(X))


def test_compiles_as_one_operator():
    layer = Encode(sw.StepForward(threshold=0.1), time=1, gradient="straight")
    torch.library.opcheck(torch.ops.spikewire.encode.default, (X, layer._number))
    torch.library.opcheck(torch.ops.spikewire.encode.default, (X.clone().requires_grad_(), layer._number))
    network = torch.nn.Sequential(layer, torch.nn.Linear(6, 2))
    compiled = torch.compile(network, fullgraph=True, backend="aot_eager")
    assert torch.equal(compiled(X), network(X))


def test_copies_encode_alike():
    layer = Encode(sw.StepForward(threshold=0.1), time=1)
    for own in (pickle.loads(pickle.dumps(layer)), copy.deepcopy(layer)):
        assert own._number != layer._number
        assert torch.equal(own(X), layer(X))
    assert repr(layer) == "Encode(StepForward(threshold=0.1), time=1)"
    with pytest.raises(ValueError, match="num_steps goes without time"):
        Encode(layer.scheme, 5, time=1)
    with pytest.raises(ValueError, match="gradient is 'straight'"):
        Encode(layer.scheme, gradient="through")


def test_two_workers_give_windows():
    recording, labels = np.random.default_rng(1).normal(size=(300, 6)).astype(np.float32), np.arange(300)
    windows = Windows(recording, labels, length=50, stride=25)
    batches = list(DataLoader(windows, batch_size=4, num_workers=2))
    assert [tuple(x.shape) for x, _ in batches] == [(4, 50, 6), (4, 50, 6), (3, 50, 6)]
    assert batches[1][1].tolist() == [149, 174, 199, 224]
    assert Encode(sw.StepForward(threshold=0.1), time=1)(batches[0][0]).shape == (50, 4, 6)
    with pytest.raises(ValueError, match="300 samples have 299 labels"):
        Windows(recording, labels[:-1], length=50)
    with pytest.raises(IndexError):
        windows[11]


def test_tiny_odin_is_the_chip():
    """Potentials, spikes and gradients are those of the example, whose networks `spikewire network` holds against the chip's model."""
    place = Path(__file__).parents[1] / "examples" / "on_chip.py"
    spec = importlib.util.spec_from_file_location("on_chip", place)
    chip = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(chip)
    random = np.random.default_rng(1)
    weights = [random.normal(1, 5, shape) for shape in ((chip.INPUTS, chip.HIDDEN), (chip.HIDDEN, chip.OUTPUTS))]
    inputs = random.integers(0, 2, (40, 8, chip.INPUTS)).astype(float)
    labels = random.integers(0, chip.OUTPUTS, (40, 8))
    network = TinyOdin(chip.INPUTS, chip.HIDDEN, chip.OUTPUTS, threshold=chip.THRESHOLD, leak=chip.LEAK).double()
    for own, wanted in zip(network.weights, weights):
        own.data = torch.from_numpy(wanted)
    layers = network.layers(torch.from_numpy(inputs))
    for own, wanted in zip(layers, chip.run(weights, inputs)):
        for tensor, array in zip(own, wanted):
            assert np.array_equal(tensor.detach().numpy(), array)
    (_, sent), (_, told) = layers
    assert 0 < sent.mean() < 1 and 0 < told.mean() < 1
    counts, count = [], 0
    for step in told:
        count = chip.FORGET * count + step
        counts.append(count)
    loss = torch.nn.functional.cross_entropy(torch.stack(counts).flatten(0, 1), torch.from_numpy(labels).flatten())
    (loss + 0.01 * sent.sum() / labels.size).backward()
    for own, wanted in zip(network.weights, chip.gradients(weights, inputs, labels)):
        assert np.allclose(own.grad.numpy(), wanted, rtol=1e-9, atol=1e-12)


def test_tiny_odin_is_saved(tmp_path):
    network = TinyOdin(2, 3)
    network.save(tmp_path / "chip.json")
    (layer,) = json.loads((tmp_path / "chip.json").read_text())["layers"]
    assert layer["weights"] == network.whole()[0].T.tolist()
    assert (layer["threshold"], layer["leak"]) == (15.5, 1)
    with pytest.raises(sw.Error, match="tinyODIN's"):
        sw.Network.from_nir(tmp_path / "chip.json")


@pytest.mark.skipif("SPIKEWIRE" not in os.environ, reason="needs the laptop program")
@pytest.mark.parametrize(
    ("made", "words"),
    [
        (lambda: TinyOdin(12, 16, 5), "--on tinyodin --compare step"),
        (lambda: ReckOn(12, 16, 5), "--on reckon"),
        (lambda: ReckOn(12, 16, 5).double(), "--on reckon"),
        (lambda: ReckOn(12, 17, 9, 5, recurrent=True, keep=0.9), "--on reckon"),
        (lambda: ReckOn(12, 16, 5, recurrent=True, subtract=True), "--on reckon --reset subtract-late"),
        (lambda: ReckOn(12, 3, shift=0, threshold=100, keep=1.0), "--on reckon"),
        (lambda: ReckOn(12, 16, 9, 5, keep=0.7), "--on reckon"),
        (lambda: ReckOn(12, 17, 9, 5, recurrent=True, readout=0.953), "--on reckon"),
        (lambda: ReckOn(12, 16, 5, recurrent=True, subtract=True, readout=0.5), "--on reckon --reset subtract-late"),
        (lambda: ReckOn(12, 15, 9, 7, 5, keep=0.874999, readout=0.8936), "--on reckon"),
        (lambda: ReckOn(12, 15, 3, keep=0.12, readout=0.3).double(), "--on reckon"),
        (lambda: ReckOn(12, 16, 3, threshold=64, shift=0, readout=1.0), "--on reckon"),
        (lambda: ReckOn(12, 16, 3, threshold=4096, shift=7, readout=0.3), "--on reckon"),
        (lambda: ReckOn(12, 240, 16, threshold=4096), "--on reckon"),
    ],
)
def test_chips_are_what_the_networks_are(made, words, tmp_path):
    torch.manual_seed(5)
    network = made()
    inputs = np.random.default_rng(1).integers(0, 2, (400, 12))
    outputs = network(torch.from_numpy(inputs)[:, None])[:, 0].detach().numpy()
    fires = network.readout is None
    trained = map(np.flatnonzero, outputs) if fires else outputs.tolist()
    for name, steps in (("inputs", map(np.flatnonzero, inputs)), ("outputs", trained)):
        (tmp_path / name).write_text("".join(" ".join(map(str, step)) + "\n" for step in steps))
    network.save(tmp_path / "chip.json")
    program = [os.environ["SPIKEWIRE"], "network", "chip.json", "inputs", *words.split(), "--no-held-out", "--json"]
    program += ["--trained-spikes" if fires else "--trained-potentials", "outputs", "-o", "chip.rs"]
    ran = subprocess.run(program, cwd=tmp_path, check=True, capture_output=True)
    (log,) = json.loads(ran.stdout)["logs"]
    tuned = log["tuned"]
    assert 0.01 < outputs.mean() < 0.98 if fires else outputs.std() > 100
    assert fires or tuned["potentials"]["error"] == 0
    assert (tuned["steps"], tuned["agreeing"], tuned["lost"]) == (400, 400, 0)


def test_reckon_learns():
    torch.manual_seed(1)
    network = ReckOn(6, 20, 2, recurrent=True)
    spikes = Encode(sw.StepForward(threshold=0.02), time=1, split=True)(X[..., :3])
    wanted = (X[..., :2].transpose(0, 1) > 0).float()
    optimizer = torch.optim.Adam(network.parameters(), 1.0)
    losses = []
    for _ in range(60):
        rate = torch.stack(network(spikes).split(10)).mean(1)
        loss = (rate - torch.stack(wanted.split(10)).mean(1)).square().mean()
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        losses.append(loss.item())
    assert losses[-1] < losses[0] / 2
    with pytest.raises(ValueError, match="counts of spikes"):
        network(-spikes)


def test_reckon_learns_by_its_outputs():
    torch.manual_seed(1)
    network = ReckOn(6, 20, 2, keep=0.8, readout=0.7932)
    spikes = Encode(sw.StepForward(threshold=0.02), time=1, split=True)(X[..., :3])
    wanted = torch.stack([X[..., 0].T, -X[..., 1].T], -1)
    optimizer = torch.optim.Adam(network.parameters(), 0.5)
    losses = []
    for _ in range(60):
        loss = (network(spikes) / 1024 - wanted).square().mean()
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        losses.append(loss.item())
    assert losses[-1] < min(losses[0], wanted.square().mean()) / 2
    assert all(own.grad.abs().sum() > 0 for own in network.parameters())


@pytest.mark.parametrize(
    ("made", "words"),
    [
        (lambda: ReckOn(2, 2, keep=0.8, recurrent=True), "0.875 to 1"),
        (lambda: ReckOn(2, 2, keep=0.1), "0.1181 to 1"),
        (lambda: ReckOn(2, 2, readout=0.9), "follows another"),
        (lambda: ReckOn(2, 2, readout=0), "above 0 up to 1, not 0"),
        (lambda: ReckOn(2, 2, 2, readout=True), "above 0 up to 1, not True"),
        (lambda: ReckOn(2, 2, 2, keep=0.6, readout=0.99), "0.9691 or 1 of the outputs' potentials, not 0.99"),
        (lambda: ReckOn(2, 2, 2, readout=0.95), "0.9453 or 0.9531 of the"),
        (lambda: ReckOn(2, 2, 2, 2, 2), "1 to 3 layers fire, not 4"),
        (lambda: TinyOdin(2), "1 to 3 layers fire, not 0"),
        (lambda: ReckOn(2, 255, 1), "256 neurons that fire, not 257"),
        (lambda: ReckOn(2, 257, 1, readout=0.5), "256 neurons that fire, not 257"),
        (lambda: ReckOn(257, 2), "256 inputs, not 257"),
        (lambda: ReckOn(2, 2, 17, readout=0.5), "16 outputs, not 17"),
        (lambda: ReckOn(2, 2, shift=9), "0 to 7 bits, not 9"),
        (lambda: ReckOn(2, 2, threshold=50000), "1 to 32767, not 50000"),
        (lambda: TinyOdin(2, 2, threshold=2048), "1 to 2047, not 2048"),
        (lambda: Controller(2, 2, reset="subtracts"), "to-value, .*, none, not 'subtracts'"),
        (lambda: Controller(2, 2, keep=1.5), "keep is a share from 0 to 1, not 1.5"),
        (lambda: Controller(2, 2, keep=float("nan")), "keep is a share from 0 to 1, not nan"),
    ],
)
def test_wrong_arguments_are_named(made, words):
    with pytest.raises(ValueError, match=words):
        made()


@pytest.mark.parametrize("keep", [1.0, 0.95, 0.875, 0.6, 0.1181])
def test_shares_of_reckon_are_those_asked_for(keep):
    network = ReckOn(2, 2, 2, keep=keep)
    assert network.readout is None
    assert abs(network.keep - keep) < 1e-4
    taken = 0
    for readout in np.linspace(0, 1, 500)[1:]:
        try:
            own = ReckOn(2, 2, 2, keep=keep, readout=readout).readout
        except ValueError as error:
            # Those that the error names are taken.
            near = [float(word) for word in str(error).split() if word[0] in "01"]
            assert near[0] < readout < near[1] or readout < near[0] < 0.01
            assert all(ReckOn(2, 2, 2, keep=keep, readout=share).readout for share in near[:2])
        else:
            taken += 1
            assert abs(own - readout) <= 0.02 * (1 - readout)
    assert taken > 100


def test_what_the_chip_leaves_is_only_read_and_layers_have_neurons():
    network = ReckOn(2, 2, 2, readout=0.9)
    for name in ("keep", "readout"):
        with pytest.raises(AttributeError):
            setattr(network, name, 0.5)
    for made in (lambda: ReckOn(2, 0, 3), lambda: ReckOn(2, 3, -1), lambda: TinyOdin(0, 3)):
        with pytest.raises(ValueError, match="1 neuron or more"):
            made()


def test_a_diverged_network_is_named():
    network = Controller(2, 2)
    with torch.no_grad():
        network.neurons[0].bias[1] = float("nan")
    with pytest.raises(ValueError, match="neurons.0.bias is not finite: training has diverged"):
        network.network()


RESETS = ["to-value", "to-value-late", "to-value-held", "subtract", "subtract-late", "subtract-no-delay", "none"]


def are_the_same(controller, network, counts):
    """Spikes and potentials of each recording are the network's, bit for bit."""
    fires = "reset" in controller.neurons[-1].rule
    layers = [[own.detach().numpy() for own in pair] for pair in controller.layers(torch.from_numpy(counts))]
    for recording in range(counts.shape[1]):
        ran = network.run(counts[:, recording])
        potentials, fired = (own[:, recording] for own in layers[-1])
        assert np.array_equal(fired > 0, ran.spikes)
        assert np.array_equal(potentials, ran.potentials)
        network.reset()
        for at, step in enumerate(counts[:, recording]):
            network.step(step)
            assert network.fired == [np.flatnonzero(own[at, recording]).tolist() for _, own in layers]
    return fires and 0 < layers[-1][1].mean() < 1


@pytest.mark.parametrize("reset", RESETS)
@pytest.mark.parametrize("at", [False, True])
@pytest.mark.parametrize("current_keep", [None, 0.7])
def test_controller_is_the_network(reset, at, current_keep):
    torch.manual_seed(1)
    options = dict(keep=0.8, reset=reset, at=at, current_keep=current_keep, recurrent=True)
    counts = np.random.default_rng(1).integers(0, 3, (60, 3, 5)).astype(np.float32)
    for readout in (False, True):
        controller = Controller(5, 9, 4, readout=readout, **options)
        with torch.no_grad():
            # Halves let potentials meet thresholds.
            for name, own in controller.named_parameters():
                own.copy_(torch.randn_like(own) if "bias" in name else (2 * own).round() / 2)
        network = controller.network()
        assert are_the_same(controller, network, counts) != readout
        for again in (sw.Network.from_toml(network.to_toml()), Controller.from_network(network).network()):
            assert again.to_toml() == network.to_toml()


@pytest.mark.parametrize("reset", RESETS)
@pytest.mark.parametrize("at", [False, True])
@pytest.mark.parametrize("current_keep", [None, 0.7])
def test_integers_are_those_of_the_controller(reset, at, current_keep):
    torch.manual_seed(1)
    options = dict(keep=0.8, reset=reset, at=at, current_keep=current_keep, recurrent=True, numbers="i8")
    counts = np.random.default_rng(1).integers(0, 3, (60, 3, 5)).astype(np.float32)
    for readout in (False, True):
        controller = Controller(5, 9, 4, readout=readout, **options)
        with torch.no_grad():
            for layer in controller.neurons:
                layer.bias += torch.randn_like(layer.bias) / 4
        out = controller(torch.from_numpy(counts))
        out.square().sum().backward()
        assert all(own.grad.abs().sum() > 0 for own in controller.parameters())
        network = controller.network()
        for recording in range(3):
            ran = network.run(counts[:, recording], numbers="i8")
            mine = out.detach().numpy()[:, recording]
            # An integer is 1e-5 or more.
            assert np.abs(mine - (ran.potentials if readout else ran.spikes)).max() < 3e-6
        assert Controller.from_network(network, "i8").network().to_rust(counts[:, 0], numbers="i8") == network.to_rust(
            counts[:, 0], numbers="i8"
        )


@pytest.mark.parametrize(
    ("name", "framework", "rule"),
    [
        ("braille_bias_zero", "snntorch", {"reset": "to-value"}),
        ("norse_cell", "norse", {"current": "whole", "dt": 1e-3}),
        ("spikingjelly_cuba", "spikingjelly", {}),
    ],
)
def test_controller_takes_networks_of_frameworks(name, framework, rule):
    place = Path(__file__).parents[3] / "laptop/cli/tests/peers/nir" / f"{name}.nir"
    network = sw.Network.from_nir(place, framework, **rule)
    counts = np.random.default_rng(1).poisson(0.3, (200, 2, network.inputs)).astype(np.float32)
    controller = Controller.from_network(network)
    assert are_the_same(controller, network, counts) == ("reset" in controller.neurons[-1].rule)


def test_controller_learns():
    torch.manual_seed(1)
    network = Controller(6, 20, 2, current_keep=0.5, recurrent=True, readout=True)
    spikes = Encode(sw.StepForward(threshold=0.02), time=1, split=True)(X[..., :3])
    wanted = torch.stack([X[..., 0].T, -X[..., 1].T], -1)
    optimizer = torch.optim.Adam(network.parameters(), 0.02)
    losses = []
    for _ in range(60):
        loss = (network(spikes) - wanted).square().mean()
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        losses.append(loss.item())
    assert losses[-1] < losses[0] / 3
    assert all(own.grad.abs().sum() > 0 for own in network.parameters())
    assert not are_the_same(network, network.network(), spikes.numpy())
    with pytest.raises(ValueError, match="counts of spikes"):
        network(-spikes)


def spiking(layer):
    """Weights with which a layer fires now and then."""
    torch.nn.init.uniform_(layer.weight, -0.5, 1.5)
    return layer


class Trained(torch.nn.Module):
    """A network as snnTorch's tutorials write it: layers as attributes, time in `forward`."""

    def __init__(self, first, second):
        super().__init__()
        self.fc1, self.lif1 = spiking(torch.nn.Linear(6, 12)), first
        self.norm, self.dropout = torch.nn.BatchNorm1d(12), torch.nn.Dropout(0.2)
        self.fc2, self.lif2 = spiking(torch.nn.Linear(12, 3)), second
        with torch.no_grad():
            self.norm.running_mean.uniform_(-0.2, 0.2)
            self.norm.running_var.uniform_(0.5, 2)
            self.norm.weight.uniform_(0.5, 2)

    def forward(self, x):
        mem1, mem2, spikes = self.lif1.reset_mem(), self.lif2.reset_mem(), []
        for step in x:
            fired, mem1 = self.lif1(self.norm(self.fc1(step)), mem1)
            fired, mem2 = self.lif2(self.fc2(self.dropout(fired)), mem2)
            spikes.append(fired)
        return torch.stack(spikes)


def snn_trained(**reset):
    snn = pytest.importorskip("snntorch")
    return Trained(snn.Leaky(beta=0.9, **reset), snn.Leaky(beta=torch.rand(3), threshold=torch.rand(3) + 0.5, **reset))


def snn_chain(*layers):
    return torch.nn.Sequential(*layers)


def snn_synaptic():
    snn = pytest.importorskip("snntorch")
    first, second = snn.Synaptic(alpha=0.5, beta=0.8, init_hidden=True), snn.Leaky(beta=0.7, init_hidden=True)
    return snn_chain(spiking(torch.nn.Linear(6, 12)), first, spiking(torch.nn.Linear(12, 3)), second)


def snn_recurrent(**connected):
    snn = pytest.importorskip("snntorch")
    first = snn.RLeaky(beta=0.5, init_hidden=True, **connected)
    # Linear after Linear becomes one layer.
    last = torch.nn.Linear(12, 5), spiking(torch.nn.Linear(5, 3)), snn.Leaky(beta=0.7, init_hidden=True)
    return snn_chain(spiking(torch.nn.Linear(6, 12)), first, *last)


def norse_chain(name, **parameters):
    norse = pytest.importorskip("norse.torch")
    kinds = {
        "box": (norse.LIFBoxCell, norse.LIFBoxParameters),
        "cell": (norse.LIFCell, norse.LIFParameters),
        "whole": (norse.LIF, norse.LIFParameters),
    }
    cell, of = kinds[name]
    own = of(**{key: torch.tensor(value) for key, value in parameters.items()})
    first, second = spiking(torch.nn.Linear(6, 10)), spiking(torch.nn.Linear(10, 3))
    return norse.SequentialState(first, cell(own), second, cell(own))


def norse_readout():
    norse = pytest.importorskip("norse.torch")
    own = norse.LIFParameters(v_th=torch.tensor(0.02), v_leak=torch.tensor(0.01))
    return norse.SequentialState(norse.LIFRecurrentCell(6, 10, own), torch.nn.Linear(10, 3), norse.LICell())


def jelly(mode, *nodes):
    neuron = pytest.importorskip("spikingjelly.activation_based.neuron")
    layer = pytest.importorskip("spikingjelly.activation_based.layer")
    layers = [layer.Linear(6, 10), nodes[0](neuron), layer.Dropout(0.1), layer.Linear(10, 3), nodes[1](neuron)]
    spiking(layers[0]), spiking(layers[3])
    pytest.importorskip("spikingjelly.activation_based.functional").set_step_mode(chain := snn_chain(*layers), mode)
    return chain


@pytest.mark.parametrize(
    ("made", "resets"),
    [
        (lambda: snn_trained(), "subtract-late"),
        (lambda: snn_trained(reset_delay=False), "subtract-no-delay"),
        (lambda: snn_trained(reset_mechanism="zero"), "to-value-late"),
        (lambda: snn_trained(reset_mechanism="zero", reset_delay=False), "to-value"),
        (lambda: snn_trained(reset_mechanism="none"), "none"),
        (lambda: snn_synaptic(), "subtract-late"),
        (lambda: snn_recurrent(linear_features=12), "subtract-late"),
        (lambda: snn_recurrent(V=torch.rand(12), all_to_all=False), "subtract-late"),
        (lambda: norse_chain("box", tau_mem_inv=300.0, v_th=0.4), "to-value"),
        (lambda: norse_chain("cell", v_th=0.5, v_leak=0.05), "to-value"),
        (lambda: norse_chain("whole", v_th=0.5), "to-value"),
        (lambda: norse_readout(), "to-value"),
        (lambda: jelly("s", lambda neuron: neuron.LIFNode(tau=2.0), lambda neuron: neuron.IFNode()), "to-value"),
        (lambda: jelly("m", lambda neuron: neuron.LIFNode(tau=2.0), lambda neuron: neuron.IFNode()), "to-value"),
        (
            lambda: jelly(
                "s",
                lambda neuron: neuron.ParametricLIFNode(v_reset=None),
                lambda neuron: neuron.LIFNode(tau=3.0, decay_input=False, v_reset=None),
            ),
            "subtract",
        ),
    ],
)
def test_modules_become_networks(made, resets):
    """Every layer fires as the module's did, and so does the network as a whole, from its file too."""
    torch.manual_seed(3)
    module, sample = made(), torch.rand(200, 6) < 0.4
    network = sw.Network.from_torch(module, sample)
    layers = tomllib.loads(network.to_toml())["layers"]
    assert {layer.get("reset", resets) for layer in layers} == {resets}
    ran = network.run(sample.numpy())
    again = sw.Network.from_toml(network.to_toml()).run(sample.numpy())
    assert np.array_equal(ran.potentials, again.potentials)
    # The module's own outputs, by its own loop.
    module.eval()
    with torch.no_grad():
        last = _from_torch.run(module, sample.float())[-1]
    outputs = _from_torch.rows(last.outputs)
    if "reset" in layers[-1]:
        assert outputs.any()
        assert np.array_equal(ran.spikes, outputs)
    else:
        assert np.allclose(ran.potentials, outputs, atol=1e-4 * abs(outputs).max())


def test_modules_that_are_no_chains_are_refused():
    snn = pytest.importorskip("snntorch")

    class Skip(torch.nn.Module):
        def __init__(self):
            super().__init__()
            self.first, self.second = snn.Leaky(beta=0.9, init_hidden=True), snn.Leaky(beta=0.9, init_hidden=True)

        def forward(self, x):
            return self.second(self.first(x) + x)

    sample = np.ones((20, 6))
    never = snn.Leaky(beta=0.5, threshold=100.0, init_hidden=True)
    graded = snn.Leaky(beta=0.5, graded_spikes_factor=2.0, init_hidden=True)
    lateral = snn.Leaky(beta=0.5, inhibition=True, init_hidden=True)
    for module, asked, words in [
        (Skip(), sample, "second: .* only chains"),
        (snn_chain(torch.nn.Conv1d(1, 2, 3), never), sample, "Conv1d is not read"),
        (snn_chain(torch.nn.Linear(6, 2), never), sample, "1: it never fires"),
        (snn_chain(torch.nn.Linear(6, 2), graded), sample, "graded"),
        (snn_chain(torch.nn.Linear(6, 2), lateral), sample, "inhibition"),
        (snn_chain(torch.nn.Linear(5, 2), never), sample, "neither all steps"),
        (torch.nn.ReLU(), sample, "ReLU is not read"),
        (snn_chain(torch.nn.Linear(6, 2), never), sample * 0.5, "takes? values|counts of spikes"),
        (snn_chain(torch.nn.Linear(6, 2), never), sample[None], r"\(steps, inputs\)"),
        (snn_chain(torch.nn.Linear(6, 2), never), sample[:1], "2 or more"),
    ]:
        with pytest.raises(sw.Error, match=words):
            sw.Network.from_torch(module, asked)


def test_a_rule_that_the_module_does_not_keep_is_found():
    """snnTorch says one rule, and a subclass does another: the spikes decide."""
    snn = pytest.importorskip("snntorch")
    torch.manual_seed(3)
    layer = snn.Leaky(beta=0.9, init_hidden=True)
    module = snn_chain(spiking(torch.nn.Linear(6, 12)), layer)
    sample = torch.rand(200, 6) < 0.4
    layer.reset_mechanism = "none"  # after the layer was made, this only changes what it says
    assert 'reset = "subtract-late"' in sw.Network.from_torch(module, sample).to_toml()
