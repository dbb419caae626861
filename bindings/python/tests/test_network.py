"""Networks of three frameworks against what these gave, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

import spikewire as sw

PEERS = Path(__file__).parents[3] / "laptop/cli/tests/peers/nir"


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
    with pytest.raises(ValueError, match="framework \"torch\" must be one of snntorch"):
        sw.Network.from_nir(path, "torch")
    network = sw.Network.from_nir(path, "snntorch", reset="subtract-late")
    with pytest.raises(ValueError, match="input 12: the network has inputs 0 to 11"):
        network.step([12])
    with pytest.raises(ValueError, match="12 counts"):
        network.step(np.ones(3))
