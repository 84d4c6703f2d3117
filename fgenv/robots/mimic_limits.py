"""Limits of joints that mimic others, as limits of the joints that they mimic."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from .links_joints import Joint
from .topology import mimic_source


def source_limits(joint: Joint, multiplier: float, offset: float) -> tuple[float, float]:
    """Limits of the coordinate x with multiplier * x + offset within a joint's limits."""
    if multiplier == 0.0:
        inside = joint.lower <= offset <= joint.upper
        return (-math.inf, math.inf) if inside else (math.inf, -math.inf)
    ends = (joint.lower - offset) / multiplier, (joint.upper - offset) / multiplier
    return min(ends), max(ends)


def without_contradictions(joints: Sequence[Joint], notes: list[str]) -> list[Joint]:
    """Joints of a file, without the limits of mimic joints that leave the others no room.

    Many grippers' files give a joint that turns the other way the limits of the joint that it
    mimics.

    Args:
        notes: receives a sentence for each joint that loses its limits.
    """
    by_name = {joint.name: joint for joint in joints}
    limits = {joint.name: (joint.lower, joint.upper) for joint in joints}
    result = list(joints)
    for i, joint in enumerate(joints):
        if joint.mimic is None:
            continue
        try:
            source, multiplier, offset = mimic_source(joint, by_name)
        except ValueError:  # Robot reports it
            continue
        own, other = limits[source.name], source_limits(joint, multiplier, offset)
        both = max(own[0], other[0]), min(own[1], other[1])
        if both[0] < both[1] or own[0] == both[0] == both[1] == own[1]:
            limits[source.name] = both
            continue
        notes.append(
            f"The limits of joint {joint.name!r} contradict those of {source.name!r}, which it"
            " mimics; they are left out."
        )
        result[i] = replace(joint, lower=-math.inf, upper=math.inf)
    return result
