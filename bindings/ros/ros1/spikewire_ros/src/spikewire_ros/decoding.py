"""From the messages of spikes to values, without ROS."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Optional

from . import schemes
from .clock import Clock
from .codec import Codec, Request
from .counters import Counters
from .settings import Settings


@dataclass(frozen=True)
class Received:
    """What a `spyke` or a `spyke_array` says."""

    spikes: Sequence[int]
    start: float
    min_input: float
    max_input: float
    threshold: float
    input: float
    scheme: str
    # Nanoseconds.
    stamp: int


class Decoding:
    """Decodes messages as they come.

    What is not given stands in the first message: the scheme, the value to start from, the range, the threshold, and
    how many neurons there are. When an encoder starts anew, with another scheme or start, so does the decoder.
    """

    def __init__(self, settings: Settings, counters: Counters) -> None:
        self._settings = settings
        self._counters = counters
        self._clock = Clock(settings.gap)
        self._codec: Optional[Codec] = None
        # The scheme and the start that its messages tell.
        self._encoder = ("", 0.0)

    def take(self, message: Received) -> Optional[float]:
        """The value, unless the message is none of the scheme's: that is counted, and the decoder stays as it is."""
        wrong = self._clock.observe(message.stamp)
        if wrong is not None:
            self._counters.add(*wrong)
        codec = self._codec
        if codec is None or (message.scheme, message.start) != self._encoder:
            if codec is not None:
                self._counters.add("new starts of the encoder")
            codec = self._codec = self._start(message)
        try:
            return codec.decode(message.spikes)
        except ValueError as error:
            self._counters.add("messages refused", str(error))
            return None

    def _start(self, message: Received) -> Codec:
        settings = self._settings
        if settings.scheme is None:
            settings = replace(settings, scheme=schemes.of_catalogue(message.scheme))
        low, high = message.min_input, message.max_input
        if message.scheme == schemes.GAUSSIAN_FIELDS:
            low, high = schemes.toolbox_range(low, high, len(message.spikes))
        known = {"threshold": message.threshold, "min": low, "max": high, "shift": low}
        codec = Request(settings).receive(known, len(message.spikes), message.start)
        self._encoder = (message.scheme, message.start)
        if codec.starts_at_first and message.input != message.start:
            self._counters.add(
                "starts in the middle",
                f"the first sample heard is {message.input:g}, the encoder's was {message.start:g}: values are off by "
                "what was missed",
            )
        return codec
