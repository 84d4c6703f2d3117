"""Arcs of a moving body: chords, velocities in its frame, and the distance to look ahead."""

from __future__ import annotations

import math

import numpy as np

from fgenv.arrays import Floats

from .base import ZERO, LegLimit


def arc_velocity(x: Floats, y: Floats, turn: Floats, dt: float) -> tuple[Floats, Floats]:
    """Velocity in the body's frame that draws the arc with the chord (x, y) in dt seconds."""
    half = 0.5 * turn
    chord = np.where(np.abs(half) > 1e-9, np.sin(half) / np.where(half == 0, 1.0, half), 1.0)
    c, s = np.cos(half), np.sin(half)
    return (c * x + s * y) / (chord * dt), (c * y - s * x) / (chord * dt)


def chord_ratio(turn: float) -> float:
    """Length of the chord over the length of its arc, for an arc of `turn` radians."""
    half = min(turn / 2, 1.5)
    return math.sin(half) / half if half > 0 else 1.0


def in_base_frame(q: Floats, vector: Floats) -> Floats:
    """A vector (..., 3) of the world in the frame of a free base at q (..., nq)."""
    u, w = -q[..., 3:6], q[..., 6:7]
    t = 2 * np.cross(u, vector)
    out: Floats = vector + w * t + np.cross(u, t)
    return out


def turning_leg(length: float, turn: float, speed: float, acceleration: float) -> LegLimit:
    """Limit of a straight leg of `length` meters on which the body turns.

    A constant velocity rotates in the frame of the body, which is an acceleration: half of the
    limit is reserved for it.
    """
    if turn <= ZERO or length <= ZERO or math.isinf(acceleration):
        return LegLimit(length, speed, acceleration)
    speed = min(speed, math.sqrt(length * acceleration / (2 * turn)))
    return LegLimit(length, speed, acceleration / 2)


def lookahead(speed: Floats, rate: Floats, dt: float) -> Floats:
    """Distance to a target that keeps a signed speed; `rate` limits its change per step."""
    v = np.abs(speed)
    steps = np.where(np.isfinite(rate), v / np.where(rate > 0, rate, 1.0), 0.0)
    return np.asarray(np.sign(speed) * np.maximum(v * dt, 0.5 * dt * v * (steps + 1.0)))
