"""Writes a NIR graph with PyPI's `nir`, as frameworks do: which way an aircraft rolls.

    roll.py FILE [FAULT]   20 neurons of a position code in, 12 LIF neurons, 3 LIF neurons out: falls, holds, rises

FAULT is what is wrong with it: cuba, odd, back, deep, nan, narrow, unweighted, reset, wide. Or what else is in it that is
taken: short, nested, recurrent.
"""

import sys

import nir
import numpy

INPUTS, HIDDEN, OUTPUTS = 20, 12, 3


def lif(count, tau, reset=0):
    each = numpy.ones(count)
    # A spike adds its weight, in steps of 5 ms.
    r = tau / 0.005 * each
    return nir.LIF(tau=tau * each, r=r, v_leak=0 * each, v_threshold=each, v_reset=reset * each)


def chain(*names):
    return list(zip(names, names[1:]))


def graph():
    noise = numpy.random.default_rng(1).normal
    inputs, hidden = numpy.linspace(-1, 1, INPUTS), numpy.linspace(-1, 1, HIDDEN)
    near = numpy.exp(-(((hidden[:, None] - inputs) / 0.15) ** 2))
    first = 0.9 * near - 0.08 + noise(0, 0.03, near.shape)
    rises = numpy.tanh(4 * hidden)
    ways = numpy.stack([-rises, 0.8 - 1.6 * abs(rises), rises])
    second = 1.2 * ways + noise(0, 0.03, ways.shape)
    nodes = {
        "input": nir.Input({"input": numpy.array([INPUTS])}),
        "fc1": nir.Linear(first.astype("f4")),
        "lif1": lif(HIDDEN, 0.030),
        "fc2": nir.Affine(second.astype("f4"), numpy.array([0, 0.02, 0], "f4")),
        "lif2": lif(OUTPUTS, 0.040),
        "output": nir.Output({"output": numpy.array([OUTPUTS])}),
    }
    return nodes, chain("input", "fc1", "lif1", "fc2", "lif2", "output")


def spoil(fault, nodes, edges):
    each = numpy.ones(OUTPUTS)
    if fault == "cuba":
        nodes["lif2"] = nir.CubaLIF(
            tau_syn=each, tau_mem=each, r=each, v_leak=0 * each, v_threshold=each
        )
    elif fault == "short":
        # A current that lasts a step of the recording.
        lif2 = nodes["lif2"]
        nodes["lif2"] = nir.CubaLIF(
            tau_syn=0.005 * each,
            tau_mem=lif2.tau,
            r=lif2.r,
            v_leak=0 * each,
            v_threshold=each,
            v_reset=0 * each,
        )
    elif fault == "odd":
        nodes["lif2"] = nir.Threshold(each)
    elif fault == "back":
        nodes["fc3"] = nir.Linear(numpy.ones((HIDDEN, OUTPUTS)))
        edges += [("lif2", "fc3"), ("fc3", "lif1")]
    elif fault == "nested":
        # As snnTorch and Norse write a layer, here without a way back.
        inner = {
            "input": nir.Input({"input": numpy.array([OUTPUTS])}),
            "lif": nodes["lif2"],
            "output": nir.Output({"output": numpy.array([OUTPUTS])}),
        }
        nodes["lif2"] = nir.NIRGraph(inner, chain(*inner))
    elif fault == "recurrent":
        inner = {
            "input": nir.Input({"input": numpy.array([HIDDEN])}),
            "lif": nodes["lif1"],
            "w_rec": nir.Linear(-0.3 * numpy.eye(HIDDEN, k=1)),
            "output": nir.Output({"output": numpy.array([HIDDEN])}),
        }
        edges_back = [("lif", "w_rec"), ("w_rec", "lif")]
        nodes["lif1"] = nir.NIRGraph(inner, chain("input", "lif", "output") + edges_back)
    elif fault == "deep":
        names = [f"{kind}{n}" for n in range(3, 5) for kind in ("fc", "lif")]
        for n in range(3, 5):
            nodes[f"fc{n}"] = nir.Linear(numpy.eye(OUTPUTS))
            nodes[f"lif{n}"] = lif(OUTPUTS, 0.040)
        edges[-1:] = chain("lif2", *names, "output")
    elif fault == "nan":
        nodes["fc2"].weight[1, 4] = numpy.nan
    elif fault == "narrow":
        nodes["fc2"] = nir.Linear(numpy.ones((OUTPUTS, HIDDEN - 1)))
    elif fault == "unweighted":
        edges[:3] = [("input", "lif1"), ("lif1", "fc2")]
        del nodes["fc1"]
    elif fault == "reset":
        nodes["lif1"] = lif(HIDDEN, 0.030, reset=-0.5)
    elif fault == "wide":
        nodes["fc1"] = nir.Linear(numpy.ones((300, INPUTS)))
        nodes["lif1"] = lif(300, 0.030)
        nodes["fc2"] = nir.Linear(numpy.ones((OUTPUTS, 300)))
    else:
        raise ValueError(fault)


def main():
    path, *faults = sys.argv[1:]
    nodes, edges = graph()
    for fault in faults:
        spoil(fault, nodes, edges)
    nir.write(path, nir.NIRGraph(nodes, edges, type_check=not faults))


if __name__ == "__main__":
    main()
