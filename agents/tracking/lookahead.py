"""Certified checks of upcoming steps in the current world."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Floats
from fgenv.collision import World
from fgenv.planners.checker import joint_checker
from fgenv.robots import Robot


def free_steps(
    world: World, names: Sequence[str], models: Sequence[Robot], rows: Sequence[Floats]
) -> NDArray[np.bool_]:
    """Whether each step is certified free, (m,): the named robots move at once, the rest stands.

    Args:
        rows: configurations (m + 1, nq) of each of them.
    """
    joint = np.concatenate(rows, axis=1)
    ids = [robot_id(world, name) for name in names]
    checker = joint_checker(world, ids, [model.nq for model in models])
    return np.asarray(checker.free(joint[:-1], joint[1:]))


def robot_id(world: World, name: str) -> int:
    """A robot's id, by its name."""
    return int(world.parts(name)[0])
