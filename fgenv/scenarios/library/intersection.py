"""Cars from four roads cross where these meet."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field

from fgenv.scenarios.errors import Problem, ScenarioError
from fgenv.scenarios.registry import N, Seed, Size, builtin
from fgenv.scenarios.rng import Dice, micro
from fgenv.scenarios.scenario import Scenario

from .placing import CROWDED, Q, area, bare, block, body, sent, team

LANE, PITCH = 2.0, 3.5  # meters: width of a lane, room of a car in a queue
CAR = {"kind": "car", "length": 2.5, "width": 1.2, "height": 1.2}
TURNING = {
    "car": {"wheelbase": 1.5, "min_turning_radius": 2.0},
    "differential": {"turn_rate": 2.0},
    "holonomic": {"turn_rate": 2.0},
}
TURNS = ((1, 0), (0, 1), (-1, 0), (0, -1))  # cosine and sine of quarter turns: east, north, ...


@builtin(dimension=2)
def intersection(
    n: N = 8,
    seed: Seed = 0,
    size: Size = None,
    jitter: Annotated[float, Field(ge=0, le=0.3, strict=True)] = 0.2,
    drive: Literal["car", "differential", "holonomic"] = "car",
) -> Scenario:
    """Cars from four roads cross at a junction: straight on, to the left or to the right.

    Args:
        n: cars; a queue for each road, on the right-hand side.
        seed: of the routes.
        size: length of both crossing roads, meters; grows with n if left out.
        jitter: meters that a car stands off its lane's middle, 0.3 at most.
        drive: car; or, of the same size, what turns on the spot (differential) or goes any way
            (holonomic).
    """
    queue = math.ceil(n / 4)
    side = size or micro(2 * (LANE + 1.0 + queue * PITCH))
    if side < 2 * (LANE + 1.0 + queue * PITCH):
        told = f"a queue of {queue} cars does not fit into {side:g} m"
        raise ScenarioError("intersection", [Problem(told, CROWDED)])
    quarter = micro(side / 2 - LANE - 0.3)
    driven = {"kind": drive, "speed": 3.0, **TURNING[drive]}
    corners = [(i, j) for i in (-1, 1) for j in (-1, 1)]
    at = LANE + 0.3 + quarter / 2
    scenario = bare(
        "intersection",
        description=f"{n} cars from four roads cross at a junction, driving on the right.",
        seed=seed,
        workspace=area(side, side),
        shapes={"car": CAR, "block": block(quarter, quarter, 0.8)},
        models={"car": {"shape": "car", "drive": driven, "lidar": {"rays": 72, "range": 15.0}}},
        robots=team(n, "car", 3, goal_tolerance={"position": 0.3, "angle": 0.3}),
        bodies=[body("block", i * at, j * at) for i, j in corners],
    )
    dice = Dice(seed, 4)
    starts: list[Q] = []
    goals: list[Q] = []
    while len(starts) < n:  # four at a time, each to a road of its own
        row, ways = len(starts) // 4, dice.shuffled(range(4))
        while any(road == way for road, way in enumerate(ways)):
            ways = dice.shuffled(range(4))
        for road, way in list(enumerate(ways))[: n - len(starts)]:
            off = [dice.between(-jitter, jitter) for _ in range(2)]
            starts.append(_queued(road, LANE + 1.0 + row * PITCH + 2.0, LANE / 2 + off[0], True))
            far = LANE + 1.0 + (queue - 1 - row) * PITCH + 0.5
            goals.append(_queued(way, far, -LANE / 2 + off[1], False))
    return sent(scenario, starts, goals)


def _queued(road: int, far: float, left: float, inwards: bool) -> Q:
    """A car `far` out on a road, `left` of its middle seen outwards; it goes in or out."""
    x, y = TURNS[road]
    yaw = math.remainder(math.pi / 2 * road + (math.pi if inwards else 0.0), 2 * math.pi)
    return micro(far * x - left * y), micro(far * y + left * x), micro(yaw)
