"""Networks of three frameworks against what these gave, and what is refused."""

import importlib.util
import re
from pathlib import Path

import numpy as np
import pytest

import spikewire as sw

PEERS = Path(__file__).parents[3] / "laptop/cli/tests/peers/nir"


def unnamed(rust):
    return re.sub("node `.*?`: (a neuron|weights)", r"\1", rust)


def steps(name):
    return [[int(word) for word in line.split()] for line in (PEERS / name).read_text().splitlines()]


@pytest.mark.parametrize(
    ("name", "reset"),
    [("braille_subtract", "subtract-no-delay"), ("braille_bias_zero", "to-value")],
)
def test_published_networks_fire_as_snntorch_published(name, reset):
    network = sw.Network.from_nir(PEERS / f"{name}.nir", "snntorch", reset=reset)
    fired = []
    for step in steps("braille.txt"):
        network.step(step)
        fired.append(network.fired[0])
    assert fired == steps(f"{name}.spikes.txt")
    assert sum(map(len, fired)) > 100


def test_counts_lists_and_single_steps_are_the_same():
    network = sw.Network.from_nir(PEERS / "braille_subtract.nir", "snntorch", reset="subtract-no-delay")
    lists = steps("braille.txt")
    counts = np.array([np.bincount(step, minlength=network.inputs) for step in lists])
    ran = network.run(counts)
    assert np.array_equal(ran.potentials, network.run([sorted(step) for step in lists]).potentials)
    network.reset()
    singly = np.array([network.step(row) for row in counts])
    assert np.array_equal(singly, ran.potentials)
    assert network.fired[-1] == np.flatnonzero(ran.spikes[-1]).tolist()


def test_what_a_file_leaves_open_is_asked_for():
    path = PEERS / "braille_subtract.nir"
    with pytest.raises(ValueError, match="subtract-late"):
        sw.Network.from_nir(path, "snntorch")
    with pytest.raises(ValueError, match="framework \"torch\" must be one of `snntorch`"):
        sw.Network.from_nir(path, "torch")
    network = sw.Network.from_nir(path, "snntorch", reset="subtract-late")
    with pytest.raises(ValueError, match="input 12: the network has inputs 0 to 11"):
        network.step([12])
    with pytest.raises(ValueError, match="12 counts"):
        network.step(np.ones(3))


RULES = [
    ("braille_subtract", "snntorch", {"reset": "subtract-no-delay"}),
    ("snntorch_recurrent", "snntorch", {"reset": ["subtract-late", "subtract-no-delay"]}),
    ("snntorch_one_to_one", "snntorch", {"reset": "none"}),
    ("norse_cell", "norse", {"current": "whole", "dt": 1e-3}),
    ("norse_if", "norse", {"dt": 1e-3}),
    ("spikingjelly", "spikingjelly", {"reset": "subtract"}),
    ("spikingjelly_cuba", "spikingjelly", {}),
]


@pytest.mark.parametrize(("name", "framework", "rule"), RULES)
def test_files_bring_the_network_back(name, framework, rule, tmp_path):
    network = sw.Network.from_nir(PEERS / f"{name}.nir", framework, **rule)
    counts = np.random.default_rng(1).poisson(0.4, (300, network.inputs))
    (tmp_path / "own.toml").write_text(network.to_toml())
    own = [sw.Network.from_toml(network.to_toml()), sw.Network.from_nir(tmp_path / "own.toml")]
    with pytest.raises(sw.Error, match="holds the rule"):
        sw.Network.from_nir(tmp_path / "own.toml", framework)
    if importlib.util.find_spec("nir"):
        keywords = network.to_nir(tmp_path / "own.nir")
        own.append(sw.Network.from_nir(tmp_path / "own.nir", **keywords))
    for again in own:
        for one, other in zip(again.run(counts), network.run(counts)):
            assert np.array_equal(one, other)
        # A graph's nodes have names of their own.
        assert unnamed(again.to_rust(counts)) == unnamed(network.to_rust(counts))
    assert "pub fn is_intact() -> bool" in network.to_rust(counts, numbers="i8", source="own.toml")


