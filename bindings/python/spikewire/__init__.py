"""Sensor samples to spikes and back, with the code that flies.

Every scheme of the catalogue is a class here, made from it when the package is imported. Its keywords are the scheme's
parameters; :data:`schemes` has all classes by their short names.

>>> import numpy as np, spikewire as sw
>>> x = np.sin(np.linspace(0, 6, 200), dtype=np.float32)
>>> spikes = sw.StepForward(threshold=0.1).encode(x)
>>> spikes
Spikes of StepForward: (200,), 33 spikes of 200 samples
>>> bool(np.abs(spikes.decode() - x).max() < 0.11)
True
"""

from . import _native
from ._bank import EVENTS, Bank
from ._dataset import dataset
from ._files import Log, read, read_events, read_ulog, write_events
from ._filters import Filter, low_pass
from ._flight import Flight
from ._native import Error
from ._laptop import Advice, Picture, Tuned, advise, plot, score, tune
from ._link import Receiver, Sender
from ._network import Network, Ran
from ._scheme import Scheme
from ._schemes import *  # noqa: F403: the classes, by the catalogue
from ._schemes import NAMES, schemes
from ._spikes import Spikes
from ._stream import Decoder, Encoder
from ._transform import ToSpikes

#: The version of the package and of the code that flies.
__version__: str = _native.__version__

__all__ = [
    "EVENTS",
    "Advice",
    "Bank",
    "Decoder",
    "Encoder",
    "Error",
    "Filter",
    "Flight",
    "Log",
    "Network",
    "Picture",
    "Ran",
    "Receiver",
    "Scheme",
    "Sender",
    "Spikes",
    "ToSpikes",
    "Tuned",
    "advise",
    "dataset",
    "low_pass",
    "plot",
    "read",
    "read_events",
    "read_ulog",
    "schemes",
    "score",
    "tune",
    "write_events",
    *NAMES,
]
