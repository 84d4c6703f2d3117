"""Limits of configurations: what is within, and what a change of one is worth in meters."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fgenv.arrays import Floats

from .links_joints import LinkShape, locked

if TYPE_CHECKING:
    from .robot import Robot


BASES: dict[str, tuple[str, ...]] = {
    "fixed": (),
    "planar": ("x", "y", "yaw"),
    "free": ("x", "y", "z", "qx", "qy", "qz", "qw"),
}
BASE_DOF = {"fixed": 0, "planar": 3, "free": 6}
UNIT = 1e-6  # how far a quaternion's length may be from 1 to be valid


def checked_workspace(value: ArrayLike | None, base: str) -> Floats | None:
    """Bounds of a base's position, (2, 2) or (2, 3), read-only."""
    if value is None:
        return None
    if base == "fixed":
        raise ValueError("workspace: a fixed base has no position, leave it out")
    expected = (2, 2) if base == "planar" else (2, 3)
    box = np.array(value, dtype=np.float64)
    if box.shape != expected or not np.isfinite(box).all() or not (box[0] <= box[1]).all():
        raise ValueError(
            f"workspace: got {value!r}, expected (low, high), {expected}, finite meters"
        )
    return locked(box)


def bounds(robot: Robot, side: int) -> Floats:
    """The lowest (side 0) or highest (1) configuration, (nq,)."""
    sign = (-1.0, 1.0)[side]
    place = [sign * np.inf] * 3 if robot.workspace is None else [*robot.workspace[side]]
    base = {"fixed": [], "planar": [*place[:2], sign * math.pi], "free": [*place, *[sign] * 4]}
    ends = [
        sign * math.pi if joint.kind == "continuous" else (joint.lower, joint.upper)[side]
        for joint in robot.moving_joints
    ]
    return locked(np.array([*base[robot.base], *ends], dtype=np.float64))


def rates(robot: Robot, what: str) -> Floats:
    """Limits `velocity` or `acceleration` of all degrees of freedom, (dof,)."""
    joints = [getattr(joint, what) for joint in robot.moving_joints]
    return locked(np.array([np.inf] * BASE_DOF[robot.base] + joints, dtype=np.float64))


def endless(robot: Robot) -> NDArray[np.bool_]:
    """See `Robot.endless`."""
    names = {joint.name for joint in robot.moving_joints if joint.kind == "continuous"}
    if robot.base == "planar":
        names.add("yaw")
    return np.array([name in names for name in robot.coordinates], dtype=bool)


def random(robot: Robot, rng: np.random.Generator, size: int | tuple[int, ...] | None) -> Floats:
    """See `Robot.random`. Orientations by rejection: a logarithm differs between machines."""
    low, high = robot.lower, robot.upper
    for name, width in zip(robot.coordinates, high - low, strict=True):
        if np.isinf(width):
            remedy = "workspace=" if name in ("x", "y", "z") else "limits of the joint"
            raise ValueError(f"random: {name!r} of {robot.name!r} has no limits, give {remedy}")
    shape = () if size is None else (size,) if isinstance(size, (int, np.integer)) else tuple(size)
    q = rng.uniform(low, high, (*shape, robot.nq))
    if robot.base == "free":
        turns = q[..., 3:7].reshape(-1, 4)
        while (bad := abs(squares(turns) - 0.505) > 0.495).any():  # not in [0.01, 1]
            turns[bad] = rng.uniform(-1, 1, (int(bad.sum()), 4))
        q[..., 3:7] = (turns / np.sqrt(squares(turns))[:, None]).reshape(q[..., 3:7].shape)
    return q


def valid(robot: Robot, q: ArrayLike) -> Any:
    """See `Robot.valid`."""
    x = configurations(robot, q)
    within = ((x >= robot.lower) & (x <= robot.upper)) | (robot.endless & np.isfinite(x))
    if robot.base == "free":
        unit = abs(np.sqrt(squares(x[..., 3:7])) - 1) <= UNIT
        within[..., 3:7] = unit[..., None]
    ok = within.all(axis=-1)
    return bool(ok) if ok.ndim == 0 else ok


def clip(robot: Robot, q: ArrayLike) -> Floats:
    """Within the limits, angles as they are, quaternions of length 1."""
    x = configurations(robot, q)
    if np.isnan(x).any():
        raise ValueError("q: NaN, expected numbers")
    held = np.where(robot.endless, x, np.clip(x, robot.lower, robot.upper))
    if robot.base == "free":
        length = np.sqrt(squares(x[..., 3:7]))
        if not ((length > 0) & np.isfinite(length)).all():
            raise ValueError("q: a quaternion of length 0 or infinite, expected an orientation")
        held[..., 3:7] = x[..., 3:7] / length[..., None]
    return held


def configurations(robot: Robot, q: ArrayLike) -> Floats:
    """An array (..., nq)."""
    x = np.asarray(q, dtype=np.float64)
    if x.ndim == 0 or x.shape[-1] != robot.nq:
        raise ValueError(f"q: shape {x.shape}, expected (..., {robot.nq}), configurations")
    return x


def weights(robot: Robot) -> Floats:
    """See `Robot.weights`."""
    far = reaches(robot)
    worth = dict.fromkeys(robot.coordinates, 1.0)
    turning = {"fixed": (), "planar": ("yaw",), "free": ("qx", "qy", "qz", "qw")}[robot.base]
    worth.update(dict.fromkeys(turning, far[robot.root]))
    worth.update(dict.fromkeys((joint.name for joint in robot.moving_joints), 0.0))
    for joint in robot.joints:
        if joint.moves:
            own, multiplier, _ = robot.leaders[joint.name]
            arm = 1.0 if joint.kind == "prismatic" else far[joint.child]
            worth[own.name] += abs(multiplier) * arm
    return locked(np.array([worth[name] for name in robot.coordinates], dtype=np.float64))


def reaches(robot: Robot) -> dict[str, float]:
    """How far from each link's origin any point that it carries can get, meters."""
    far = {link.name: max(map(radius, link.shapes), default=0.0) for link in robot.links}
    for link in reversed(robot.links[1:]):
        joint = robot.carriers[link.name]
        x, y, z = joint.origin[:3, 3].tolist()
        reach = far[link.name] + math.sqrt(x * x + y * y + z * z)
        if joint.kind == "prismatic":
            own, multiplier, offset = robot.leaders[joint.name]
            reach += max(abs(multiplier * end + offset) for end in (own.lower, own.upper))
        far[joint.parent] = max(far[joint.parent], reach)
    return far


def radius(placed: LinkShape) -> float:
    """How far a shape gets from its link's origin, meters."""
    p, m = placed.shape.vertices, placed.origin
    x, y, z = (
        m[i, 0] * p[:, 0] + m[i, 1] * p[:, 1] + m[i, 2] * p[:, 2] + m[i, 3] for i in range(3)
    )
    return float(np.sqrt(np.max(x * x + y * y + z * z)))


def squares(rows: Floats) -> Floats:
    """Sums of squares of rows of four, added in one order on every machine."""
    x, y, z, w = (rows[..., k] for k in range(4))
    total: Floats = x * x + y * y + z * z + w * w
    return total
