"""Helpers of the contract tests: bit-for-bit equality, copies, and expected errors."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable, Iterator, Mapping
from typing import Any, TypeVar

import numpy as np

T = TypeVar("T")


def require(law: bool, text: str) -> None:
    """Raise AssertionError if a law does not hold, also with optimization (python -O)."""
    if not law:
        raise AssertionError(text)


def equal(a: Any, b: Any) -> bool:
    """Whether arrays, numbers, and containers of them are equal, bit for bit."""
    if isinstance(a, Mapping):
        return isinstance(b, Mapping) and [*a] == [*b] and all(equal(a[k], b[k]) for k in a)
    if isinstance(a, (tuple, list)):
        return len(a) == len(b) and all(map(equal, a, b))
    if isinstance(a, np.ndarray) and a.dtype == object:
        return equal(a.tolist(), b.tolist())
    if isinstance(a, (np.ndarray, np.generic, float)):
        x, y = np.asarray(a), np.asarray(b)
        return x.dtype == y.dtype and x.shape == y.shape and x.tobytes() == y.tobytes()
    return bool(a == b)


def copies(thing: T) -> Iterator[tuple[str, T]]:
    """Yield copies by each method, with its name."""
    yield "copy", copy.copy(thing)
    yield "deepcopy", copy.deepcopy(thing)
    yield "pickle", pickle.loads(pickle.dumps(thing))


def require_error(call: Callable[[], Any], error: type[Exception], name: str) -> None:
    """Raise AssertionError unless a call raises the error, with a message."""
    try:
        call()
    except error as raised:
        require(bool(str(raised)), f"{name}: {error.__name__} without a message")
        return
    except Exception as raised:
        got = f"{type(raised).__name__} ({raised})"
        raise AssertionError(f"{name}: got {got}, expected {error.__name__}") from raised
    raise AssertionError(f"{name}: got no error, expected {error.__name__}")
