"""The published experiment: drive, collide, plan around the obstacle, arrive."""

import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from fgenv.arrays import Floats
from fgenv.collision import MeshWarning, Shape, collide
from fgenv.paper import method
from fgenv.paper.drive import Drive, drive
from fgenv.paper.rrt_connect import PlanarPlan, rrt_connect
from fgenv.paper.scene import model_list, robot_shape
from fgenv.paper.timed_path import TimedPath, radius_of, travel
from fgenv.planners import PlanningError, Problem

EXPECTED_MASKS = {"robot": 1, "tank 1": 0, "tank 2": 1, "tank 3": 1}  # during the first drive
EXPECTED_HIT = "tank 2"


@dataclass(frozen=True)
class Replan:
    """A new path (n, 3) to the goal: `back_off` meters back along the driven path, then `plan`."""

    path: Floats
    back_off: float
    plan: PlanarPlan


@dataclass(frozen=True)
class Published:
    """The result of the published method on the first path.

    Attributes:
        masks: by name.
        time, body: simulated seconds and name of the first collision of its `loop` graph, at the
            steps of the drive; None without one.
    """

    masks: dict[str, int]
    time: float | None
    body: str | None


@dataclass
class Experiment:
    """The experiment's results.

    Attributes:
        problem: the scene; its world has the robot at the end of the last drive.
        drives: along the straight path, then along the path around the obstacle.
        replan: the path around the obstacle, None without one.
        failure: the reason why there is no path, or None.
        published: the published method on the first path, for comparison.
        seconds: wall-clock time.
    """

    problem: Problem
    drives: list[Drive] = field(default_factory=list)
    replan: Replan | None = None
    failure: str | None = None
    published: Published | None = None
    seconds: float = 0.0

    @property
    def arrived(self) -> bool:
        """Whether the last drive ended without contact."""
        return bool(self.drives) and self.drives[-1].hit is None

    @property
    def checks(self) -> dict[str, bool]:
        """Each result that the paper reports, and whether it was reproduced."""
        first, published = self.drives[0], self.published
        left = [mask for drive in self.drives for mask in drive.after.values()]
        return {
            "masks on the straight path: robot, tanks 2 and 3 are 1, tank 1 is 0": (
                first.during == EXPECTED_MASKS
            ),
            "the published projection gives the same masks": (
                published is not None and published.masks == EXPECTED_MASKS
            ),
            "the collision with tank 2 is detected on the way": (
                first.hit is not None and first.hit.body == EXPECTED_HIT
            ),
            "all masks are 0 after each motion": not any(left),
            "the re-planned path leads to the goal without collision": (
                self.replan is not None and self.arrived
            ),
        }

    @property
    def as_published(self) -> bool:
        """Whether all checks hold."""
        return all(self.checks.values())


def run_experiment(
    problem: Problem,
    *,
    path: Floats | None = None,
    speed: float = 0.5,
    step: float = 0.01,
    margin: float = 0.05,
    seed: int = 0,
    time_limit: float = 20.0,
    report: Callable[[Drive | Replan], None] = lambda result: None,
) -> Experiment:
    """Drive the straight path; after a contact, plan a path to the goal and drive it.

    Args:
        problem: the scene, see `three_tanks`; the robot of its world is moved.
        path: (n, 3), the first path; the straight one if left out.
        speed: m/s, of the fastest point of the robot.
        step: meters, see `drive`.
        margin: meters to all bodies on the planned path.
        seed, time_limit: of RRTConnect.
        report: called with each `Drive` and `Replan` as soon as it is known.
    """
    began = time.perf_counter()
    experiment = Experiment(problem)

    def follow(path: Floats, start: float) -> Drive:
        done = drive(problem, path, speed=speed, step=step, start=start)
        experiment.drives.append(done)
        report(done)
        return done

    ends = np.stack([problem.starts[0], problem.goals[0]])
    first = follow(ends if path is None else path, 0.0)
    if first.hit is not None:
        try:
            plan = plan_around(problem, first, margin=margin, seed=seed, time_limit=time_limit)
        except PlanningError as error:
            experiment.failure = str(error)
        else:
            experiment.replan = plan
            report(plan)
            follow(plan.path, first.end)
    experiment.published = published_result(problem, first, step)
    experiment.seconds = time.perf_counter() - began
    return experiment


def plan_around(
    problem: Problem, stopped: Drive, *, margin: float, seed: int, time_limit: float
) -> Replan:
    """Plan from the end of a drive to the goal.

    The path first goes back along the driven one to the nearest configuration with `margin` meters
    to all bodies, and keeps that margin from there.

    Raises:
        PlanningError: there is no such configuration, or no path.
    """
    radius = radius_of(robot_shape(problem).vertices)
    back = TimedPath(stopped.driven[::-1], speed=1.0, radius=radius)
    ticks = back.ticks(margin / 4)
    free = ~problem.world.collides(problem.robot_ids[0], back.at(ticks), margin=margin)
    if not free.any():
        raise PlanningError(f"no configuration on the driven path has {margin:g} m of clearance")
    retreat = back.until(ticks[free.argmax()])
    plan = rrt_connect(problem, retreat[-1], margin=margin, seed=seed, time_limit=time_limit)
    path = np.concatenate([retreat[:-1], plan.path])
    return Replan(path, float(travel(retreat, 0.0).sum()), plan)


def published_result(problem: Problem, drive: Drive, step: float) -> Published:
    """The published masks, and the published graph at each step of a drive."""
    bodies = model_list(problem.world)
    nodes = [
        method.Node(b.id, b.name, b.shape.vertices, b.shape.faces.astype(np.int64), b.pose)
        for b in bodies
    ]
    path = drive.path
    method.set_masks(nodes, nodes[0], np.column_stack([path[:, :2], np.zeros(len(path))]))
    robot = robot_shape(problem)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MeshWarning)  # the scene's shape has raised it
        loop = Shape(robot.vertices, robot.faces, method="loop")
    timed = TimedPath(path, speed=drive.speed, radius=radius_of(robot.vertices))
    ticks = timed.ticks(step)
    poses = problem.models[0].forward(timed.at(ticks), 0)
    hits: list[tuple[float, str]] = []
    for body, node in zip(bodies[1:], nodes[1:], strict=True):
        if method.must_test(nodes[0], node):
            collides = np.asarray(collide(loop, poses, body.shape, body.pose))
            if collides.any():
                hits.append((float(ticks[collides.argmax()]), body.name))
    masks = {node.name: node.collision_mask for node in nodes}
    return Published(masks, *min(hits, default=(None, None)))
