"""Parameters of the nodes, by the toolbox's names where it has them."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Optional

from . import schemes

# What every node takes; all else is the scheme's.
_OWN = ("encoding_scheme", "sample", "topic", "field", "calibrate", "gap", "defaults")
# The toolbox sets these for all schemes, at 0 where a scheme has no use for them.
_OF_TOOLBOX = ("factor", "threshold", "window", "neurons")


@dataclass(frozen=True)
class Settings:
    """What a node was given."""

    # A scheme's name in the catalogue; the decoding node may take it from the messages.
    scheme: Optional[str]
    sample: str
    # Empty where it is not given.
    topic: str
    field: str
    # How many samples stand in for what is not given.
    calibrate: int
    # A step above so many usual steps is a gap.
    gap: float
    # The scheme's own, by the names that the catalogue has.
    options: dict[str, Any]


def read(
    private: Mapping[str, Any], shared: Mapping[str, Any], table: Mapping[str, Any] = MappingProxyType({})
) -> Settings:
    """From a node's own parameters and, where those lack something, from the toolbox's, which are set for all nodes.

    Where `defaults` is set, a scheme's own in the table stand in for what both lack.

    Raises `ValueError` that says which parameter, what it was and what is allowed.
    """
    given = {name: shared[name] for name in ("encoding_scheme",) if name in shared}
    given.update({name: shared[name] for name in _OF_TOOLBOX if shared.get(name)})
    given.update(private)
    scheme = given.get("encoding_scheme")
    if given.get("defaults"):
        given = {**table.get(schemes.of_catalogue(str(scheme)), {}), **given}
    gap, calibrate = given.get("gap", 1.5), given.get("calibrate", 0)
    if not isinstance(gap, (int, float)) or not gap > 1:
        raise ValueError(f"gap {gap}: it must be a number above 1, in usual steps")
    if not isinstance(calibrate, int) or calibrate < 0:
        raise ValueError(f"calibrate {calibrate}: it must be a whole number of samples, 0 or more")
    return Settings(
        scheme=schemes.of_catalogue(str(scheme)) if scheme else None,
        sample=str(given.get("sample", "f32")),
        topic=str(given.get("topic") or ""),
        field=str(given.get("field", "data")),
        calibrate=calibrate,
        gap=float(gap),
        options={name: _checked(name, value) for name, value in given.items() if name not in _OWN},
    )


def _checked(name: str, value: Any) -> Any:
    """A value of a kind that schemes take."""
    numbers = isinstance(value, (list, tuple)) and all(isinstance(one, (int, float)) for one in value)
    if not numbers and not isinstance(value, (bool, int, float, str)):
        raise ValueError(f"{name} {value}: it must be a number, a text, a list of numbers, or true or false")
    return value


def to_encode(settings: Settings) -> Settings:
    """Those of an encoding node, which says what to encode and how."""
    if not settings.topic:
        raise ValueError("topic is missing: what to encode, such as /imu/data")
    if settings.scheme is None:
        raise ValueError("encoding_scheme is missing: how to encode, such as step_forward")
    return settings
