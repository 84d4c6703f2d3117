"""Discs among clutter, solvable by construction.

Obstacles lie in the cells of a lattice and keep clear of its lines, along which a robot fits.
Robots start and end on the crossings of the lines. So a robot can go from a crossing to a free one
beside it while all others stand. At least two crossings stay free, and the lattice is a graph in
which every edge is on a cycle and which is no single cycle: then any arrangement of robots can be
brought into any other by such moves (Kornhauser, Miller, Spirakis 1984, 'Coordinating pebble motion
on graphs').
"""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field

from fgenv.scenarios.errors import Problem, ScenarioError
from fgenv.scenarios.registry import Drive, N, Seed, Size, builtin
from fgenv.scenarios.rng import Dice, micro
from fgenv.scenarios.scenario import Scenario

from .placing import CROWDED, Q, area, bare, block, body, sent, team

PITCH, CLEAR = 2.0, 0.4  # meters: between lines; from a line to the next obstacle, at least
DISC = {"kind": "disc", "radius": 0.3, "height": 0.35}  # the prism reaches 0.306 m
CLUTTER = {  # and how far each gets from its origin, meters
    "crate": (block(0.7, 0.5, 0.5), 0.44),
    "barrel": ({"kind": "disc", "radius": 0.4, "height": 0.7}, 0.41),
    "corner": ({"kind": "l", "length": 0.7, "width": 0.6, "arm": 0.2, "height": 0.5}, 0.47),
    "plank": (block(0.95, 0.2, 0.4), 0.49),
}


@builtin(dimension=2)
def random_(
    n: N = 8,
    seed: Seed = 0,
    size: Size = None,
    fill: Annotated[float, Field(ge=0, le=1, strict=True)] = 0.8,
    drive: Drive = "differential",
) -> Scenario:
    """Discs among random clutter, solvable by construction.

    Args:
        n: robots.
        seed: of obstacles, starts and goals.
        size: side of the field, meters, at least 5; grows with n if left out.
        fill: share of the lattice's cells that hold an obstacle.
        drive: differential or holonomic.
    """
    cells = int((size - 1.0) / PITCH) if size else max(3, math.ceil(math.sqrt(2 * n)))
    if cells < 2 or (cells + 1) ** 2 < n + 2:
        told = f"{max(0, cells + 1) ** 2} crossings are too few for {n} robots"
        raise ScenarioError("random", [Problem(told, CROWDED)])
    side = size or cells * PITCH + 1.0
    dice, names = Dice(seed, 7), list(CLUTTER)
    inside = dice.shuffled([(i, j) for i in range(cells) for j in range(cells)])
    bodies = []
    for k, (i, j) in enumerate(inside[: round(fill * len(inside))]):
        name = names[k % len(names)]
        slack = PITCH / 2 - CLEAR - CLUTTER[name][1]
        x, y = (_line(c + 0.5, cells) + dice.between(-slack, slack) for c in (i, j))
        bodies.append(body(name, x, y, dice.between(-math.pi, math.pi)))
    driven = {"kind": drive, "speed": 1.0, "turn_rate": 2.0}
    scenario = bare(
        "random",
        description=f"{n} discs among {len(bodies)} obstacles.",
        seed=seed,
        workspace=area(side, side),
        shapes={"disc": DISC, **{name: form for name, (form, _) in CLUTTER.items()}},
        models={"disc": {"shape": "disc", "drive": driven, "lidar": {"rays": 36}}},
        robots=team(n, "disc", 3),
        bodies=bodies,
    )
    return sent(scenario, _crossings(n, cells, dice), _crossings(n, cells, dice))


def _line(k: float, cells: int) -> float:
    """Where line k of the lattice is, meters."""
    return micro((k - cells / 2) * PITCH)


def _crossings(n: int, cells: int, dice: Dice) -> list[Q]:
    """n crossings of lines, each with any yaw."""
    every = [(_line(i, cells), _line(j, cells)) for i in range(cells + 1) for j in range(cells + 1)]
    return [(x, y, dice.between(-math.pi, math.pi)) for x, y in dice.shuffled(every)[:n]]
