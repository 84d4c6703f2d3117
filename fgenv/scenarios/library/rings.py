"""Two linked rings with a gap each."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field

from fgenv.scenarios.registry import Seed, builtin
from fgenv.scenarios.rng import Dice, micro
from fgenv.scenarios.scenario import Scenario

from .placing import Q, bare, scatter, sent, team
from .quaternion import about, after, any_way, pose

RADIUS, BAR, HALF = 0.5, 0.14, 1.8  # meters: of a ring, of its bar (diameter), of the workspace
TURN = 6.9  # rad, that a ring's bar goes round: its ends overlap by a tenth
Gap = Annotated[float, Field(ge=0.15, le=1.0, strict=True)]


@builtin(dimension=3, most=1, driven=False)
def rings(seed: Seed = 0, gap: Gap = 0.15) -> Scenario:
    """Two linked rings have to be pulled apart through the gap between their ends, which overlap.

    For planners: a body that turns any way has no drive.

    Args:
        seed: of start and goal.
        gap: meters between the ends of a ring, 0.15 to 1; its bar is 0.14 thick.
    """
    sizes = {"radius": RADIUS, "thickness": BAR, "turn": TURN, "rise": micro(BAR + gap)}
    scenario = bare(
        "rings",
        description="Two linked rings are pulled apart through a gap.",
        seed=seed,
        workspace={"low": (-HALF,) * 3, "high": (HALF,) * 3},
        shapes={"ring": {"kind": "open_ring", **sizes}},
        models={"ring": {"shape": "ring", "base": "free"}},
        robots=team(1, "ring", 7, goal_tolerance={"position": 0.05, "angle": 0.1}),
        bodies=[{"name": "ring", "shape": "ring"}],
    )
    dice = Dice(seed, 11)

    def linked() -> Q:
        """Upright, around the back of the ring that lies, its gap outside of that."""
        x, y, z = (dice.between(-0.1, 0.1) for _ in range(3))
        tilt = after(about(2, dice.between(-0.3, 0.3)), about(0, math.pi / 2))
        opening = about(2, math.pi + dice.between(-0.8, 0.8))
        return pose(micro(x - RADIUS), y, z, after(tilt, opening))

    def apart() -> Q:
        """Behind the ring that lies."""
        y, z = (dice.between(-0.5, 0.5) for _ in range(2))
        return pose(dice.between(-HALF, -1.3), y, z, any_way(dice))

    starts = scatter(scenario, lambda _: linked())
    return sent(scenario, starts, scatter(scenario, lambda _: apart()))
