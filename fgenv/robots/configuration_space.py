"""Configuration space of a kinematic tree: limits, sampling, interpolation, displacement bound."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fgenv.arrays import Flags, Floats

from .kinematic_tree import BASE_DOF, KinematicTree
from .links_joints import locked
from .mimic_limits import source_limits

UNIT_TOLERANCE = 1e-6  # of the length of a valid quaternion


@dataclass(frozen=True, eq=False, repr=False)
class ConfigurationSpace(KinematicTree):
    """A kinematic tree with the space of its configurations (..., nq); see `Robot`."""

    workspace: Floats | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "workspace", checked_workspace(self.workspace, self.base))
        _ = self._joint_limits  # raises errors of joints that mimic others

    @cached_property
    def lower(self) -> Floats:
        """Lower limits, (nq,), also of joints that mimic others; angles -pi, quaternions -1."""
        return self._limits(0)

    @cached_property
    def upper(self) -> Floats:
        """Upper limits, (nq,), also of joints that mimic others; angles pi, quaternions 1."""
        return self._limits(1)

    @cached_property
    def endless(self) -> NDArray[np.bool_]:
        """Flags of coordinates that are angles without limits, (nq,): yaw, continuous joints."""
        names = {joint.name for joint in self.moving_joints if joint.kind == "continuous"}
        if self.base == "planar":
            names.add("yaw")
        return np.array([name in names for name in self.coordinates], dtype=bool)

    @cached_property
    def velocity(self) -> Floats:
        """Speed limits per second, (dof,); infinite for the base, which the drive limits."""
        return self._rates([joint.velocity for joint in self.moving_joints])

    @cached_property
    def acceleration(self) -> Floats:
        """Limits of acceleration per second squared, (dof,); infinite for the base."""
        return self._rates([joint.acceleration for joint in self.moving_joints])

    @cached_property
    def rest(self) -> Floats:
        """The configuration with all coordinates at 0, clipped to the limits."""
        q = np.clip(np.zeros(self.nq), self.lower, self.upper)
        if self.base == "free":
            q[6] = 1.0
        return locked(q)

    @cached_property
    def weights(self) -> Floats:
        """Displacement of the robot per unit of each coordinate, (nq,), upper bounds.

        Meters per meter or radian: 1 for positions; for an angle, the distance of the farthest
        point that it moves. All four of a quaternion have the weight of its angle.
        """
        weight = dict.fromkeys(self.coordinates, 1.0)
        turning = {"fixed": (), "planar": ("yaw",), "free": ("qx", "qy", "qz", "qw")}[self.base]
        weight.update(dict.fromkeys(turning, self.reach[self.root]))
        weight.update(dict.fromkeys((joint.name for joint in self.moving_joints), 0.0))
        for joint in self.joints:
            if joint.moves:
                source, multiplier, _ = self.mimic_sources[joint.name]
                arm = 1.0 if joint.kind == "prismatic" else self.reach[joint.child]
                weight[source.name] += abs(multiplier) * arm
        return locked(np.array([weight[name] for name in self.coordinates], dtype=np.float64))

    def random(self, rng: np.random.Generator, size: int | tuple[int, ...] | None = None) -> Floats:
        """Random configurations (*size, nq), uniform between the limits; orientations uniform.

        Raises:
            ValueError: a coordinate has no limits.
        """
        low, high = self.lower, self.upper
        for name, width in zip(self.coordinates, high - low, strict=True):
            if np.isinf(width):
                remedy = "workspace=" if name in ("x", "y", "z") else "limits of the joint"
                raise ValueError(
                    f"random: got no limits of {name!r} of {self.name!r}, expected finite ones;"
                    f" give {remedy}"
                )
        shape = () if size is None else np.broadcast_shapes(size)
        q = rng.uniform(low, high, (*shape, self.nq))
        if self.base == "free":  # by rejection: a logarithm differs between machines
            quaternions = q[..., 3:7].reshape(-1, 4)
            while (bad := abs(_squares(quaternions) - 0.505) > 0.495).any():  # not in [0.01, 1]
                quaternions[bad] = rng.uniform(-1, 1, (int(bad.sum()), 4))
            unit = quaternions / np.sqrt(_squares(quaternions))[:, None]
            q[..., 3:7] = unit.reshape(q[..., 3:7].shape)
        return q

    def valid(self, q: ArrayLike) -> Any:
        """Whether configurations (..., nq) are within the limits: bool, or a bool array.

        An angle without limits may have any value; a quaternion has length 1, to 1e-6.
        """
        x = self._checked(q)
        within: Flags = ((x >= self.lower) & (x <= self.upper)) | (self.endless & np.isfinite(x))
        if self.base == "free":
            unit = abs(np.sqrt(_squares(x[..., 3:7])) - 1) <= UNIT_TOLERANCE
            within[..., 3:7] = unit[..., None]
        ok = within.all(axis=-1)
        return bool(ok) if ok.ndim == 0 else ok

    def clip(self, q: ArrayLike) -> Floats:
        """The nearest configurations within the limits; angles are wrapped to [-pi, pi]."""
        x = self._checked(q)
        if np.isnan(x).any():
            raise ValueError("q: got NaN, expected numbers")
        clipped = np.where(self.endless, x, np.clip(x, self.lower, self.upper))
        if self.base == "free":
            length = np.sqrt(_squares(x[..., 3:7]))
            if not ((length > 0) & np.isfinite(length)).all():
                raise ValueError(
                    "q: got a quaternion of length 0 or infinite, expected an orientation"
                )
            clipped[..., 3:7] = x[..., 3:7] / length[..., None]
        return self._core.interpolate(clipped, clipped, 0.0, threads=None)

    def interpolate(
        self, q0: ArrayLike, q1: ArrayLike, t: ArrayLike, *, threads: int | None = None
    ) -> Floats:
        """Configurations at fractions t in [0, 1] of the motion from q0 to q1, (..., nq).

        As in OMPL's spaces: positions and bounded joints move in a straight line, yaw and
        continuous joints the shorter way around, orientations along the shortest arc. q0 and q1
        (..., nq) and t (...) broadcast.
        """
        return self._core.interpolate(q0, q1, t, threads=threads)

    def displacement_bound(self, q0: ArrayLike, q1: ArrayLike) -> Any:
        """Upper bound of the path length of any point on the motion from q0 to q1, meters, (...).

        Changes of the coordinates times `weights`; q0 and q1 (..., nq) broadcast.
        """
        return self._core.displacement_bound(q0, q1, self.weights)

    def difference(self, q0: Floats, q1: Floats) -> Floats:
        """Change of each degree of freedom from q0 to q1 (..., nq), the shorter way: (..., dof).

        For a free base: the position, then the rotation vector in the base's frame at q0 (rad).
        """
        change: Floats = q1 - q0
        ends = self.endless
        change[..., ends] = np.remainder(change[..., ends] + math.pi, 2 * math.pi) - math.pi
        if self.base != "free":
            return change
        turn = rotation_vector(q0[..., 3:7], q1[..., 3:7])
        return np.concatenate([change[..., :3], turn, change[..., 7:]], axis=-1)

    def _checked(self, q: ArrayLike) -> Floats:
        x = np.asarray(q, dtype=np.float64)
        if x.ndim == 0 or x.shape[-1] != self.nq:
            raise ValueError(f"q: got shape {x.shape}, expected (..., {self.nq}), configurations")
        return x

    def _limits(self, side: int) -> Floats:
        """Lower (side 0) or upper (1) limits."""
        sign = (-1.0, 1.0)[side]
        place = [sign * np.inf] * 3 if self.workspace is None else [*self.workspace[side]]
        base = {
            "fixed": [],
            "planar": [*place[:2], sign * math.pi],
            "free": [*place, *[sign] * 4],
        }
        joints = [self._joint_limits[joint.name][side] for joint in self.moving_joints]
        return locked(np.array([*base[self.base], *joints], dtype=np.float64))

    @cached_property
    def _joint_limits(self) -> dict[str, tuple[float, float]]:
        """Limits of each joint with a coordinate: its own, and those of joints that mimic it.

        Raises:
            ValueError: no value is within all of them.
        """
        limits = {joint.name: (joint.lower, joint.upper) for joint in self.moving_joints}
        for joint in self.joints:
            if joint.mimic is not None:
                source, multiplier, offset = self.mimic_sources[joint.name]
                low, high = source_limits(joint, multiplier, offset)
                own = limits[source.name]
                limits[source.name] = max(own[0], low), min(own[1], high)
                if limits[source.name][0] > limits[source.name][1]:
                    raise ValueError(
                        f"joint {joint.name!r}: got limits that no value of {source.name!r}, which"
                        " it mimics, keeps; expected limits that overlap"
                    )
        full = -math.pi, math.pi
        endless = {joint.name: full for joint in self.moving_joints if joint.kind == "continuous"}
        return limits | endless

    def _rates(self, joints: list[float]) -> Floats:
        return locked(np.array([np.inf] * BASE_DOF[self.base] + joints, dtype=np.float64))


def checked_workspace(value: ArrayLike | None, base: str) -> Floats | None:
    """Bounds of a base's position, (2, 2) or (2, 3), read-only."""
    if value is None:
        return None
    if base == "fixed":
        raise ValueError("workspace: got bounds for a fixed base, expected None")
    expected = (2, 2) if base == "planar" else (2, 3)
    box = np.array(value, dtype=np.float64)
    if box.shape != expected or not np.isfinite(box).all() or not (box[0] <= box[1]).all():
        raise ValueError(
            f"workspace: got {value!r}, expected (low, high), {expected}, finite meters"
        )
    return locked(box)


def rotation_vector(from_: Floats, to: Floats) -> Floats:
    """Rotation between quaternions (..., 4), x, y, z, w, as a vector in the first frame (rad)."""
    u, v, a, b = from_[..., :3], to[..., :3], from_[..., 3:], to[..., 3:]
    axis = a * v - b * u - np.cross(u, v)
    cosine = a * b + np.sum(u * v, axis=-1, keepdims=True)
    sine = np.linalg.norm(axis, axis=-1, keepdims=True)
    angle = 2 * np.arctan2(sine, np.abs(cosine)) * np.where(cosine >= 0, 1.0, -1.0)
    out: Floats = axis * np.divide(angle, sine, out=np.full_like(sine, 2.0), where=sine > 1e-12)
    return out


def _squares(rows: Floats) -> Floats:
    """Sums of squares of rows of four, in one order of addition on every machine."""
    x, y, z, w = (rows[..., k] for k in range(4))
    total: Floats = x * x + y * y + z * z + w * w
    return total
