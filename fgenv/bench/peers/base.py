"""The interface of a peer. Poses come as NumPy float64 (4, 4) or (n, 4, 4), as a user has them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Poses
from fgenv.bench.common.meshes import Mesh


@dataclass(frozen=True)
class Checker:
    """One pair of bodies in one library; body a stands still, b takes the poses."""

    collide: Callable[[Poses], bool]  # (4, 4) -> verdict
    collide_all: Callable[[Poses], NDArray[np.bool_]]  # (n, 4, 4) -> (n,)
    distance_all: Callable[[Poses], NDArray[np.float64]] | None = None  # (n, 4, 4) -> (n,) meters
    distance: Callable[[Poses], float] | None = None


@dataclass(frozen=True)
class Peer:
    """A library: `build` makes its model of a mesh, `pair` a checker of two models."""

    name: str
    version: str
    truth: str  # what its verdict is about: meshes, hulls, edges in float
    build: Callable[[Mesh], Any]
    pair: Callable[[Any, Any, Poses], Checker]  # models of a and b, pose of a (4, 4)
    nbytes: Callable[[Any], int] | None = None  # of a model; None: measured by process size

    @property
    def exact(self) -> bool:
        """Whether its verdicts are about the triangles themselves."""
        return self.truth == "meshes"
