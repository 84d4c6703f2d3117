"""OMPL's state validity checker and motion validator for robots and bodies in a world.

    >>> si.setStateValidityChecker(StateValidityChecker(si, "cart", world))
    >>> si.setMotionValidator(MotionValidator(si, "cart", world))

OMPL's states are serialized into native buffers. Checking a motion is one native call: it computes
the mask of the path and certifies that the motion is free. Some planners end the process if a check
raises an exception. An exception is therefore stored in `error`, and all later states and motions
are invalid; `Setup.solve` raises it once the planner has returned.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, cast

import numpy as np
from ompl import base as ob

from fgenv import _core
from fgenv.collision import World
from fgenv.collision.world import Body
from fgenv.planners.checker import joint_checker
from fgenv.robots import Robot, Steering

from .spaces import StateLayout, Subspace, state_space, subspaces
from .states import serializer

Bodies = Body | Sequence[Body]

BODY_SIZES = {"SE2": 3, "SE3": 7}  # numbers in the state of a body without a robot model


class StateValidityChecker(ob.StateValidityChecker):  # type: ignore[misc]
    """A state is valid if nothing collides and everything is more than `margin` meters away.

    Args:
        si: OMPL's space information. Its space is `fgenv.planners.state_space` of the robot; SE2
            or SE3 for a body without a robot model.
        robot: id or name in the world, or a sequence of them for a joint space.
        world: world of the robot and the obstacles; it may change during a search.
        margin: meters.
        steering: see `Robot.steering`; the drive's default if None.
    """

    def __init__(
        self,
        si: Any,
        robot: Bodies,
        world: World,
        *,
        margin: float = 0.0,
        steering: str | None = None,
    ) -> None:
        super().__init__(si)
        self._core = space_checker(si, robot, world, margin=margin, steering=steering)
        self.isValid, _, self.clearance = self._core.serve(serializer(si))

    @property
    def error(self) -> BaseException | None:
        """Exception that a check raised, or None."""
        return self._core.error()

    @property
    def checks(self) -> int:
        """Number of checked states."""
        return self._core.counts()[0]


class MotionValidator(ob.MotionValidator):  # type: ignore[misc]
    """A motion is valid if it is certified free along the steering of the robot's drive.

    The first state is assumed to be valid, as in OMPL's own validator.

    Args:
        si, robot, world, margin, steering: see `StateValidityChecker`.
        resolution: meters. If given, the motion is checked at discrete states between which no
            point moves farther, as in OMPL's own validator. This can miss collisions.
    """

    def __init__(
        self,
        si: Any,
        robot: Bodies,
        world: World,
        *,
        margin: float = 0.0,
        steering: str | None = None,
        resolution: float | None = None,
    ) -> None:
        super().__init__(si)
        self._core = space_checker(
            si, robot, world, margin=margin, steering=steering, resolution=resolution
        )
        _, self.checkMotion, _ = self._core.serve(serializer(si))

    @property
    def error(self) -> BaseException | None:
        """Exception that a check raised, or None."""
        return self._core.error()

    @property
    def checks(self) -> int:
        """Number of checked motions."""
        return self._core.counts()[1]


def space_checker(
    si: Any,
    robot: Bodies,
    world: World,
    *,
    margin: float = 0.0,
    steering: str | None = None,
    resolution: float | None = None,
) -> _core.Checker:
    """Native checker for the states of a space; ValueError if the space does not fit."""
    bodies = [robot] if isinstance(robot, (int, str, np.integer)) else list(robot)
    if not bodies:
        raise ValueError("robot: got none, expected at least one")
    if resolution is not None and not resolution > 0:
        raise ValueError(f"resolution: got {resolution}, expected meters over 0, or None")
    layouts = [_layout(world, body, steering) for body in bodies]
    return joint_checker(
        world,
        bodies,
        _sizes(layouts, subspaces(si.getStateSpace())),
        margin,
        steerings=[Steering() if layout is None else layout.steering for layout in layouts],
        resolution=resolution,
        regions=[None if layout is None else layout.robot.workspace for layout in layouts],
    )


def _layout(world: World, body: Body, steering: str | None) -> StateLayout | None:
    """StateLayout of a robot's states; None for a body without a robot model."""
    model = cast(Robot | None, world.record(body).robot)
    if model is None and steering not in (None, "straight"):
        raise ValueError(f"steering: got {steering!r}, expected 'straight' for a body, or None")
    return None if model is None else StateLayout(model, model.steering(steering))


def _sizes(layouts: Sequence[StateLayout | None], given: list[Subspace]) -> list[int]:
    """Numbers in each body's state; ValueError if the given subspaces are not the expected."""
    expected: list[Subspace] = []
    sizes = []
    for layout in layouts:
        if layout is None:
            part = given[len(expected)] if len(expected) < len(given) else ("SE2", 3)
            part = part if part[0] in BODY_SIZES else ("SE2", 3)
            sizes.append(BODY_SIZES[part[0]])
            expected.append(part)
        else:
            sizes.append(layout.size)
            expected += subspaces(state_space(layout, np.array([[-1.0] * 3, [1.0] * 3])))
    if _joined(given) != _joined(expected):
        raise ValueError(
            f"si: got a space of {_text(given)}, expected {_text(expected)};"
            " use fgenv.planners.state_space"
        )
    return sizes


def _joined(parts: list[Subspace]) -> list[Subspace]:
    """Subspaces with consecutive real vector spaces joined."""
    out: list[Subspace] = []
    for kind, size in parts:
        if out and kind == out[-1][0] == "RealVector":
            out[-1] = (kind, out[-1][1] + size)
        else:
            out.append((kind, size))
    return out


def _text(parts: list[Subspace]) -> str:
    return ", ".join(f"R{n}" if kind == "RealVector" else kind for kind, n in _joined(parts))
