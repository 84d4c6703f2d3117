"""Carts among racks, and under them."""

from __future__ import annotations

import math

from fgenv.scenarios.errors import Problem, ScenarioError
from fgenv.scenarios.registry import N, Seed, Size, builtin
from fgenv.scenarios.rng import Dice, micro
from fgenv.scenarios.scenario import Scenario

from .placing import CROWDED, Q, area, bare, body, fence, scatter, sent, team

RACK = {"kind": "shelf", "length": 2.0, "depth": 1.0, "height": 1.6, "clear": 0.35, "levels": 3}
CELL = (3.4, 2.6)  # meters along x and y for a rack and the aisles beside it
TURNS = tuple(micro(k * math.pi / 2) for k in (0, 1, 2, -1))


@builtin(dimension=2)
def warehouse(n: N = 16, seed: Seed = 0, size: Size = None) -> Scenario:
    """Carts among racks: low enough to drive under them, between their legs; up to 64.

    Args:
        n: carts.
        seed: of starts and goals.
        size: side of the hall, meters; grows with n if left out.
    """
    side = size or micro(max(10.0, 2.2 * math.sqrt(n)))
    columns, rows = (int((side - 1.2) / pitch) for pitch in CELL)
    racks = [_middle(i, j, columns, rows) for j in range(rows) for i in range(columns)]
    spots = [(x, y, yaw) for x, y in racks for yaw in (0.0, TURNS[2])]
    for x, y in racks:
        aisle = [(x - CELL[0] / 2, y), (x + CELL[0] / 2, y)]
        aisle += [(x + dx, y + dy) for dx in (-0.55, 0.55) for dy in (-CELL[1] / 2, CELL[1] / 2)]
        spots += [(micro(u), micro(v), yaw) for u, v in aisle for yaw in TURNS]
    if len(racks) == 0:
        raise ScenarioError("warehouse", [Problem(f"no rack fits into {side:g} m", CROWDED)])
    shapes, bodies = fence(side, side)
    drive = {"kind": "differential", "speed": 1.5, "turn_rate": 2.0, "acceleration": 1.0}
    scenario = bare(
        "warehouse",
        description=f"{n} carts among {len(racks)} racks that they fit under.",
        seed=seed,
        horizon=120.0,
        workspace=area(side, side),
        shapes={"cart": {"kind": "cart"}, "rack": RACK, **shapes},
        models={"cart": {"shape": "cart", "drive": drive, "lidar": {"rays": 36}}},
        robots=team(n, "cart", 3),
        bodies=[*bodies, *(body("rack", x, y) for x, y in racks)],
    )
    dice = Dice(seed, 5)

    def place(_: int) -> Q:
        return dice.pick(spots)

    starts = scatter(scenario, place, margin=0.05)
    return sent(scenario, starts, scatter(scenario, place, margin=0.05))


def _middle(i: int, j: int, columns: int, rows: int) -> tuple[float, float]:
    """The middle of a rack."""
    return micro((i - (columns - 1) / 2) * CELL[0]), micro((j - (rows - 1) / 2) * CELL[1])
