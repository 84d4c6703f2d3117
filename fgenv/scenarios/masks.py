"""Path-driven collision masks: the box of a motion, and who has to be tested during it."""

from collections.abc import Iterable
from itertools import pairwise

import numpy as np

from fgenv.scenarios.body import Body
from fgenv.scenarios.planar import Floats, as_path, cut


def motion_box(body: Body, path: Floats) -> Floats:
    """The box (2, 3), metres, that holds the whole body all along the path (n, 3).

    Sound: the arc of each vertex in a leg is bounded, not sampled, and added to the range of
    the origin. Legs that turn are cut first, so that the sum is tight as well.
    """
    q = as_path(path)
    q = cut(q, np.maximum(1, np.ceil(np.abs(np.diff(q[:, 2])) / 0.1)).astype(np.int64))
    x, y, z = body.shape.vertices.T
    radius, angle = np.hypot(x, y), np.arctan2(y, x)
    low, high = np.full(2, np.inf), np.full(2, -np.inf)
    for a, b in pairwise(q):
        for axis, shift in ((0, 0.0), (1, -np.pi / 2)):  # y: sin t = cos(t - pi / 2)
            least, greatest = _cosine_range(angle + a[2] + shift, angle + b[2] + shift)
            low[axis] = min(low[axis], min(a[axis], b[axis]) + (radius * least).min())
            high[axis] = max(high[axis], max(a[axis], b[axis]) + (radius * greatest).max())
    box = np.array([[*low, body.height + z.min()], [*high, body.height + z.max()]])
    rounding = 1e-12 * (1.0 + np.abs(box).max())
    return np.asarray(box + [[-rounding], [rounding]])


def boxes_meet(a: Floats, b: Floats) -> bool:
    """Whether two boxes (2, 3) share a point; touching counts."""
    return bool((a[0] <= b[1]).all() and (b[0] <= a[1]).all())


def set_masks(mover: Body, others: Iterable[Body], path: Floats) -> Floats:
    """Set the mover's bit in its own mask and in those of the bodies that its motion may meet.

    All other bodies lose the bit: a new path projects and sets anew. Returns the motion box.
    """
    box = motion_box(mover, path)
    mover.collision_mask |= mover.own_bit
    for body in others:
        if boxes_meet(box, body.bounds):
            body.collision_mask |= mover.own_bit
        else:
            body.collision_mask &= ~mover.own_bit
    return box


def clear_masks(mover: Body, others: Iterable[Body]) -> None:
    """Take the mover's bit back after its motion."""
    for body in (mover, *others):
        body.collision_mask &= ~mover.own_bit


def must_test(mover: Body, other: Body) -> bool:
    """Whether the pair has to be tested: the other's mask holds the mover's own bit."""
    return mover.own_bit & other.collision_mask != 0


def _cosine_range(start: Floats, end: Floats) -> tuple[Floats, Floats]:
    """Least and greatest cosine over each interval of angles from start to end (rad)."""
    low, high, turn = np.minimum(start, end), np.maximum(start, end), 2 * np.pi
    over_top = np.floor(high / turn) >= np.ceil(low / turn)
    over_bottom = np.floor((high - np.pi) / turn) >= np.ceil((low - np.pi) / turn)
    at_low, at_high = np.cos(low), np.cos(high)
    least = np.where(over_bottom, -1.0, np.minimum(at_low, at_high))
    greatest = np.where(over_top, 1.0, np.maximum(at_low, at_high))
    return least, greatest
