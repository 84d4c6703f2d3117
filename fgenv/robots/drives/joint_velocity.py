"""Joint velocity: each joint moves at a commanded speed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from fgenv.arrays import Flags, Floats

from ..configuration_space import ConfigurationSpace
from .arcs import lookahead
from .base import INF, Action, DrivePart, LegLimit, Quantity


@dataclass(frozen=True)
class JointVelocity(DrivePart):
    """Each joint moves at a commanded speed, within the joint's own limits too."""

    kind = "joint_velocity"

    speed: Annotated[float, Quantity("rad/s or m/s", "Speed of each joint")] = INF
    acceleration: Annotated[float, Quantity("rad/s^2 or m/s^2", "Change of each joint's speed")] = (
        INF
    )

    def check_part(self, robot: ConfigurationSpace) -> None:
        """Raise ValueError if no joint moves, or a joint has no speed limit."""
        if not robot.moving_joints:
            raise ValueError(f"drive: got {robot.name!r} without joints, expected joints that move")
        for action in self.part_actions(robot):
            if math.isinf(action.high):
                raise ValueError(
                    f"drive: got no speed limit of joint {action.name!r}, expected one;"
                    " give JointVelocity(speed=)"
                )

    def part_actions(self, robot: ConfigurationSpace) -> tuple[Action, ...]:
        """Rate of each joint, in the order of the configuration."""
        return tuple(
            Action.symmetric(
                joint.name,
                "m/s" if joint.kind == "prismatic" else "rad/s",
                min(joint.velocity, self.speed),
                min(joint.acceleration, self.acceleration),
            )
            for joint in robot.moving_joints
        )

    def part_inverse(
        self, robot: ConfigurationSpace, q: Floats, change: Floats, dt: float
    ) -> tuple[Floats, Floats]:
        """The joints' rates; nothing is left over."""
        n = len(robot.moving_joints)
        return change[..., robot.dof - n :] / dt, np.zeros(change.shape[:-1])

    def part_leg_limits(
        self, robot: ConfigurationSpace, q: Floats, change: Floats, dt: float
    ) -> list[LegLimit]:
        """Limits of each joint."""
        joints = change[robot.dof - len(robot.moving_joints) :].tolist()
        return [
            LegLimit(abs(by), action.high, action.rate)
            for by, action in zip(joints, self.part_actions(robot), strict=True)
        ]

    def part_waypoint(
        self, robot: ConfigurationSpace, q: Floats, target: Floats, seconds: float
    ) -> Floats:
        """Change of each joint as a fraction of that at full speed."""
        n = len(robot.moving_joints)
        change = target[:, -n:] - q[:, -n:]
        wrapped = change - np.round(change / (2 * np.pi)) * (2 * np.pi)
        change = np.where(robot.endless[-n:], wrapped, change)
        return np.asarray(np.clip(change / self._reach(robot, seconds), -1.0, 1.0))

    def part_tracking_waypoint(
        self, robot: ConfigurationSpace, actions: Floats, dt: float, seconds: float
    ) -> tuple[Floats, Flags]:
        """Waypoint of each joint."""
        rates = np.array([a.rate for a in self.part_actions(robot)]) * dt
        change = lookahead(actions, rates, dt) / self._reach(robot, seconds)
        return change, np.ones(len(actions), dtype=bool)

    def _reach(self, robot: ConfigurationSpace, seconds: float) -> Floats:
        return np.array([action.high for action in self.part_actions(robot)]) * seconds
