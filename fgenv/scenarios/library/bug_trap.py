"""A rod in a bug trap."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from fgenv.scenarios.registry import Seed, builtin
from fgenv.scenarios.rng import Dice
from fgenv.scenarios.scenario import Scenario

from .placing import Q, bare, scatter, sent, team
from .quaternion import any_way, pose

RADIUS, WALL, HALF = 1.0, 0.05, 2.0  # meters: of the trap; half a side of the workspace
ROD = {"kind": "cylinder", "radius": 0.04, "length": 0.5}
Throat = Annotated[float, Field(ge=0.05, le=0.4, strict=True)]


@builtin(dimension=3, most=1, driven=False)
def bug_trap(seed: Seed = 0, throat: Throat = 0.1) -> Scenario:
    """A rod in a hollow ball has to find the narrow end of the funnel that leads in.

    For planners: a body that turns any way has no drive.

    Args:
        seed: of start and goal.
        throat: radius of the funnel's narrow end, meters, 0.05 to 0.4; the rod's is 0.04.
    """
    trap = {"kind": "bug_trap", "radius": RADIUS, "wall": WALL, "throat": throat}
    scenario = bare(
        "bug_trap",
        description="A rod leaves a bug trap by its funnel.",
        seed=seed,
        workspace={"low": (-HALF,) * 3, "high": (HALF,) * 3},
        shapes={"rod": ROD, "trap": trap},
        models={"rod": {"shape": "rod", "base": "free"}},
        robots=team(1, "rod", 7, goal_tolerance={"position": 0.05, "angle": 0.1}),
        bodies=[{"name": "trap", "shape": "trap", "groups": ("glass",)}],
    )
    dice = Dice(seed, 10)

    def place(low: float, high: float) -> Q:
        """Anywhere in a cube without its upper half: below the funnel's end, or below the trap."""
        x, y = (dice.between(-0.5, 0.5) for _ in range(2))
        return pose(x, y, dice.between(low, high), any_way(dice))

    starts = scatter(scenario, lambda _: place(-0.6 * RADIUS, 0.0))
    return sent(scenario, starts, scatter(scenario, lambda _: place(-HALF, -1.3 * RADIUS)))
