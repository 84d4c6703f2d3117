"""Robots on a circle change places with those across."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field

from fgenv.scenarios.registry import Drive, N, Seed, Size, builtin
from fgenv.scenarios.rng import Dice, micro, sin_cos
from fgenv.scenarios.scenario import Scenario

from .placing import Q, area, bare, block, scatter, sent, team

BODIES = {
    "disc": {"kind": "disc", "radius": 0.3, "height": 0.35},
    "long": block(1.2, 0.3, 0.35),
    "l": {"kind": "l", "length": 1.0, "width": 0.8, "arm": 0.25, "height": 0.35},
}
ROOM = {"disc": 1.0, "long": 1.5, "l": 1.5}  # meters of the circle for each
DRIVES = {"disc": "differential", "long": "differential", "l": "holonomic"}


@builtin(dimension=2)
def swap(
    n: N = 8,
    seed: Seed = 0,
    size: Size = None,
    body: Literal["disc", "long", "l"] = "disc",
    jitter: Annotated[float, Field(ge=0, le=10, strict=True)] = 0.0,
    vary: Annotated[float, Field(ge=0, le=10, strict=True)] = 0.0,
    drive: Drive | None = None,
) -> Scenario:
    """Robots on a circle swap places with those across: discs, long or L-shaped bodies.

    Args:
        n: robots.
        seed: of the jitter, and of the circle.
        size: diameter of the circle, meters; grows with n if left out.
        body: disc, long or l.
        jitter: meters that starts and goals are moved along x and y, at most; 0 is symmetric.
        vary: share by which the circle is larger, at most; over 0 it is turned by any angle, too.
        drive: differential or holonomic; that of the body if left out.
    """
    least = size or micro(max(4.0, n * ROOM[body] / math.pi))
    side = least * (1 + vary) + 3.0 + 2 * jitter
    driven = {"kind": drive or DRIVES[body], "speed": 1.0, "turn_rate": 2.0}
    scenario = bare(
        "swap",
        description=f"{n} robots on a circle swap places with those across; body: {body}.",
        seed=seed,
        workspace=area(side, side),
        shapes={body: BODIES[body]},
        models={body: {"shape": body, "drive": driven, "lidar": {"rays": 36}}},
        robots=team(n, body, 3),
    )
    dice = Dice(seed, 1)
    diameter, phase = least, 0.0
    if vary > 0:
        diameter = dice.between(least, least * (1 + vary))
        phase = dice.between(-math.pi, math.pi)

    def place(i: int, end: int) -> Q:
        """Start (end 1) or goal (end -1) of robot i, across; it faces its goal in both."""
        angle = 2 * math.pi * i / n + phase
        y, x = sin_cos(angle)
        dx, dy = (dice.between(-jitter, jitter) for _ in range(2))
        r, yaw = 0.5 * end * diameter, math.remainder(angle + math.pi, 2 * math.pi)
        return micro(r * x + dx), micro(r * y + dy), micro(yaw)

    starts = scatter(scenario, lambda i: place(i, 1))
    return sent(scenario, starts, scatter(scenario, lambda i: place(i, -1)))
