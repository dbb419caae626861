"""Writes small networks as snnTorch, Norse and SpikingJelly export them, and 200 steps of what each does by itself.

    frameworks.py DIRECTORY

NAME.nir is the network, NAME.RESET.txt a step a line: the inputs that fire, the hidden neurons, the outputs; and the
outputs' potentials behind the step.

Norse and SpikingJelly cannot export recurrent layers: their exporters write the neurons, and `joined` adds the weights.
SpikingJelly refuses to export a reset by subtraction: the file has that of the same neurons with a value.

Needs snntorch 1.0.0, norse 1.1.0 and spikingjelly 2.0.0; the files of tests/peers/nir were written with torch 2.15.
Spikes are the same on every machine; the last digits of potentials are not, as torch adds in another order.
"""

import sys
from pathlib import Path

import nir
import norse.torch as norse
import numpy as np
import snntorch as snn
import torch
from norse.torch.functional.lif import LIFState
from norse.torch.functional.reset import reset_subtract, reset_value
from norse.torch.utils.export_nir import to_nir
from snntorch.export_nir import export_to_nir
from spikingjelly.activation_based import layer, neuron, nir_exchange
from torch import nn

INPUTS, HIDDEN, OUTPUTS, STEPS = 6, 10, 2, 200


def inputs():
    noise = np.random.default_rng(5)
    return (noise.random((STEPS, INPUTS)) < 0.3).astype("f4")


def linear(seed, inputs, outputs, bias=True):
    noise = np.random.default_rng(seed)
    layer = nn.Linear(inputs, outputs, bias=bias)
    layer.weight.data = torch.tensor(noise.normal(0.2, 0.6, (outputs, inputs)), dtype=torch.float)
    if bias:
        layer.bias.data = torch.tensor(noise.normal(0, 0.05, outputs), dtype=torch.float)
    return layer


def some(seed, count, least, most):
    return torch.tensor(np.random.default_rng(seed).uniform(least, most, count), dtype=torch.float)


def write(path, steps):
    lines = []
    for fired, hidden, out, v in steps:
        trains = [" ".join(str(at) for at in np.flatnonzero(np.asarray(one))) for one in (fired, hidden, out)]
        lines.append(";".join([*trains, " ".join(str(np.float32(one)) for one in v)]))
    path.write_text("\n".join(lines) + "\n")


RESETS = {
    "subtract-late": dict(reset_mechanism="subtract", reset_delay=True),
    "to-value-late": dict(reset_mechanism="zero", reset_delay=True),
    "subtract-no-delay": dict(reset_mechanism="subtract", reset_delay=False),
    "to-value": dict(reset_mechanism="zero", reset_delay=False),
    "none": dict(reset_mechanism="none"),
}


def snntorch(place, name):
    """Leaky; RSynaptic with a weight from each neuron to each; RLeaky with a weight from each neuron to itself."""
    beta, beta_out = some(1, HIDDEN, 0.6, 0.95), some(2, OUTPUTS, 0.6, 0.95)
    alpha, alpha_out = some(3, HIDDEN, 0.3, 0.8), some(4, OUTPUTS, 0.3, 0.8)
    ones, ones_out = torch.ones(HIDDEN), torch.ones(OUTPUTS)
    first, second = linear(11, INPUTS, HIDDEN), linear(12, HIDDEN, OUTPUTS)
    is_synaptic, is_recurrent = name == "snntorch_recurrent", name != "snntorch"

    def neurons(**options):
        if is_synaptic:
            one = snn.RSynaptic(alpha, beta, all_to_all=True, linear_features=HIDDEN, threshold=ones, **options)
            one.recurrent = linear(9, HIDDEN, HIDDEN)
            one.recurrent.weight.data *= 0.4
            return one, snn.Synaptic(alpha_out, beta_out, threshold=ones_out, **options)
        two = snn.Leaky(beta_out, threshold=ones_out, **options)
        if is_recurrent:
            return snn.RLeaky(beta, V=some(10, HIDDEN, -0.5, 0.5), all_to_all=False, threshold=ones, **options), two
        return snn.Leaky(beta, threshold=ones, **options), two

    # The exporter takes neurons that hold their state; the file is the same for every reset.
    one, two = neurons(init_hidden=True)
    nir.write(place / f"{name}.nir", export_to_nir(nn.Sequential(first, one, second, two), torch.zeros(INPUTS)))
    for reset, options in RESETS.items():
        one, two = neurons(**options)
        states = 2 if is_synaptic else 1
        state_one, state_two = [torch.zeros(HIDDEN)] * states, [torch.zeros(OUTPUTS)] * states
        steps, spike = [], torch.zeros(HIDDEN)
        for fired in inputs():
            before = (spike,) if is_recurrent else ()
            spike, *state_one = one(first(torch.tensor(fired)), *before, *state_one)
            out, *state_two = two(second(spike), *state_two)
            steps.append((fired, spike.detach(), out.detach(), state_two[-1].detach().numpy()))
        write(place / f"{name}.{reset}.txt", steps)


def joined(graph, neurons, weights):
    """Adds recurrent weights to a graph, which the exporter cannot."""
    graph.nodes["w_rec"] = nir.Linear(weights.detach().numpy())
    graph.edges += [(neurons, "w_rec"), ("w_rec", neurons)]
    return graph


