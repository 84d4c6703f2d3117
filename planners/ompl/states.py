"""Conversion between OMPL's states and arrays.

`StateSpace.serialize` copies the coordinates of a state of any space, as consecutive doubles, to a
`void*`, for which nanobind accepts a capsule with its own name. If a later version of the bindings
rejects that, states are read coordinate by coordinate, which takes a few microseconds more.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from ompl import base as ob

from fgenv.arrays import Floats

Serializer = Callable[[Any, Any], None]  # from a state to a capsule

NAME = b"nb_handle"  # of nanobind's capsules; capsules keep a pointer to it

_new_capsule = ctypes.pythonapi.PyCapsule_New
_new_capsule.restype = ctypes.py_object
_new_capsule.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]
_address = ctypes.pythonapi.PyCapsule_GetPointer
_address.restype, _address.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]


class StateBuffer:
    """Reads and writes states of a space information's space; stores neither."""

    def __init__(self, si: Any) -> None:
        self._space = si.getStateSpace()
        self.size = state_size(self._space)
        self._row = np.empty(self.size)
        self._capsule = capsule(self._row)
        self.serialize = serializer(si)

    def read(self, state: Any) -> Floats:
        """Return the coordinates of a state, (size,)."""
        self.serialize(self._capsule, state)
        return self._row.copy()

    def write(self, state: Any, values: ArrayLike) -> Any:
        """Set the coordinates (size,) of a state, and return it."""
        row = np.asarray(values, dtype=np.float64)
        if row.shape != (self.size,):
            raise ValueError(f"state: got shape {row.shape}, expected ({self.size},)")
        self._row[:] = row
        self._space.deserialize(state, self._capsule)
        return state


def capsule(row: Floats) -> Any:
    """Capsule of the address of an array, which must outlive it."""
    return _new_capsule(row.ctypes.data, NAME, None)


def state_size(space: Any) -> int:
    """Number of coordinates of a state."""
    return int(space.getSerializationLength()) // 8


def serializer(si: Any) -> Serializer:
    """The space's own `serialize` if it accepts capsules and copies correctly; else a slow one."""
    space = si.getStateSpace()
    slow = coordinate_serializer(space)
    state, rows = si.allocState(), np.full((2, state_size(space)), np.nan)
    for serialize, row in zip((space.serialize, slow), rows, strict=True):
        try:
            serialize(capsule(row), state)
        except (TypeError, RuntimeError):
            return slow
    native: Serializer = space.serialize
    return native if np.array_equal(rows[0], rows[1], equal_nan=True) else slow


def coordinate_serializer(space: Any) -> Serializer:
    """Serializer that reads a state coordinate by coordinate."""
    size = state_size(space)

    def serialize(target: Any, state: Any) -> None:
        row = (ctypes.c_double * size).from_address(_address(target, NAME))
        row[:] = list(_coordinates(space, state))

    return serialize


def _coordinates(space: Any, state: Any) -> Iterator[float]:
    """Coordinates in the order of `serialize`."""
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
