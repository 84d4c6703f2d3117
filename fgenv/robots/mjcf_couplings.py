"""Couplings of joints in MJCF files, from equalities of joints and of fixed tendons.

Other constraints are errors.
"""

from __future__ import annotations

from collections.abc import Container
from typing import Any, NamedTuple

import numpy as np


class Coupling(NamedTuple):
    """Coordinate of a joint: multiplier * coordinate of `joint` + offset; -1: no joint, constant.

    Coordinates are as in the file: radians or its unit of length.
    """

    joint: int
    multiplier: float
    offset: float


def joint_couplings(model: Any, bodies: Container[int], notes: list[str]) -> dict[int, Coupling]:
    """Couplings of the joints of some bodies, by joint.

    Raises:
        ValueError: an active constraint of these bodies that no coupling expresses; names it.
    """
    import mujoco

    couplings: dict[int, Coupling] = {}
    kinds = mujoco.mjtEq
    for i in range(model.neq):
        kind = int(model.eq_type[i])
        if not _concerns(model, i, bodies):
            continue
        label = _label(model, i)
        if not model.eq_active0[i]:
            notes.append(f"The {label} is inactive; it is left out.")
        elif kind in (kinds.mjEQ_JOINT, kinds.mjEQ_TENDON):
            one = _of_joints if kind == kinds.mjEQ_JOINT else _of_tendons
            joint, coupling = one(model, i, label, couplings)
            if joint in couplings:
                raise ValueError(f"{label}: got a second coupling of its joint, expected one")
            both = {joint, coupling.joint} - {-1}
            if any(int(model.jnt_bodyid[end]) not in bodies for end in both):
                raise ValueError(f"{label}: got joints of two trees, expected joints of one robot")
            couplings[joint] = coupling
        elif any(body not in bodies and _moves(model, body) for body in _bodies(model, i)):
            notes.append(f"The {label} is to a body that is not of the robot; it is left out.")
        else:
            raise ValueError(
                f"{label}: got a constraint, expected joint couplings only; remove it from"
                " <equality> if the robot may move without it"
            )
    return couplings


def _of_joints(model: Any, i: int, label: str, couplings: Container[int]) -> tuple[int, Coupling]:
    """The joint that an equality of joints determines, and its coupling."""
    first, second = int(model.eq_obj1id[i]), int(model.eq_obj2id[i])
    constant, factor = _line(model, i, label)
    start = float(model.qpos0[model.jnt_qposadr[first]])
    if second < 0:
        return first, Coupling(-1, 0.0, start + constant)
    other = float(model.qpos0[model.jnt_qposadr[second]])
    return first, Coupling(second, factor, start + constant - factor * other)


def _of_tendons(model: Any, i: int, label: str, couplings: Container[int]) -> tuple[int, Coupling]:
    """The joint that an equality of fixed tendons determines, and its coupling.

    A fixed tendon has the length of a weighted sum of coordinates. The constraint is linear in
    them: it determines one coordinate if it has only one other.
    """
    first, second = int(model.eq_obj1id[i]), int(model.eq_obj2id[i])
    constant, factor = _line(model, i, label)
    weights = _weights(model, first, label)
    total = constant + float(model.tendon_length0[first])
    if second >= 0:
        for joint, weight in _weights(model, second, label).items():
            weights[joint] = weights.get(joint, 0.0) - factor * weight
        total -= factor * float(model.tendon_length0[second])
    terms = sorted((joint in couplings, -joint) for joint in weights if weights[joint])
    if not 1 <= len(terms) <= 2:
        raise ValueError(
            f"{label}: got {len(terms)} joints, expected one or two; remove it from <equality> if"
            " the robot may move without it"
        )
    joint = -terms[0][1]
    other = -terms[1][1] if len(terms) == 2 else -1
    ratio = -weights[other] / weights[joint] if other >= 0 else 0.0
    return joint, Coupling(other, ratio, total / weights[joint])


def _line(model: Any, i: int, label: str) -> tuple[float, float]:
    """Constant and factor of a polynomial of degree 1."""
    constant, factor, *rest = (float(a) for a in np.asarray(model.eq_data[i])[:5])
    if any(rest):
        raise ValueError(f"{label}: polycoef: got degree over 1, expected a linear coupling")
    return constant, factor


def _weights(model: Any, tendon: int, label: str) -> dict[int, float]:
    """Weights of joints in the length of a fixed tendon."""
    import mujoco

    first, count = int(model.tendon_adr[tendon]), int(model.tendon_num[tendon])
    weights: dict[int, float] = {}
    for k in range(first, first + count):
        if int(model.wrap_type[k]) != mujoco.mjtWrap.mjWRAP_JOINT:
            raise ValueError(f"{label}: got a tendon in space, expected a fixed tendon of joints")
        joint = int(model.wrap_objid[k])
        weights[joint] = weights.get(joint, 0.0) + float(model.wrap_prm[k])
    return weights


def _label(model: Any, i: int) -> str:
    import mujoco

    kind = mujoco.mjtEq(int(model.eq_type[i])).name.removeprefix("mjEQ_").lower()
    name = model.equality(i).name
    return f"equality {kind} {name!r}" if name else f"equality {kind} {i} (from 0)"


def _concerns(model: Any, i: int, bodies: Container[int]) -> bool:
    return any(body in bodies for body in _bodies(model, i))


def _moves(model: Any, body: int) -> bool:
    """Whether a body moves in the world: by joints, or as a mocap body."""
    mocap = int(model.body_mocapid[model.body_rootid[body]]) >= 0
    return mocap or int(model.body_weldid[body]) != 0


def _bodies(model: Any, i: int) -> list[int]:
    """Bodies that an equality constraint is about."""
    import mujoco

    kinds, first, second = mujoco.mjtEq, int(model.eq_obj1id[i]), int(model.eq_obj2id[i])
    ends = [end for end in (first, second) if end >= 0]
    kind = int(model.eq_type[i])
    if kind == kinds.mjEQ_JOINT:
        return [int(model.jnt_bodyid[joint]) for joint in ends]
    if kind == kinds.mjEQ_TENDON:
        return [body for tendon in ends for body in tendon_bodies(model, tendon)]
    if kind in (kinds.mjEQ_CONNECT, kinds.mjEQ_WELD):
        sites = int(model.eq_objtype[i]) == mujoco.mjtObj.mjOBJ_SITE
        return [int(model.site_bodyid[end]) if sites else end for end in ends]
    return []  # of deformable bodies, which are refused


def tendon_bodies(model: Any, tendon: int) -> list[int]:
    """Bodies of the sites, geoms and joints on the path of a tendon."""
    import mujoco

    kinds = mujoco.mjtWrap
    owners = {
        int(kinds.mjWRAP_JOINT): model.jnt_bodyid,
        int(kinds.mjWRAP_SITE): model.site_bodyid,
        int(kinds.mjWRAP_SPHERE): model.geom_bodyid,
        int(kinds.mjWRAP_CYLINDER): model.geom_bodyid,
    }
    first, count = int(model.tendon_adr[tendon]), int(model.tendon_num[tendon])
    wraps = range(first, first + count)
    return [
        int(owners[kind][model.wrap_objid[k]])
        for k in wraps
        if (kind := int(model.wrap_type[k])) in owners
    ]
