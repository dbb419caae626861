"""Errors of the package: every one is :class:`Error`, and some are of one of Python's own kinds too."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, TypeVar, cast

from ._native import Error

__all__ = ["Busy", "CallError", "Error", "FileError", "OutOfRange", "RangeError", "Unknown", "checked"]

Function = TypeVar("Function", bound=Callable[..., Any])


class CallError(Error, TypeError):
    """An argument of a kind that the call does not take."""


class RangeError(Error, OverflowError):
    """A number that is too large for what it counts."""


class Unknown(Error, KeyError):
    """A name that stands for nothing."""


class OutOfRange(Error, IndexError):
    """A place beyond the last one."""


class FileError(Error, OSError):
    """A file that the system does not open or write."""


class Busy(Error, RuntimeError):
    """An encoder or decoder that works for another thread."""


def checked(function: Function) -> Function:
    """The function, whose arguments the compiled half checks: it raises :class:`Error` for those of another kind."""

    @functools.wraps(function)
    def call(*arguments: Any, **keywords: Any) -> Any:
        try:
            return function(*arguments, **keywords)
        except Error:
            raise
        except TypeError as error:
            raise CallError(*error.args) from error
        except OverflowError as error:
            raise RangeError(*error.args) from error
        except OSError as error:
            raise FileError(str(error)) from error
        except ValueError as error:
            raise Error(*error.args) from error

    return cast(Function, call)
