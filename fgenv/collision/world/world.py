"""The world: bodies with poses, and the queries among them."""

from __future__ import annotations

from typing import Any

from fgenv import _core

from .masks import MaskMethods
from .motions import MotionMethods
from .queries import QueryMethods


class World(MotionMethods, QueryMethods, MaskMethods):
    """Bodies with poses; masks, collision, clearance, motion and rays among them.

    Poses are rigid transforms (..., 4, 4) from a shape's frame to the world, in meters. An argument
    that names a body accepts its id or its name. A robot is either a body with all bodies attached
    to it, moved by poses, or a kinematic tree from `add_robot`, moved by configurations: arguments
    for a robot's poses then take configurations (..., nq), interpolated as `Robot.interpolate`
    does. Parts of a kinematic robot are also tested against each other, except allowed pairs.
    Queries may run in several threads at once; changes wait for them.

    Args:
        masks: `path` (default): test only bodies with the robot's bit set, which hides no
            collision. `published`: the paper's masks (a body's position in the box of the path's
            waypoints, one bit for all robots), unsound, for comparison. `off`: test every body, for
            comparison.
    """

    def __init__(self, *, masks: str = "path") -> None:
        self._core = _core.World(masks)
        self._models = {}

    @property
    def tests(self) -> int:
        """Number of pairs of bodies tested since the world was created."""
        return self._core.tests()

    @property
    def motion_steps(self) -> int:
        """Number of steps of certified motion checks so far: the same on every machine."""
        return self._core.motion_steps()

    @property
    def nbytes(self) -> int:
        """Bytes of the bodies and their index, without the shapes."""
        return self._core.nbytes()

    def copy(self) -> World:
        """An independent world with the same bodies, paths and masks; shapes are shared."""
        other = World(masks=self.masks)
        other._core.copy_from(self._core)
        other._models = dict(self._models)
        return other

    def __copy__(self) -> World:
        return self.copy()

    def __deepcopy__(self, memo: dict[int, Any]) -> World:
        return self.copy()

    def __getstate__(self) -> dict[str, Any]:
        state = self._core.state()
        there = {body["id"] for body in state["bodies"]}
        return state | {"models": {i: m for i, m in self._models.items() if i in there}}

    def __setstate__(self, state: dict[str, Any]) -> None:
        try:
            core = _core.World(state["masks"])
            models = dict(state["models"])
            core.restore(state, {i: model._core for i, model in models.items()})
        except Exception as error:  # of any kind: a damaged state has any content
            reason = str(error) if isinstance(error, ValueError) else type(error).__name__
            raise ValueError(
                f"World: got a damaged state ({reason}), expected one of copy or pickle"
            ) from error
        self._core, self._models = core, models

    def __repr__(self) -> str:
        return f"World({len(self)} bodies)"
