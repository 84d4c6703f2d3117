"""Two teams change rooms through one door."""

from __future__ import annotations

import math

from fgenv.scenarios.registry import Drive, Meters, N, Seed, Size, builtin
from fgenv.scenarios.rng import Dice, micro
from fgenv.scenarios.scenario import Scenario

from .placing import Q, area, bare, block, body, fence, scatter, sent, team

RADIUS, WALL, HEIGHT = 0.25, 0.2, 0.6  # meters


@builtin(dimension=2)
def doorway(
    n: N = 6,
    seed: Seed = 0,
    size: Size = None,
    gap: Meters = 0.9,
    drive: Drive = "differential",
) -> Scenario:
    """Two rooms, one door: each half of the team goes to the other room.

    Args:
        n: robots.
        seed: of starts and goals.
        size: length of both rooms together, meters; grows with n if left out.
        gap: width of the door, meters; a robot is 0.5 wide.
        drive: differential or holonomic.
    """
    width = size or micro(max(6.0, math.sqrt(4.0 * n)))
    depth = micro(0.6 * width)
    jamb = (depth - gap) / 2
    if jamb < 0.05:
        raise ValueError(f"gap: {gap:g} m, the wall is {depth:g} m long; expected a narrower door")
    shapes, bodies = fence(width, depth)
    for side, name in ((-1, "wall south"), (1, "wall north")):
        bodies.append(body("jamb", 0.0, side * (depth - jamb) / 2, name=name))
    disc = {"kind": "disc", "radius": RADIUS, "height": 0.35}
    driven = {"kind": drive, "speed": 1.0, "turn_rate": 2.0}
    scenario = bare(
        "doorway",
        description=f"{n} robots change rooms through a door of {gap:g} m.",
        seed=seed,
        workspace=area(width, depth),
        shapes={"disc": disc, "jamb": block(WALL, jamb, HEIGHT), **shapes},
        models={"disc": {"shape": "disc", "drive": driven, "lidar": {"rays": 36}}},
        robots=team(n, "disc", 3),
        bodies=bodies,
    )
    dice = Dice(seed, 2)

    def place(side: int) -> Q:
        """Anywhere in the room to the left (-1) or the right (1)."""
        x = side * dice.between(WALL, width / 2)
        y = dice.between(-depth / 2, depth / 2)
        return x, y, dice.between(-math.pi, math.pi)

    starts = scatter(scenario, lambda i: place((-1) ** i), margin=0.1)
    return sent(scenario, starts, scatter(scenario, lambda i: place(-((-1) ** i)), margin=0.1))
