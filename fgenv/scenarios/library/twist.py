"""A twisted bar on its way through a twisted channel."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field

from fgenv.scenarios.registry import Seed, builtin
from fgenv.scenarios.rng import Dice
from fgenv.scenarios.scenario import Scenario

from .placing import Q, bare, body, scatter, sent, team
from .quaternion import any_way, pose

THICK, SIDE, TURN = 0.5, 2.6, math.pi / 2  # of the wall, meters; of the channel, rad
LENGTH, WIDTH, HEIGHT = 0.3, 0.8, 0.08  # meters, of the bar
OUT, ASIDE = 0.9, 0.5  # meters from the wall's middle that the bar may be along y, and along x, z
Clear = Annotated[float, Field(ge=0.03, le=0.3, strict=True)]


@builtin(dimension=3, most=1, driven=False)
def twist(seed: Seed = 0, clear: Clear = 0.2) -> Scenario:
    """A twisted bar has to screw itself through a narrow channel that turns by a right angle.

    For planners: a body that turns any way has no drive.

    Args:
        seed: of start and goal.
        clear: meters between bar and channel on each side, 0.03 to 0.3.
    """
    width, height, turn = WIDTH + 2 * clear, HEIGHT + 2 * clear, TURN
    wall = {"thickness": THICK, "side": SIDE, "width": width, "height": height, "turn": turn}
    bar = {"length": LENGTH, "width": WIDTH, "height": HEIGHT, "turn": TURN * LENGTH / THICK}
    scenario = bare(
        "twist",
        description="A twisted bar passes a wall by a channel that turns by a right angle.",
        seed=seed,
        workspace={"low": (-ASIDE, -OUT, -ASIDE), "high": (ASIDE, OUT, ASIDE)},
        shapes={"bar": {"kind": "twisted_bar", **bar}, "wall": {"kind": "twisted_wall", **wall}},
        models={"bar": {"shape": "bar", "base": "free"}},
        robots=team(1, "bar", 7, goal_tolerance={"position": 0.05, "angle": 0.1}),
        bodies=[body("wall", 0.0, 0.0, math.pi / 2, name="wall")],
    )
    dice = Dice(seed, 9)

    def place(side: int) -> Q:
        """Anywhere before (-1) or behind (1) the wall."""
        y = side * dice.between(THICK / 2, OUT)
        x, z = (dice.between(-ASIDE, ASIDE) for _ in range(2))
        return pose(x, y, z, any_way(dice))

    starts = scatter(scenario, lambda _: place(-1))
    return sent(scenario, starts, scatter(scenario, lambda _: place(1)))
