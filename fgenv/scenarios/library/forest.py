"""Drones fly through a wood, across each other's ways."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field

from fgenv.scenarios.errors import Problem, ScenarioError
from fgenv.scenarios.registry import N, Seed, Size, builtin
from fgenv.scenarios.rng import Dice, micro
from fgenv.scenarios.scenario import Scenario
from fgenv.scenarios.schema import yaw_quaternion

from .placing import CROWDED, TRIES, Q, bare, body, scatter, sent, team

TREES = {
    "spruce": {"kind": "tree", "radius": 0.14, "height": 4.5, "crown": 0.9},
    "fir": {"kind": "tree", "radius": 0.12, "height": 3.6, "crown": 0.75},
    "sapling": {"kind": "tree", "radius": 0.08, "height": 2.4, "crown": 0.55},
}
APART, SHORE, TOP = 1.5, 1.2, 5.0  # meters: trees apart, free strip around them, ceiling


@builtin(dimension=3)
def forest(
    n: N = 6,
    seed: Seed = 0,
    size: Size = None,
    trees: Annotated[int, Field(ge=0, le=2000, strict=True)] | None = None,
) -> Scenario:
    """Drones cross a wood of conifers in three dimensions, half of them across the others' way.

    Args:
        n: drones.
        seed: of trees, starts and goals.
        size: side of the wood, meters; grows with n if left out.
        trees: one for 5 square meters if left out.
    """
    side = size or micro(max(12.0, 3.0 * math.sqrt(n) + 4.0))
    count = trees if trees is not None else int((side - 2 * SHORE) ** 2 / 5)
    dice, kinds = Dice(seed, 6), list(TREES)
    stand = [
        body(kinds[k % 3], x, y, dice.between(-math.pi, math.pi), name=f"tree {k + 1}")
        for k, (x, y) in enumerate(_stand(count, side - 2 * SHORE, dice))
    ]
    drive = {"kind": "drone", "speed": 2.0, "turn_rate": 2.0, "climb": 1.0, "acceleration": 4.0}
    lidar = {"rays": 24, "rows": 5, "rise": micro(math.pi / 2), "range": 8.0}
    half = micro(side / 2)
    scenario = bare(
        "forest",
        description=f"{n} drones cross a wood of {count} trees.",
        seed=seed,
        workspace={"low": (-half, -half, 0.2), "high": (half, half, TOP)},
        shapes={"drone": {"kind": "quadcopter"}, **TREES},
        models={"drone": {"shape": "drone", "base": "free", "drive": drive, "lidar": lidar}},
        robots=team(n, "drone", 7, goal_tolerance={"position": 0.3, "angle": 3.2}),
        bodies=stand,
    )

    def place(i: int, end: int) -> Q:
        """At the edge of the wood: even robots go along x, odd ones along y."""
        out = end * dice.between(half - SHORE, half)
        along = dice.between(-half + SHORE, half - SHORE)
        x, y = (out, along) if i % 2 == 0 else (along, out)
        yaw = 0.0 if i % 2 == 0 else math.pi / 2
        return (x, y, dice.between(0.8, 3.2), *map(micro, yaw_quaternion(yaw)))

    starts = scatter(scenario, lambda i: place(i, -1), margin=0.2)
    return sent(scenario, starts, scatter(scenario, lambda i: place(i, 1), margin=0.2))


def _stand(count: int, side: float, dice: Dice) -> list[tuple[float, float]]:
    """Where trees stand, no two nearer than `APART`."""
    found: list[tuple[float, float]] = []
    misses = 0  # in a row
    while len(found) < count:
        x, y = (dice.between(-side / 2, side / 2) for _ in range(2))
        if all((x - u) ** 2 + (y - v) ** 2 >= APART**2 for u, v in found):
            found.append((x, y))
            misses = 0
        elif (misses := misses + 1) == TRIES:
            told = Problem(f"{count} trees do not fit", f"{CROWDED}, or fewer trees")
            raise ScenarioError("forest", [told])
    return found
