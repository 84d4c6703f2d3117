"""Orientations in three dimensions for free bodies, quaternions x, y, z, w."""

from __future__ import annotations

import math

from fgenv.scenarios.rng import Dice, micro, sin_cos

Quaternion = tuple[float, float, float, float]
LEVEL: Quaternion = (0.0, 0.0, 0.0, 1.0)


def about(axis: int, angle: float) -> Quaternion:
    """A turn (rad) about x, y or z: axis 0, 1, 2."""
    sine, cosine = sin_cos(0.5 * angle)
    x, y, z = (sine if k == axis else 0.0 for k in range(3))
    return x, y, z, cosine


def after(a: Quaternion, b: Quaternion) -> Quaternion:
    """The turn b, then the turn a."""
    (ax, ay, az, aw), (bx, by, bz, bw) = a, b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def any_way(dice: Dice) -> Quaternion:
    """Uniform over all orientations (Shoemake 1992, 'Uniform random rotations')."""
    part = dice.unit()
    (s1, c1), (s2, c2) = (sin_cos(2 * math.pi * dice.unit()) for _ in range(2))
    a, b = math.sqrt(1.0 - part), math.sqrt(part)
    return a * s1, a * c1, b * s2, b * c2


def pose(x: float, y: float, z: float, turn: Quaternion = LEVEL) -> tuple[float, ...]:
    """A configuration of a free base, rounded to a millionth."""
    return tuple(micro(value) for value in (x, y, z, *turn))
