"""Numeric fields of messages: `data`, `angular_velocity.x`, `ranges[3]`, `poses[0].position.z`."""

import re
from collections.abc import Iterator
from typing import Any, Union

_PART = re.compile(r"[./]?([A-Za-z]\w*)|\[(\d+)\]")


class FieldError(ValueError):
    """An expression that names no number of a message."""


class Field:
    """A number in messages of some type."""

    def __init__(self, expression: str) -> None:
        self.expression = expression
        self._parts: list[Union[str, int]] = []
        place = 0
        while place < len(expression):
            part = _PART.match(expression, place)
            if part is None:
                raise FieldError(f"field `{expression}`: cannot be read from `{expression[place:]}` on")
            name, index = part.groups()
            self._parts.append(name if index is None else int(index))
            place = part.end()
        if not self._parts or isinstance(self._parts[0], int):
            raise FieldError(f"field `{expression}`: it begins with a name, such as `angular_velocity.x`")

    def of(self, message: Any) -> float:
        """The number, which may be not finite."""
        value = message
        for part in self._parts:
            value = self._step(message, value, part)
        # numpy's numbers count; text does not, nor does a byte string.
        if isinstance(value, (str, bytes)) or not hasattr(value, "__float__"):
            raise self._error(message, f"is no number, but {_kind(value)}")
        try:
            return float(value)
        except TypeError:  # a numpy array of several
            raise self._error(message, f"is no number, but {_kind(value)}") from None

    def _step(self, message: Any, value: Any, part: Union[str, int]) -> Any:
        if isinstance(part, str):
            if part not in _names(value):
                raise self._error(message, f"{_kind(value)} has no `{part}`")
            return getattr(value, part)
        if isinstance(value, str) or not hasattr(value, "__getitem__"):
            raise self._error(message, f"{_kind(value)} has no [{part}]")
        if part >= len(value):
            raise self._error(message, f"there are {len(value)} elements, so [{part}] is none")
        return value[part]

    def _error(self, message: Any, why: str) -> FieldError:
        fields = ", ".join(numeric(message)) or "none"
        return FieldError(f"field `{self.expression}`: {why}; numbers of {_kind(message)}: {fields}")


def numeric(message: Any) -> list[str]:
    """The expressions of all numbers of a message; of a list, the first's."""
    return list(_numeric(message, ""))


def _numeric(value: Any, before: str) -> Iterator[str]:
    if isinstance(value, (str, bytes)):
        if isinstance(value, bytes) and value:
            yield f"{before}[0]"
    elif _names(value):
        for name in _names(value):
            yield from _numeric(getattr(value, name), f"{before}.{name}" if before else name)
    elif hasattr(value, "__len__"):
        if len(value):
            yield from _numeric(value[0], f"{before}[0]")
    elif hasattr(value, "__float__"):
        yield before


def _names(value: Any) -> list[str]:
    """A message's fields."""
    return list(getattr(value, "__slots__", ()))


def _kind(value: Any) -> str:
    return getattr(value, "_type", type(value).__name__)
