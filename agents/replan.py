"""Driving to the goal: straight on, and around what is in the way, by a path planned anew."""

from dataclasses import dataclass, field

import numpy as np

from fgenv.agents.drive import Drive, drive
from fgenv.agents.events import Replanned, Report, silent
from fgenv.agents.path_follower import PathFollower
from fgenv.arrays import Floats
from fgenv.planners import PlanarChecker, PlanningError, plan_planar, prove_free
from fgenv.scenarios import Scene
from fgenv.scenarios.se2 import reach, travel


@dataclass
class Journey:
    """All drives of a journey in order, and the plan before each but the first."""

    drives: list[Drive] = field(default_factory=list)
    plans: list[Replanned] = field(default_factory=list)
    problem: str | None = None

    @property
    def arrived(self) -> bool:
        """Whether the last drive came to its end without contact."""
        return bool(self.drives) and self.drives[-1].hit is None


def drive_and_replan(
    scene: Scene,
    path: Floats,
    *,
    speed: float = 0.5,
    step: float = 0.01,
    margin: float = 0.05,
    seed: int = 0,
    time_limit: float = 20.0,
    report: Report = silent,
) -> Journey:
    """Drive along the path; on contact plan a new one to the scene's goal, and drive that.

    The new path first goes back the way it came to where nothing is nearer than `margin` meters;
    from there it keeps that margin, and is proved free before it is driven. Where there is none
    the journey ends, and its `problem` says why.
    """
    first = drive(scene, path, speed=speed, step=step, report=report)
    journey = Journey([first])
    if first.hit is None:
        return journey
    try:
        plan = replan(scene, first, margin=margin, seed=seed, time_limit=time_limit)
    except PlanningError as error:
        journey.problem = str(error)
        return journey
    report(plan)
    journey.plans.append(plan)
    journey.drives.append(
        drive(scene, plan.path, speed=speed, step=step, start=first.end, report=report)
    )
    return journey


def replan(
    scene: Scene, stopped: Drive, *, margin: float, seed: int, time_limit: float
) -> Replanned:
    """A path from where a drive stopped to the scene's goal; see `drive_and_replan`.

    Raises PlanningError where there is none.
    """
    world, mover = scene.world, scene.mover
    exact = PlanarChecker(world, mover, height=scene.height)
    careful = PlanarChecker(world, mover, height=scene.height, margin=margin)
    radius = reach(exact.shape.vertices)
    way_back = PathFollower(stopped.driven[::-1], speed=1.0, radius=radius)
    ticks = way_back.ticks(margin / 4)
    free = careful.free(way_back.at(ticks))
    if not free.any():
        raise PlanningError(f"nowhere on the way back are {margin:g} m free on all sides")
    retreat = way_back.until(ticks[free.argmax()])
    plan = plan_planar(careful, retreat[-1], scene.goal, seed=seed, time_limit=time_limit)
    path = np.concatenate([retreat[:-1], plan.path])
    back_off = float(travel(retreat, 0.0).sum())
    return Replanned(stopped.end, path, back_off, plan, prove_free(exact, plan.path))
