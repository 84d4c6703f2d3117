"""OMPL's states to numbers and back.

`StateSpace.serialize` copies all coordinates of a state of any space, one after the other as
doubles, to an address: nanobind takes a capsule with its own name for a `void*`. Where a later
version refuses that, states are read coordinate by coordinate, at the cost of a few microseconds.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from ompl import base as ob

from fgenv.arrays import Floats

Serialize = Callable[[Any, Any], None]

NAME = b"nb_handle"  # of nanobind's capsules; it is kept, so it must not go away

_new = ctypes.pythonapi.PyCapsule_New
_new.restype, _new.argtypes = ctypes.py_object, [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]
_address = ctypes.pythonapi.PyCapsule_GetPointer
_address.restype, _address.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]


class StateBuffer:
    """Reads and writes states of a space information's space; keeps none, nor that."""

    def __init__(self, si: Any) -> None:
        self._space = si.getStateSpace()
        self.size = size_of(self._space)
        self._row = np.empty(self.size)
        self._capsule = _new(self._row.ctypes.data, NAME, None)
        self.serialize = serialize_of(si)

    def read(self, state: Any) -> Floats:
        """The coordinates, (size,)."""
        self.serialize(self._capsule, state)
        return self._row.copy()

    def write(self, state: Any, values: ArrayLike) -> Any:
        """Give a state its coordinates; returns it."""
        row = np.asarray(values, dtype=np.float64)
        if row.shape != (self.size,):
            raise ValueError(f"state: shape {row.shape}, expected ({self.size},)")
        self._row[:] = row
        self._space.deserialize(state, self._capsule)
        return state


def size_of(space: Any) -> int:
    """Numbers in a state."""
    return int(space.getSerializationLength()) // 8


def serialize_of(si: Any) -> Serialize:
    """The space's own `serialize`, if it takes our capsules and gives what the state holds."""
    space = si.getStateSpace()
    slow = _by_coordinates(space)
    state, row = si.allocState(), np.full((2, size_of(space)), np.nan)
    for serialize, target in zip((space.serialize, slow), row, strict=True):
        try:
            serialize(_new(target.ctypes.data, NAME, None), state)
        except (TypeError, RuntimeError):
            return slow
    trusted: Serialize = space.serialize
    return trusted if np.array_equal(row[0], row[1], equal_nan=True) else slow


def _by_coordinates(space: Any) -> Serialize:
    size = size_of(space)

    def serialize(capsule: Any, state: Any) -> None:
        target = (ctypes.c_double * size).from_address(_address(capsule, NAME))
        target[:] = list(_coordinates(space, state))

    return serialize


def _coordinates(space: Any, state: Any) -> Iterator[float]:
    """As `serialize` orders them."""
    if isinstance(space, ob.SE2StateSpace):
        yield from (state.getX(), state.getY(), state.getYaw())
    elif isinstance(space, ob.SE3StateSpace):
        turn = state.rotation()
        yield from (state.getX(), state.getY(), state.getZ(), turn.x, turn.y, turn.z, turn.w)
    elif isinstance(space, ob.SO3StateSpace):
        yield from (state.x, state.y, state.z, state.w)
    elif isinstance(space, ob.SO2StateSpace):
        yield state.value
    elif space.isCompound():
        for k, part in enumerate(space.getSubspaces()):
            yield from _coordinates(part, state[k])
    else:
        yield from (state[k] for k in range(space.getDimension()))
