"""Motion along a path under collision masks, certified step by step."""

from dataclasses import dataclass

from numpy.typing import ArrayLike

from fgenv.arrays import Floats
from fgenv.collision import ContactPoint, contact_point
from fgenv.collision.world import TOLERANCE
from fgenv.paper.scene import masks, robot_shape
from fgenv.paper.timed_path import TimedPath, radius_of
from fgenv.planners import Problem


@dataclass(frozen=True)
class FirstContact:
    """The first contact of the robot with a body.

    Attributes:
        time: simulated seconds of the contact.
        detected: simulated seconds at the end of the step that contains it.
        robot, body: names.
        before, after: configurations (3,), free just before and colliding just after.
        bracket: meters; no point of the robot moves more between `before` and `after`.
        contact: the feature edge and the face that intersect at `after`.
    """

    time: float
    detected: float
    robot: str
    body: str
    before: Floats
    after: Floats
    bracket: float
    contact: ContactPoint


@dataclass(frozen=True)
class Drive:
    """One drive along a path.

    Attributes:
        start, end: simulated seconds.
        speed: m/s, see `TimedPath`.
        path: (n, 3), the path to drive.
        motion_boxes: (n - 1, 2, 3), meters, of each leg.
        before, during, after: masks by name before, during and after the motion.
        driven: (k, 3), the path to the goal, or to the last step before the contact.
        steps, tests: steps checked and pairs of bodies tested in them.
        without_masks: pairs in the same steps without masks.
        hit: the first contact, None for a free drive.
    """

    start: float
    end: float
    speed: float
    path: Floats
    motion_boxes: Floats
    before: dict[str, int]
    during: dict[str, int]
    after: dict[str, int]
    driven: Floats
    steps: int
    tests: int
    without_masks: int
    hit: FirstContact | None


def drive(
    problem: Problem,
    path: ArrayLike,
    *,
    speed: float = 0.5,
    step: float = 0.01,
    start: float = 0.0,
) -> Drive:
    """Drive the problem's robot along a path (n, 3) to its end or to the first contact.

    No point of the robot moves more than `step` meters in a step. Each step is certified free of
    the bodies that the path's masks leave. In a step that is not free the first contact is located,
    and the robot stays at the end of the step before.
    """
    world, robot = problem.world, problem.robot_ids[0]
    timed = TimedPath(path, speed=speed, radius=radius_of(robot_shape(problem).vertices))
    ticks = timed.ticks(step)
    q = timed.at(ticks)
    before = masks(world)
    world.set_path(robot, timed.path)
    try:
        during, boxes = masks(world), world.motion_boxes(robot)
        motion = world.check_motion(robot, q[:-1], q[1:])
        free = int(motion.free.argmin()) if not motion else len(motion.free)  # steps before a hit
        steps = min(free + 1, len(motion.free))
        hit = None if motion else _first_contact(problem, timed, ticks[free : free + 2], start)
    finally:
        world.clear_path(robot)
    world.set_configuration(robot, q[free])
    return Drive(
        start=start,
        end=start + timed.duration if hit is None else hit.time,
        speed=speed,
        path=timed.path,
        motion_boxes=boxes,
        before=before,
        during=during,
        after=masks(world),
        driven=timed.until(float(ticks[free])),
        steps=steps,
        tests=int(motion.checks[:steps].sum()),
        without_masks=steps * (len(world) - 1),
        hit=hit,
    )


def _first_contact(problem: Problem, timed: TimedPath, step: Floats, start: float) -> FirstContact:
    """The first contact in the step between two times (2,) in seconds."""
    world, robot = problem.world, problem.robot_ids[0]
    begin, detected = step.tolist()
    end = detected + 2 * TOLERANCE / timed.speed  # the contact can begin at the end of the step
    motion = world.check_motion(robot, *timed.at([begin, end]))
    body = world.record(int(motion.other))
    free, hit = (begin + float(f) * (end - begin) for f in (motion.free_until, motion.contact_by))
    before, after = timed.at([free, end if motion.unresolved else hit])
    pose = problem.models[0].forward(after, 0)
    touch = contact_point(robot_shape(problem), pose, body.shape, body.pose)
    if touch is None:
        raise RuntimeError(
            f"step: the motion from {before.tolist()} is neither certified free of {body.name} nor"
            " shown to collide with it; take another step"
        )
    return FirstContact(
        time=start + hit,
        detected=start + detected,
        robot=problem.names[0],
        body=body.name,
        before=before,
        after=after,
        bracket=(hit - free) * timed.speed,
        contact=touch,
    )
