"""Writes small networks as snnTorch, Norse and SpikingJelly export them, and 200 steps of what each does by itself.

    frameworks.py DIRECTORY

NAME.nir is the network, NAME.RESET.txt a step a line: the inputs that fire, the hidden neurons, the outputs; and the
outputs' potentials behind the step.

Needs snntorch 1.0.0, norse 1.1.0 and spikingjelly 2.0.0; the files of tests/peers/nir were written with torch 2.15.
"""

import sys
from pathlib import Path

import nir
import norse.torch as norse
import numpy as np
import snntorch as snn
import torch
from norse.torch.utils.export_nir import to_nir
from snntorch.export_nir import export_to_nir
from spikingjelly.activation_based import neuron, nir_exchange
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
}


def snntorch(place, recurrent):
    name = "snntorch_recurrent" if recurrent else "snntorch"
    for reset, options in RESETS.items():
        beta, beta_out = some(1, HIDDEN, 0.6, 0.95), some(2, OUTPUTS, 0.6, 0.95)
        ones, ones_out = torch.ones(HIDDEN), torch.ones(OUTPUTS)
        if recurrent:
            alpha, alpha_out = some(3, HIDDEN, 0.3, 0.8), some(4, OUTPUTS, 0.3, 0.8)
            one = snn.RSynaptic(alpha, beta, all_to_all=True, linear_features=HIDDEN, threshold=ones, **options)
            one.recurrent = linear(9, HIDDEN, HIDDEN)
            one.recurrent.weight.data *= 0.4
            two = snn.Synaptic(alpha_out, beta_out, threshold=ones_out, **options)
        else:
            one = snn.Leaky(beta, threshold=ones, **options)
            two = snn.Leaky(beta_out, threshold=ones_out, **options)
        first, second = linear(11, INPUTS, HIDDEN), linear(12, HIDDEN, OUTPUTS)
        if reset == "to-value":
            # The exporter takes neurons that hold their state; the file is the same for every reset.
            if recurrent:
                held = snn.RSynaptic(
                    alpha, beta, all_to_all=True, linear_features=HIDDEN, threshold=ones, init_hidden=True)
                held.recurrent = one.recurrent
                last = snn.Synaptic(alpha_out, beta_out, threshold=ones_out, init_hidden=True)
            else:
                held = snn.Leaky(beta, threshold=ones, init_hidden=True)
                last = snn.Leaky(beta_out, threshold=ones_out, init_hidden=True)
            whole = nn.Sequential(first, held, second, last)
            nir.write(place / f"{name}.nir", export_to_nir(whole, torch.zeros(INPUTS)))
        steps, spike = [], torch.zeros(HIDDEN)
        zero, zero_out = torch.zeros(HIDDEN), torch.zeros(OUTPUTS)
        state_one, state_two = (zero, zero), (zero_out, zero_out)
        for fired in inputs():
            x = first(torch.tensor(fired))
            if recurrent:
                spike, *state_one = one(x, spike, *state_one)
                out, *state_two = two(second(spike), *state_two)
            else:
                spike, mem = one(x, state_one[0])
                state_one = (mem,)
                out, mem = two(second(spike), state_two[0])
                state_two = (mem,)
            steps.append((fired, spike.detach(), out.detach(), state_two[-1].detach().numpy()))
        write(place / f"{name}.{reset}.txt", steps)


def spikingjelly(place, cuba):
    first, second = linear(21, INPUTS, HIDDEN, bias=False), linear(22, HIDDEN, OUTPUTS)
    if cuba:
        name = "spikingjelly_cuba"
        one = neuron.CUBALIFNode(v_threshold=1.0, v_reset=0.0)
        two = neuron.LIFNode(tau=4.0, decay_input=True, v_threshold=0.5, v_reset=-0.25)
    else:
        # Whole weights: an integrator often stands at its threshold.
        name = "spikingjelly"
        first.weight.data = torch.round(first.weight.data * 3)
        one = neuron.IFNode(v_threshold=4.0, v_reset=0.0)
        two = neuron.LIFNode(tau=3.0, decay_input=False, v_threshold=1.0, v_reset=0.0)
    net = nn.Sequential(first, one, second, two)
    nir_exchange.export_to_nir(net, torch.zeros(1, INPUTS), save_path=place / f"{name}.nir")
    for part in (one, two):
        part.reset()
    steps = []
    for fired in inputs():
        spike = one(first(torch.tensor(fired[None])))
        out = two(second(spike))
        steps.append((fired, spike[0].detach(), out[0].detach(), two.v[0].detach().numpy()))
    write(place / f"{name}.to-value.txt", steps)


def of_norse(place, cell):
    first, second = linear(31, INPUTS, HIDDEN), linear(32, HIDDEN, OUTPUTS)
    first.weight.data *= 3
    tau_mem, tau_syn = some(33, HIDDEN, 90, 300), some(34, HIDDEN, 100, 400)
    tau_out = some(35, OUTPUTS, 20, 80)
    if cell:
        p = norse.LIFParameters(
            tau_mem_inv=tau_mem, tau_syn_inv=tau_syn, v_th=0.4 * torch.ones(HIDDEN), v_leak=torch.zeros(HIDDEN),
            v_reset=torch.zeros(HIDDEN))
        one = norse.LIFCell(p=p, dt=0.001)
    else:
        p = norse.LIFBoxParameters(
            tau_mem_inv=tau_mem, v_th=0.4 * torch.ones(HIDDEN), v_leak=0.1 * torch.ones(HIDDEN),
            v_reset=torch.zeros(HIDDEN))
        one = norse.LIFBoxCell(p=p, dt=0.001)
    p = norse.LIBoxParameters(tau_mem_inv=tau_out, v_leak=torch.zeros(OUTPUTS))
    two = norse.LIBoxCell(p=p, dt=0.001)
    name = "norse_cell" if cell else "norse"
    whole = norse.SequentialState(first, one, second, two)
    # With a dt of 1 its time constants are right.
    nir.write(place / f"{name}.nir", to_nir(whole, torch.zeros(INPUTS), dt=1))
    steps, state_one, state_two = [], None, None
    for fired in inputs():
        spike, state_one = one(first(torch.tensor(fired)), state_one)
        out, state_two = two(second(spike), state_two)
        steps.append((fired, spike.detach(), np.zeros(OUTPUTS), out.detach().numpy()))
    write(place / f"{name}.to-value.txt", steps)


def main():
    place = Path(sys.argv[1])
    place.mkdir(exist_ok=True)
    torch.manual_seed(1)
    for recurrent in (False, True):
        snntorch(place, recurrent)
    for kind in (False, True):
        spikingjelly(place, kind)
        of_norse(place, kind)


if __name__ == "__main__":
    main()