LAYERS = """[[layers]]
name = "one"
reset = "to-value"
fires = "at"
keep = [0.9, 0.9]
threshold = [1.0, 1.0]
weights = [[0.5, 1.0], [0.5, 0.25]]
"""
#: The lines on how neurons fire and leak.
FIRING = LAYERS[LAYERS.index("reset") : LAYERS.index("weights")]
#: A layer that never fires, before another.
SILENT = """[[layers]]
name = "silent"
keep = [0.9, 0.9]
weights = [[0.5, 1.0], [0.5, 0.25]]

[[layers]]"""


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("keep = [", "keep = [2.0, "), "3 values of `keep` for 2 neurons"),
        (("threshold = [1.0, 1.0]", ""), "`threshold`, `reset` and `fires` go together"),
        (("keep = [0.9", "keep = [1.5"), "neuron 0 keeps 1.5"),
        (("[[layers]]", "[[layer]]"), "no network in TOML"),
        (("[0.5, 0.25]", "[0.5]"), "neuron 1 has 1 weights where the first has 2"),
        (("weights", "inner = [0.1, 0.1]\nweights"), "`inner` the second"),
        ((FIRING, "keep = [0.9, 0.9]\nreset_value = [0.1, 0.1]\n"), "`reset_value` and `recurrent` need the first"),
        ((FIRING, "keep = [0.9, 0.9]\nrecurrent = [[0.0, 0.1], [0.1, 0.0]]\n"), "`reset_value` and `recurrent` need the first"),
        (("[[layers]]", SILENT), "neurons that never fire must be the last"),
    ],
)
def test_a_wrong_file_is_told(change, words):
    assert sw.Network.from_toml(LAYERS).to_toml() == LAYERS
    with pytest.raises(sw.Error, match=re.escape(words)):
        sw.Network.from_toml(LAYERS.replace(*change))


def test_a_graph_cannot_subtract_another_amount_than_the_threshold(tmp_path):
    pytest.importorskip("nir")
    network = sw.Network.from_toml(LAYERS.replace("to-value", "subtract") + "reset_value = [1.0, 0.5]\n")
    with pytest.raises(ValueError, match="one: a spike subtracts the threshold in a graph"):
        network.to_nir(tmp_path / "own.nir")


@pytest.mark.parametrize("numbers", ["f32", "i8"])
def test_a_recording_without_steps_is_refused(numbers):
    with pytest.raises(ValueError, match="no steps"):
        sw.Network.from_toml(LAYERS).to_rust([], numbers=numbers)


def test_recorded_spikes_show_the_rule():
    """snnTorch's files are the same for all resets; the spikes that it fired are not."""

    def column(steps, at, count):
        numbers = [[int(word) for word in step[at].split()] for step in steps]
        return np.array([np.bincount(step, minlength=count) for step in numbers])

    for reset in ("none", "subtract-late", "to-value-late", "subtract-no-delay", "to-value"):
        steps = [line.split(";") for line in (PEERS / f"snntorch.{reset}.txt").read_text().splitlines()]
        sample, spikes = column(steps, 0, 6), column(steps, 2, 2)
        if reset == "none":  # an output that once fires goes on, whatever the decay
            with pytest.raises(sw.Error, match="2 rules give the recorded outputs"):
                sw.Network.from_nir(PEERS / "snntorch.nir", sample=sample, spikes=spikes)
            continue
        network = sw.Network.from_nir(PEERS / "snntorch.nir", sample=sample, spikes=spikes)
        # Set at once or a step late, a potential is the same when the next inputs arrive.
        found = "to-value" if reset == "to-value-late" else reset
        assert f'reset = "{found}"' in network.to_toml()
        assert np.array_equal(network.run(sample).spikes, spikes)
    with pytest.raises(sw.Error, match="gives all of them by"):
        sw.Network.from_nir(PEERS / "snntorch.nir", "snntorch", reset="subtract", sample=sample, spikes=spikes)
    with pytest.raises(sw.Error, match="go together"):
        sw.Network.from_nir(PEERS / "snntorch.nir", sample=sample)
