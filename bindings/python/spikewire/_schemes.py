"""The classes of the schemes, made from the catalogue."""

import inspect
import textwrap

from . import _native
from ._errors import CallError, Unknown
from ._scheme import KINDS, Scheme

#: What is not given of a code by chance.
FRESH = "fresh draws in each call"


def _told(own):
    if own["name"] == "seed":
        own = {**own, "default": FRESH}
    kind = " or ".join(f'"{word}"' for word in own["words"]) or KINDS[own["kind"]]
    if own["name"] == "seed":
        kind = "a whole number, or a numpy.random.Generator"
    unit = f", in {own['unit']}" if own["unit"] else ""
    text = f"{own['help']} ({kind}{unit}"
    if own["example"]:
        text += f", such as {own['example']}"
    if own["default"] is not None:
        text += f"; {own['default']} unless given"
    elif own["found"]:
        text += f"; {own['found']} unless given"
    lines = textwrap.wrap(text + ")", 110)
    return f"{own['name']}:\n" + textwrap.indent("\n".join(lines), "    ")


def _example(parameters):
    """Keywords for what neither a default nor a signal tells; of two that stand for each other, the first."""
    given = []
    for own in parameters:
        is_open = own["default"] is None and own["found"] is None
        if is_open and own["example"] and not own["help"].startswith("in the place of"):
            example = own["example"] if own["kind"] in ("number", "count") else repr(own["example"])
            given.append(f"{own['name']}={example}")
    return ", ".join(given)


def _class(info):
    parameters = "\n".join(_told(own) for own in info["parameters"])
    document = f"""{info["words"][0].upper()}{info["words"][1:]}, `{info["name"]}`: good for {info["good_for"]}.

{parameters}
sample:
    the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
    rounded to it
paper:
    the settings of the paper, scaled to the signal's range, for what is not given

>>> import numpy as np, spikewire as sw
>>> x = 3 * np.sin(np.linspace(0, 20, 300))
>>> spikes = sw.{info["type_name"]}({_example(info["parameters"])}).encode(x)
>>> spikes.count > 0, spikes.decode().shape
(True, (300,))
"""
    keyword = inspect.Parameter.KEYWORD_ONLY
    names = [inspect.Parameter(own["name"], keyword, default=None) for own in info["parameters"]]
    common = [
        inspect.Parameter("sample", keyword, default="f32"),
        inspect.Parameter("paper", keyword, default=False),
    ]
    own_names = [own["name"] for own in info["parameters"]]

    def __init__(self, *args, **keywords):
        if args:
            raise CallError(f"{info['type_name']} takes keywords only, as {own_names[0]}={args[0]!r}")
        unknown = [name for name in keywords if name not in own_names and name not in ("sample", "paper")]
        if unknown:
            raise CallError(f"{info['type_name']} takes no {unknown[0]}; it takes {', '.join(own_names)}")
        Scheme.__init__(self, **keywords)

    __init__.__signature__ = inspect.Signature(
        [inspect.Parameter("self", inspect.Parameter.POSITIONAL_ONLY), *names, *common]
    )
    body = {"__doc__": document, "__init__": __init__, "_info": info, "__module__": "spikewire"}
    return type(info["type_name"], (Scheme,), body)


class _ByName(dict):
    def __missing__(self, name):
        raise Unknown(f"there is no scheme {name!r}; there are {', '.join(self)}")


#: The classes by their short names, in the order of the catalogue.
schemes = _ByName((info["name"], _class(info)) for info in _native.schemes())
NAMES = [own.__name__ for own in schemes.values()]
globals().update({own.__name__: own for own in schemes.values()})
__all__ = NAMES
