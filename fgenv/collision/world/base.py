"""Types shared by all parts of a world."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from fgenv import _core
from fgenv.arrays import Floats

Body = int | str  # a body's id or name
Bodies = Body | Sequence[Body] | NDArray[np.integer[Any]]

TOLERANCE = 1e-6  # meters


class Model(Protocol):
    """The attributes of a robot that a world reads; `fgenv.robots.Robot` has them."""

    @property
    def name(self) -> str: ...
    @property
    def links(self) -> Sequence[Any]: ...  # each with a `name`
    @property
    def parts(self) -> Sequence[Any]: ...  # each with `link` (index in `links`), `shape`, `origin`
    @property
    def allowed_parts(self) -> Sequence[tuple[int, int]]: ...  # indices in `parts`
    @property
    def rest(self) -> Floats: ...  # (nq,)
    @property
    def _core(self) -> _core.Robot: ...


class WorldBase:
    """The native world and the models of its robots."""

    _core: _core.World
    _models: dict[int, Model]  # by id of the robot's first body
