"""Who comes near a vertex, or near the moves that leave it: by cells of the floor, cheaply."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
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
        self._others = others
        self._side, self._vertices, self._moves = _places(roadmap)
        self._found: dict[tuple[int, int], list[Other]] = {}

    def of_vertex(self, v: int) -> list[Other]:
        """Of one who waits at v."""
        return self._those(self._vertices[v])

    def of_move(self, e: int) -> list[Other]:
        """Of one who makes move e."""
        return self._those(self._moves[e])

    def _those(self, at: tuple[int, int]) -> list[Other]:
        if at not in self._found:
            cell, reach = at
            near = self._side * reach
            self._found[at] = [o for o in self._others if cell in o.cells(self._side, near)]
        return self._found[at]


@lru_cache(maxsize=64)
def _places(roadmap: Roadmap) -> tuple[float, list[tuple[int, int]], list[tuple[int, int]]]:
    """Side of a cell (m), and of each vertex and move its cell and reach, in sides, rounded up."""
    n = len(roadmap.q)
    side = float(roadmap.steps.radius[:n].max())
    still = _numbers(roadmap.steps.centre[:n], side).tolist()
    centre, radius = roadmap.balls
    reach = np.ceil(radius / side + 1e-6).astype(np.int64).tolist()
    moves = zip(_numbers(centre, side).tolist(), reach, strict=True)
    return side, [(cell, 1) for cell in still], list(moves)


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
