"""Paths, trajectories and the collision masks that follow from them."""

from __future__ import annotations

from numpy.typing import ArrayLike

from fgenv.arrays import Floats, Ints32

from .base import Body, WorldBase


class MaskMethods(WorldBase):
    """Methods of `World` on paths, trajectories and masks."""

    def set_trajectory(self, body: Body, times: ArrayLike | None, poses: ArrayLike | None) -> None:
        """Set a body's known future motion, used by queries with a time.

        Args:
            times: (k,) seconds, ascending; None deletes the trajectory.
            poses: (k, 4, 4) at those times, or configurations (k, nq) of a kinematic robot.
                Between them the position is linear and the orientation follows the shortest arc;
                outside them the body rests.
        """
        self._core.set_trajectory(body, times, poses)

    def set_path(self, robot: Body, poses: ArrayLike) -> Ints32:
        """Compute the motion boxes of a path, set the masks and return the candidates' ids.

        The motion box of a leg bounds the whole robot along that leg, rotation included. The robot
        owns one bit. Each body has that bit set if it overlaps a box, at its pose or along its own
        path or trajectory. Masks follow at once when bodies are added, moved or removed and when
        paths of other robots change.

        Args:
            poses: (K, 4, 4) waypoints, or configurations (K, nq) of a kinematic robot. Between them
                the position is linear and the orientation follows the shortest arc. Replaces the
                robot's earlier path.
        """
        return self._core.set_path(robot, poses)

    def clear_path(self, robot: Body) -> None:
        """Delete the robot's path and clear its bit in all masks."""
        self._core.clear_path(robot)

    def candidates(self, robot: Body) -> Ints32:
        """Ids of the bodies with the robot's bit set, ascending."""
        return self._core.candidates(robot)

    def motion_boxes(self, robot: Body) -> Floats:
        """Motion boxes of the robot's path, (legs, 2, 3): lowest and highest corner, meters."""
        return self._core.motion_boxes(robot)

    def mask(self, body: Body) -> int:
        """The body's mask: its own bit, and those of robots with motion boxes that it overlaps."""
        return self._core.mask(body)

    def own_bit(self, robot: Body) -> int:
        """The robot's bit as a mask (a power of two); 0 without a path."""
        bit = self._core.own_bit(robot)
        return 1 << bit if bit >= 0 else 0

    @property
    def masks(self) -> str:
        """Kind of the masks: path, published or off."""
        return self._core.masks()
