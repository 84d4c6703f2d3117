"""The published experiment, and whether it came out as published."""

import time
import warnings
from dataclasses import dataclass

import numpy as np

from fgenv.agents.drive import Drive
from fgenv.agents.events import Report, silent
from fgenv.agents.path_follower import PathFollower
from fgenv.agents.replan import Journey, drive_and_replan
from fgenv.collision import MeshWarning, Shape, collide
from fgenv.paper import method
from fgenv.scenarios import Scene
from fgenv.scenarios.se2 import reach

EXPECTED = {"robot": 1, "tank 1": 0, "tank 2": 1, "tank 3": 1}  # masks during the first motion
HIT = "tank 2"


@dataclass
class Published:
    """What the published method says of the first motion: its masks, and when its `loop` graph
    first meets a body (s, at the steps of the run), or None where it never does."""

    masks: dict[str, int]
    time: float | None
    body: str | None


@dataclass
class Experiment:
    """The experiment's outcome."""

    scene: Scene
    seed: int
    journey: Journey
    published: Published
    seconds: float

    @property
    def checks(self) -> dict[str, bool]:
        """Each thing that the paper reports, and whether it came out."""
        first, again = self.journey.drives[0], self.journey.plans
        met = None if first.hit is None else first.hit.body
        cleared = [drive.cleared.masks for drive in self.journey.drives]
        return {
            "masks on the straight path: robot, tanks 2 and 3 are 1, tank 1 is 0": (
                first.masks.masks == EXPECTED
            ),
            "the published projection gives the same masks": self.published.masks == EXPECTED,
            "the collision with tank 2 is detected on the way": met == HIT,
            "all masks are 0 after each motion": not any(any(m.values()) for m in cleared),
            "the re-planned path leads to the goal without collision": (
                bool(again) and self.journey.arrived
            ),
        }

    @property
    def as_published(self) -> bool:
        """Whether all checks hold."""
        return all(self.checks.values())


def run_experiment(
    scene: Scene, *, seed: int = 0, step: float = 0.01, report: Report = silent
) -> Experiment:
    """Drive the scene's straight path, and around what is in the way; see `drive_and_replan`."""
    began = time.perf_counter()
    journey = drive_and_replan(scene, scene.straight_path, step=step, seed=seed, report=report)
    said = _published(scene, journey.drives[0], step)
    return Experiment(scene, seed, journey, said, time.perf_counter() - began)


def _published(scene: Scene, drive: Drive, step: float) -> Published:
    """The published masks and the published cycle on the same path, at the same steps."""
    nodes = [
        method.Node(b.id, b.name, b.shape.vertices, b.shape.faces.astype(np.int64), b.pose)
        for b in scene.records
    ]
    path = drive.masks.path
    on_floor = np.column_stack([path[:, :2], np.zeros(len(path))])
    method.set_masks(nodes, nodes[0], on_floor)
    mover, *others = scene.records
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MeshWarning)  # the scene's own shape has said it
        loop = Shape(mover.shape.vertices, mover.shape.faces, method="loop")
    follower = PathFollower(path, speed=drive.speed, radius=reach(mover.shape.vertices))
    ticks = follower.ticks(step)
    poses = scene.poses(follower.at(ticks))
    first: tuple[float, str | None] = np.inf, None
    for body, node in zip(others, nodes[1:], strict=True):
        if method.must_test(nodes[0], node):
            hits = np.asarray(collide(loop, poses, body.shape, body.pose))
            if hits.any():
                first = min(first, (float(ticks[hits.argmax()]), body.name))
    masks = {node.name: node.collision_mask for node in nodes}
    return Published(masks, first[0] if first[1] else None, first[1])