def spikingjelly(place, name, v_reset=0.0):
    def neurons(v_reset):
        if name == "spikingjelly_cuba":
            one = neuron.CUBALIFNode(v_threshold=1.0, v_reset=0.0)
            return one, neuron.LIFNode(tau=4.0, decay_input=True, v_threshold=0.5, v_reset=-0.25)
        if name == "spikingjelly_recurrent":
            one = neuron.LIFNode(tau=3.0, decay_input=False, v_threshold=1.0, v_reset=v_reset)
        else:
            one = neuron.IFNode(v_threshold=4.0, v_reset=v_reset)
        return one, neuron.LIFNode(tau=3.0, decay_input=False, v_threshold=1.0, v_reset=v_reset)

    is_recurrent = name == "spikingjelly_recurrent"
    hidden = INPUTS if is_recurrent else HIDDEN
    first, second = linear(21, INPUTS, hidden, bias=False), linear(22, hidden, OUTPUTS)
    if name == "spikingjelly":
        # Whole weights: an integrator often stands at its threshold.
        first.weight.data = torch.round(first.weight.data * 3)
    one, two = neurons(0.0)
    graph = nir_exchange.export_to_nir(nn.Sequential(first, one, second, two), torch.zeros(1, INPUTS))
    one, two = neurons(v_reset)
    if is_recurrent:
        back = linear(23, hidden, hidden, bias=False).weight.data * 0.4
        graph = joined(graph, "_1", back)
        one = layer.LinearRecurrentContainer(one, in_features=hidden, out_features=hidden, bias=False)
        one.rc.weight.data = torch.cat((first.weight.data, back), dim=1)
        first = nn.Identity()
    nir.write(place / f"{name}.nir", graph)
    steps = []
    for fired in inputs():
        spike = one(first(torch.tensor(fired[None])))
        out = two(second(spike))
        steps.append((fired, spike[0].detach(), out[0].detach(), two.v[0].detach().numpy()))
    write(place / f"{name}.{'to-value' if v_reset is not None else 'subtract'}.txt", steps)


def of_norse(place, name, reset=reset_value):
    first, second = linear(31, INPUTS, HIDDEN), linear(32, HIDDEN, OUTPUTS)
    first.weight.data *= 3
    tau_mem, tau_syn = some(33, HIDDEN, 90, 300), some(34, HIDDEN, 100, 400)
    tau_out, zeros, v_th = some(35, OUTPUTS, 20, 80), torch.zeros(HIDDEN), 0.4 * torch.ones(HIDDEN)
    p = norse.LIFParameters(tau_mem_inv=tau_mem, tau_syn_inv=tau_syn, v_th=v_th, v_leak=zeros, v_reset=zeros)
    if name == "norse":
        box = norse.LIFBoxParameters(
            tau_mem_inv=tau_mem, v_th=v_th, v_leak=0.1 * torch.ones(HIDDEN), v_reset=zeros, reset_method=reset)
        one = norse.LIFBoxCell(p=box, dt=0.001)
    elif name == "norse_if":
        one = norse.IAFCell(p=norse.IAFParameters(v_th=torch.ones(HIDDEN), v_reset=zeros), dt=0.001)
    else:
        one = norse.LIFCell(p=p, dt=0.001)
    two = norse.LIBoxCell(p=norse.LIBoxParameters(tau_mem_inv=tau_out, v_leak=torch.zeros(OUTPUTS)), dt=0.001)
    if name == "norse_recurrent":
        first.bias.data *= 0
    # With a dt of 1 its time constants are right.
    graph = to_nir(norse.SequentialState(first, one, second, two), torch.zeros(INPUTS), dt=1)
    if name == "norse_recurrent":
        one = norse.LIFRecurrentCell(
            INPUTS, HIDDEN, p=p, dt=0.001, input_weights=first.weight.data,
            recurrent_weights=linear(36, HIDDEN, HIDDEN, bias=False).weight.data - 0.5)
        graph = joined(graph, "1", one.recurrent_weights)
        first = nn.Identity()
    nir.write(place / f"{name}.nir", graph)
    steps, state_one, state_two = [], LIFState(zeros, zeros, zeros) if name == "norse_recurrent" else None, None
    for fired in inputs():
        spike, state_one = one(first(torch.tensor(fired)), state_one)
        out, state_two = two(second(spike), state_two)
        steps.append((fired, spike.detach(), np.zeros(OUTPUTS), out.detach().numpy()))
    write(place / f"{name}.{'to-value' if reset is reset_value else 'subtract'}.txt", steps)


def main():
    place = Path(sys.argv[1])
    place.mkdir(exist_ok=True)
    torch.manual_seed(1)
    for name in ("snntorch", "snntorch_recurrent", "snntorch_one_to_one"):
        snntorch(place, name)
    for name in ("spikingjelly", "spikingjelly_cuba", "spikingjelly_recurrent"):
        spikingjelly(place, name)
    for name in ("spikingjelly", "spikingjelly_recurrent"):
        spikingjelly(place, name, v_reset=None)
    for name in ("norse", "norse_cell", "norse_if", "norse_recurrent"):
        of_norse(place, name)
    of_norse(place, "norse", reset_subtract)


if __name__ == "__main__":
    main()
