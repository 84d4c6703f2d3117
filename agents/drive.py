"""Driving a scene's mover along a path under collision masks, step by step."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fgenv.agents.events import Arrived, Hit, MasksCleared, MasksSet, Report, masks_of, silent
from fgenv.agents.path_follower import PathFollower
from fgenv.collision import collide, contact
from fgenv.scenarios import Body, Scene, clear_masks, must_test, set_masks
from fgenv.scenarios.planar import Floats, as_path, as_poses, reach

BRACKET = 1e-6  # metres of motion that a first contact is bracketed to


@dataclass(frozen=True)
class Drive:
    """How a drive went: its masks before, during and after, the path driven, what it hit.

    `driven` (k, 3) ends at the goal, or at the last step before the contact; `tests` counts the
    pairs tested, `without_masks` the pairs there would have been.
    """

    before: dict[str, int]
    masks: MasksSet
    driven: Floats
    start: float
    end: float
    speed: float
    steps: int
    tests: int
    without_masks: int
    hit: Hit | None
    cleared: MasksCleared


def drive(
    scene: Scene,
    path: ArrayLike,
    *,
    speed: float = 0.5,
    step: float = 0.01,
    start: float = 0.0,
    report: Report = silent,
) -> Drive:
    """Drive the mover along a path (n, 3) until its end or until it touches a body.

    In a step no point of the mover goes farther than `step` metres; at each step the mover is
    tested against the bodies that its masks leave. On contact it stands at the last free step.
    """
    mover, q = scene.mover, as_path(path)
    follower = PathFollower(q, speed=speed, radius=reach(mover.shape.vertices))
    ticks = follower.ticks(step)
    before = masks_of(scene)
    box = set_masks(mover, scene.obstacles, q)
    masks = MasksSet(start, q, box, masks_of(scene))
    report(masks)
    hit, tests, last, steps = None, 0, 0.0, 0
    try:
        for tick, now in zip(ticks.tolist(), follower.at(ticks), strict=True):
            pairs = [body for body in scene.obstacles if must_test(mover, body)]
            tests, steps = tests + len(pairs), steps + 1
            touched = [body for body in pairs if _touches(mover, now, body)]
            if touched:
                hits = [_first_contact(mover, b, follower, last, tick, start) for b in touched]
                hit = min(hits, key=lambda event: event.time)
                report(hit)
                break
            mover.configuration, last = _triple(now), tick
    finally:
        clear_masks(mover, scene.obstacles)
    end = start + follower.duration if hit is None else hit.time
    cleared = MasksCleared(end, masks_of(scene))
    report(cleared)
    if hit is None:
        report(Arrived(end, mover.configuration))
    every = steps * len(scene.obstacles)
    driven = follower.until(last)
    return Drive(before, masks, driven, start, end, speed, steps, tests, every, hit, cleared)


def _touches(mover: Body, q: Floats, body: Body) -> bool:
    return bool(collide(mover.shape, as_poses(q, mover.height), body.shape, body.pose))


def _first_contact(
    mover: Body, body: Body, follower: PathFollower, free: float, hit: float, start: float
) -> Hit:
    """Halve the time between a free step and a colliding one until the bracket is small."""
    seen = hit
    while (hit - free) * follower.speed > BRACKET:
        middle = (free + hit) / 2
        if _touches(mover, follower.at(middle), body):
            hit = middle
        else:
            free = middle
    before, after = follower.at([free, hit])
    found = contact(mover.shape, as_poses(after, mover.height), body.shape, body.pose)
    if found is None:
        raise AssertionError(f"{mover.name} and {body.name} collide without a contact")
    return Hit(
        time=start + hit,
        seen=start + seen,
        mover=mover.name,
        body=body.name,
        before=_triple(before),
        after=_triple(after),
        bracket=(hit - free) * follower.speed,
        contact=found,
    )


def _triple(q: Floats) -> tuple[float, float, float]:
    x, y, yaw = np.asarray(q).tolist()
    return x, y, yaw
