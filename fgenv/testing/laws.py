"""What all contract tests share: bit-for-bit equality, copies, and what has to be refused."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable, Iterator, Mapping
from typing import Any, TypeVar

import numpy as np

T = TypeVar("T")


def require(law: bool, text: str) -> None:
    """AssertionError where a law does not hold, whatever Python's optimization."""
    if not law:
        raise AssertionError(text)


def same(a: Any, b: Any) -> bool:
    """Whether data are the same, bit for bit: arrays, numbers, and containers of them."""
    if isinstance(a, Mapping):
        return isinstance(b, Mapping) and [*a] == [*b] and all(same(a[k], b[k]) for k in a)
    if isinstance(a, (tuple, list)):
        return len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, np.ndarray) and a.dtype == object:
        return same(a.tolist(), b.tolist())
    if isinstance(a, (np.ndarray, np.generic, float)):
        x, y = np.asarray(a), np.asarray(b)
        return x.dtype == y.dtype and x.shape == y.shape and x.tobytes() == y.tobytes()
    return bool(a == b)


def copies(thing: T) -> Iterator[tuple[str, T]]:
    """The ways to copy it, by name."""
    yield "copy", copy.copy(thing)
    yield "deepcopy", copy.deepcopy(thing)
    yield "pickle", pickle.loads(pickle.dumps(thing))


def refuses(call: Callable[[], Any], error: type[Exception], what: str) -> None:
    """A call has to raise, and to say something."""
    try:
        call()
    except error as raised:
        require(bool(str(raised)), f"{what}: {error.__name__} without a word")
        return
    except Exception as raised:
        name = type(raised).__name__
        raise AssertionError(f"{what}: {name} ({raised}), expected {error.__name__}") from raised
    raise AssertionError(f"{what}: taken, expected {error.__name__}")
