"""Joints of a compiled MJCF model."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fgenv import _core
from fgenv.arrays import Floats

from .links_joints import MAX_VALUE, Joint, Mimic
from .mjcf_couplings import Coupling
from .mjcf_geometry import pose
from .mjcf_tree import Names


def body_joints(model: Any, body: int) -> range:
    """Joints of a body, in their order."""
    first = int(model.body_jntadr[body])
    return range(first, first + int(model.body_jntnum[body]))


def joint_kinds(model: Any, body: int) -> list[str]:
    """Types of the joints of a body, as in a file: free, ball, slide, hinge."""
    return [_kind(model, joint) for joint in body_joints(model, body)]


def _kind(model: Any, joint: int) -> str:
    import mujoco

    name: str = mujoco.mjtJoint(int(model.jnt_type[joint])).name
    return name.removeprefix("mjJNT_").lower()


@dataclass(frozen=True)
class JointReader:
    """Hinges and slides as joints of a robot.

    Attributes:
        model: MjModel.
        scale: factor of all lengths.
        couplings: by joint.
        notes: receives sentences.
    """

    model: Any
    names: Names
    scale: float
    couplings: Mapping[int, Coupling]
    notes: list[str]

    def joint(self, joint: int, parent: str, child: str, origin: Floats) -> Joint:
        """A joint between two links.

        Args:
            origin: (4, 4), the joint's frame in the parent's where the file draws it, meters.

        Raises:
            ValueError: a ball joint; names it.
        """
        kind = _kind(self.model, joint)
        name, axis = self.names.joints[joint], np.asarray(self.model.jnt_axis[joint])
        if kind not in ("hinge", "slide"):
            raise ValueError(
                f"joint {name!r} of body {child.partition('@')[0]!r}: got type {kind}, expected"
                " hinge or slide; replace it by three hinges"
            )
        start = float(self.model.qpos0[self.model.jnt_qposadr[joint]])
        coupling = self.couplings.get(joint)
        if coupling is not None and coupling.joint < 0:
            at = origin @ self._motion(kind, axis, coupling.offset - start)
            return Joint(name, "fixed", parent, child, at)
        origin = origin @ self._motion(kind, axis, -start)
        low, high = self._limits(joint, kind)
        shown = "prismatic" if kind == "slide" else "revolute"
        if kind == "hinge" and math.isinf(low) and math.isinf(high):
            shown = "continuous"
        mimic = None if coupling is None else self._mimic(kind, coupling)
        return Joint(name, shown, parent, child, origin, axis, low, high, mimic=mimic)

    def _motion(self, kind: str, axis: NDArray[np.float64], value: float) -> Floats:
        """The pose of a joint's child at a value of its coordinate."""
        if kind == "slide":
            return translation(self.scale * value * axis)
        sine, cosine = (float(f) for f in _core.sin_cos(0.5 * value))
        return pose(np.zeros(3), [cosine, *(sine * axis)])

    def _limits(self, joint: int, kind: str) -> tuple[float, float]:
        if not self.model.jnt_limited[joint]:
            return -math.inf, math.inf
        ends = [float(end) for end in self.model.jnt_range[joint]]
        if max(map(abs, ends)) > MAX_VALUE:
            name = self.names.joints[joint]
            self.notes.append(
                f"The joint {name!r} has limits over {MAX_VALUE:g}; it is unbounded there."
            )
        length = self.scale if kind == "slide" else 1.0
        low, high = (x if abs(x) <= MAX_VALUE else math.copysign(math.inf, x) for x in ends)
        return length * low, length * high

    def _mimic(self, kind: str, coupling: Coupling) -> Mimic:
        """The coupling of a joint of some kind, in meters and radians."""
        per = self.scale if _kind(self.model, coupling.joint) == "slide" else 1.0
        length = self.scale if kind == "slide" else 1.0
        name = self.names.joints[coupling.joint]
        return Mimic(name, coupling.multiplier * length / per, length * coupling.offset)


def translation(offset: NDArray[np.float64]) -> Floats:
    """A translation by (3,) as a pose (4, 4)."""
    matrix = np.eye(4)
    matrix[:3, 3] = offset
    return matrix
