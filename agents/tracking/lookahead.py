"""Whether steps that are to come are free, in a world as it is now."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fgenv import _core
from fgenv.arrays import Floats
from fgenv.collision import World
from fgenv.collision.world import TOLERANCE
from fgenv.robots import Robot


def free_steps(
    world: World, names: Sequence[str], models: Sequence[Robot], rows: Sequence[Floats]
) -> NDArray[np.bool_]:
    """Whether each step is proved free, (m,): all robots named move at once, the rest stands.

    Args:
        rows: configurations (m + 1, nq) of each of them.
    """
    joint = np.concatenate(rows, axis=1)
    n = len(names)
    checker = _core.Checker(
        world._core,
        [robot_id(world, name) for name in names],
        [model.nq for model in models],
        [0] * n,
        [1.0] * n,
        [True] * n,
        0.0,
        TOLERANCE,
        0.0,
    )
    return np.asarray(checker.free(joint[:-1], joint[1:]))


def robot_id(world: World, name: str) -> int:
    """A robot's id, by its name."""
    return int(world.parts(name)[0])
