"""Two teams meet in a corridor that is too narrow for two, with bays to let others pass."""

from __future__ import annotations

import itertools
import math
from typing import Annotated, Any

from pydantic import Field

from fgenv.scenarios.registry import N, Seed, Size, builtin
from fgenv.scenarios.rng import Dice, micro
from fgenv.scenarios.scenario import Scenario

from .placing import Q, area, bare, block, body, fence, scatter, sent, team

WIDTH, BAY, DEEP = 0.9, 1.4, 0.9  # meters: of the corridor, of a bay along it, of a bay inwards


@builtin(dimension=2)
def corridor(
    n: N = 4,
    seed: Seed = 0,
    size: Size = None,
    bays: Annotated[int, Field(ge=0, le=64, strict=True)] | None = None,
) -> Scenario:
    """Carts from both ends of a corridor for one, with bays to let others pass.

    Args:
        n: robots.
        seed: of starts and goals.
        size: length of the corridor, meters; by the number of bays if left out.
        bays: number of bays, on alternate sides; default: half the number of robots, 2 to 8.
    """
    count = bays if bays is not None else min(8, max(2, math.ceil(n / 2)))
    long = size or micro(2.5 * max(2, count))
    if count * (BAY + 0.2) > long:
        raise ValueError(
            f"bays: {count} do not fit along {long:g} m; expected fewer, or larger size"
        )
    room = micro(max(3.0, math.sqrt(1.5 * n)))
    depth = max(room, WIDTH + 2 * DEEP + 0.4)
    shapes, bodies = fence(long + 2 * room, depth)
    more, walls = _walls(count, long, depth)
    drive = {"kind": "differential", "speed": 1.0, "turn_rate": 2.0}
    scenario = bare(
        "corridor",
        description=f"{n} carts change ends of a corridor for one, with {count} bays.",
        seed=seed,
        workspace=area(long + 2 * room, depth),
        shapes={"cart": {"kind": "cart", "length": 0.7, "width": 0.45}, **shapes, **more},
        models={"cart": {"shape": "cart", "drive": drive, "lidar": {"rays": 36}}},
        robots=team(n, "cart", 3),
        bodies=[*bodies, *walls],
    )
    dice = Dice(seed, 3)

    def place(side: int) -> Q:
        """Anywhere in the room at the left (-1) or the right (1) end."""
        x = side * dice.between(long / 2 + 0.4, long / 2 + room)
        return x, dice.between(-depth / 2, depth / 2), dice.between(-math.pi, math.pi)

    starts = scatter(scenario, lambda i: place((-1) ** i), margin=0.1)
    return sent(scenario, starts, scatter(scenario, lambda i: place(-((-1) ** i)), margin=0.1))


def _walls(bays: int, long: float, depth: float) -> tuple[dict[str, Any], list[Any]]:
    """The solid parts beside the corridor: all of it between bays, the rest behind a bay."""
    full, tall = (depth - WIDTH) / 2, 0.4
    shapes, bodies = {}, []
    for side, name in ((1, "left"), (-1, "right")):
        edges = [-long / 2]
        for k in range(bays):
            if k % 2 == (side < 0):
                middle = long * ((k + 0.5) / bays - 0.5)
                edges += [middle - BAY / 2, middle + BAY / 2]
        edges.append(long / 2)
        for k, (a, b) in enumerate(itertools.pairwise(edges)):
            deep = full - DEEP if k % 2 else full
            label = f"{name} {k + 1}"
            shapes[label] = block(b - a, deep, tall)
            bodies.append(body(label, (a + b) / 2, side * (depth - deep) / 2, name=label))
    return shapes, bodies
