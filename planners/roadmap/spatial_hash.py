"""Who comes near a vertex, or near the moves that leave it: by cells of the floor, cheaply."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fgenv.arrays import Floats, Ints

if TYPE_CHECKING:
    from fgenv.planners.sipp.dynamic_obstacles import Other

    from .roadmap import Roadmap

SPAN = 1 << 20  # cells along y


class Cells:
    """For a roadmap's vertices and moves, those of the others that may be near; all of them."""

    def __init__(self, roadmap: Roadmap, others: Sequence[Other]) -> None:
        self._others = others
        self._side, self._vertices, self._moves = roadmap.cells
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


def covered(center: Floats, radius: Floats, side: float, reach: float) -> frozenset[int]:
    """Cells from where a ball of that reach (m) may overlap one of the balls (n, 3), (n,)."""
    wide = (radius + reach)[:, None]
    low = np.floor((center[:, :2] - wide) / side).astype(np.int64)
    high = np.floor((center[:, :2] + wide) / side).astype(np.int64)
    most = (high - low).max(0) + 1
    x = low[:, :1] + np.arange(most[0])
    y = low[:, 1:] + np.arange(most[1])
    x, y = np.minimum(x, high[:, :1]), np.minimum(y, high[:, 1:])
    return frozenset(np.unique(x[:, :, None] * SPAN + y[:, None]).tolist())


def numbers(center: Floats, side: float) -> Ints:
    """The cells that points (n, 3) are in, (n,)."""
    at = np.floor(center[:, :2] / side).astype(np.int64)
    return np.asarray(at[:, 0] * SPAN + at[:, 1])
