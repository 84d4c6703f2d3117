"""Driving a scene's mover along a path under collision masks, step by step."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fgenv.agents.events import Arrived, Hit, MasksCleared, MasksSet, Report, silent
from fgenv.agents.path_follower import PathFollower
from fgenv.arrays import Floats
from fgenv.collision import contact
from fgenv.collision.world import TOLERANCE
from fgenv.scenarios import Scene
from fgenv.scenarios.se2 import as_path, reach


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

    In a step no point of the mover goes farther than `step` meters; each step is proved free of
    the bodies that the path's masks leave, before it is made. Where it is not, the first contact
    is told, and the mover stays at the last free step.
    """
    world, mover, q = scene.world, scene.mover, as_path(path)
    radius = reach(world.record(mover).shape.vertices)
    follower = PathFollower(q, speed=speed, radius=radius)
    ticks = follower.ticks(step)
    before, hit, tests, last, steps = scene.masks, None, 0, 0.0, 0
    poses = scene.poses(follower.at(ticks))
    world.set_path(mover, scene.poses(q))
    try:
        masks = MasksSet(start, q, world.motion_boxes(mover), scene.masks)
        report(masks)
        world.set_pose(mover, poses[0])
        for begun, seen, pose in zip(ticks[:-1], ticks[1:], poses[1:], strict=True):
            moved = world.check_motion(mover, world.poses(mover), pose)
            tests, steps = tests + int(moved.checks), steps + 1
            if not moved:
                hit = _hit(scene, follower, float(begun), float(seen), start)
                report(hit)
                break
            world.set_pose(mover, pose)
            last = float(seen)
    finally:
        world.clear_path(mover)
    end = start + follower.duration if hit is None else hit.time
    cleared = MasksCleared(end, scene.masks)
    report(cleared)
    if hit is None:
        report(Arrived(end, _triple(q[-1])))
    every, driven = steps * (len(world) - 1), follower.until(last)
    return Drive(before, masks, driven, start, end, speed, steps, tests, every, hit, cleared)


def _hit(scene: Scene, follower: PathFollower, begun: float, seen: float, start: float) -> Hit:
    """The first contact in the step from `begun` to `seen` seconds."""
    end = seen + 2 * TOLERANCE / follower.speed  # a step may end where the touch is to begin
    moved = scene.world.check_motion(scene.mover, *scene.poses(follower.at([begun, end])))
    mover, body = scene.world.record(scene.mover), scene.world.record(int(moved.other))
    free, met = (begun + float(f) * (end - begun) for f in (moved.contact, moved.contact_by))
    before, after = follower.at([free, end if moved.unresolved else met])
    found = contact(mover.shape, scene.poses(after), body.shape, body.pose)
    if found is None:
        raise RuntimeError(
            f"{mover.name} at {_triple(before)}: the step that follows is neither proved free of "
            f"{body.name} nor shown to touch it; take another step"
        )
    return Hit(
        time=start + met,
        seen=start + seen,
        mover=mover.name,
        body=body.name,
        before=_triple(before),
        after=_triple(after),
        bracket=(met - free) * follower.speed,
        contact=found,
    )


def _triple(q: Floats) -> tuple[float, float, float]:
    x, y, yaw = np.asarray(q).tolist()
    return x, y, yaw
