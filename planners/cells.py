"""Who comes near a vertex, or near the moves that leave it: by cells of the floor, cheaply."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from .moves import Floats
from .roadmap import Roadmap

if TYPE_CHECKING:
    from .others import Other

SPAN = 1 << 20  # cells along y


class Cells:
    """For a roadmap's vertices and moves, those of the others that may be near. Never misses one."""

    def __init__(self, roadmap: Roadmap, others: Sequence[Other]) -> None:
        self._roadmap, self._others = roadmap, others
        self._side = float(roadmap.steps.radius[: len(roadmap.q)].max())
        self._at: list[int] = _numbers(roadmap.steps.centre[: len(roadmap.q)], self._side).tolist()
        self._found: dict[tuple[int, float], list[Other]] = {}

    def of_vertex(self, v: int) -> list[Other]:
        """Of one who waits at v."""
        return self._those(self._at[v], self._side)

    def of_move(self, e: int) -> list[Other]:
        """Of one who makes move e."""
        return self._those(self._at[self._roadmap.tails[e]], self._roadmap.reach)

    def _those(self, cell: int, reach: float) -> list[Other]:
        key = cell, reach
        if key not in self._found:
            self._found[key] = [o for o in self._others if cell in o.cells(self._side, reach)]
        return self._found[key]


def covered(centre: Floats, radius: Floats, side: float, reach: float) -> frozenset[int]:
    """Cells with a point from where a ball of that reach may overlap one of the balls (n, 3), (n,)."""
    wide = (radius + reach)[:, None]
    low = np.floor((centre[:, :2] - wide) / side).astype(np.int64)
    high = np.floor((centre[:, :2] + wide) / side).astype(np.int64)
    most = (high - low).max(0) + 1
    x = low[:, :1] + np.arange(most[0])
    y = low[:, 1:] + np.arange(most[1])
    x, y = np.minimum(x, high[:, :1]), np.minimum(y, high[:, 1:])
    return frozenset(np.unique(x[:, :, None] * SPAN + y[:, None]).tolist())


def _numbers(centre: Floats, side: float) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """The cells that points (n, 3) are in."""
    at = np.floor(centre[:, :2] / side).astype(np.int64)
    return np.asarray(at[:, 0] * SPAN + at[:, 1])
