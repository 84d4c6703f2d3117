"""How a policy is trained in each scenario: what it sees, what it is paid for, in which order."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from fgenv.envs import Observation, Reward

Given = Mapping[str, Any]


@dataclass(frozen=True)
class Stage:
    """A part of a curriculum.

    Attributes:
        share: of all steps.
        starts: `scenario` or `random`, see `Simulator`.
        collision: what a step in contact is worth, in place of the reward's: little at first, or it
            learns to wait where others cross its way.
        response: to a collision, in place of the scenario's. Where bodies pass each other nobody
            gets stuck, so that it first learns what the way is worth, and steps are cheaper.
        given: overrides of the scenario (n, jitter...), under those of the command.
        mix: several of them, over `given`, of which rows have equal shares; what it learns in one
            alone it forgets in the next.
    """

    share: float
    starts: str = "scenario"
    collision: float | None = None
    response: str | None = None
    given: Given = field(default_factory=lambda: MappingProxyType({}))
    mix: tuple[Given, ...] = (MappingProxyType({}),)


@dataclass(frozen=True)
class Recipe:
    """What `train` does if it is not told otherwise.

    Attributes:
        stages: in order; their shares add up to 1. The last is what the policy is for.
        cases: of a scenario in each stage, each with a seed of its own.
        max_steps: of an episode while it learns.
        actions: `drive` or `way_points`, see `Simulator`. Way points suit drives that cannot go
            sideways: who is to go there turns, then drives.
        near: metres from the goal at which `goto` takes over; 0: it never does.
        steps: of robots, in all.
        rows: robots that are stepped at once, about.
        n_steps: of each row between two updates; batch, epochs: of an update.
        learning_rate: at first; it falls to 0 at the end.
        hidden: widths of the network's layers.
    """

    observation: Observation
    reward: Reward
    stages: tuple[Stage, ...]
    cases: int = 200
    max_steps: int = 300
    actions: str = "drive"
    near: float = 1.0
    steps: int = 4_000_000
    rows: int = 256
    n_steps: int = 64
    batch: int = 2048
    epochs: int = 5
    learning_rate: float = 1e-3
    gamma: float = 0.99
    gae_lambda: float = 0.95
    entropy: float = 0.0
    log_std: float = -0.5
    hidden: tuple[int, ...] = (64, 64)
    activation: str = "tanh"


PAID = Reward({"progress": 1.0, "arrival": 5.0, "collision": -1.0, "time": -0.03})
AMONG_ROBOTS = Observation(lidar=False, neighbours=3, pad=True)
AMONG_WALLS = Observation(rays=16, lidar_range=4.0, neighbours=4, pad=True)
IN_SPACE = Observation(neighbours=4, pad=True)

JITTERED = MappingProxyType({"jitter": 0.3})
SIZES = tuple(MappingProxyType({"n": n}) for n in (4, 6, 8))
SWAP = Recipe(
    AMONG_ROBOTS,
    PAID,
    (
        Stage(0.4, collision=-0.5, response="pass", given=JITTERED, mix=SIZES),
        Stage(0.4, collision=-1.0, response="pass", given=JITTERED, mix=SIZES),
        Stage(0.2, collision=-1.0, given=JITTERED, mix=SIZES),
    ),
    steps=5_000_000,
)
RANDOM = Recipe(
    AMONG_WALLS,
    PAID,
    (
        Stage(0.2, "random", -0.5, "pass", MappingProxyType({"n": 4, "fill": 0.2})),
        Stage(0.3, collision=-0.5, response="pass", given=MappingProxyType({"fill": 0.4})),
        Stage(0.5),
    ),
)
WALLS = Recipe(
    AMONG_WALLS,
    PAID,
    (Stage(0.3, collision=-0.5, response="pass", given=MappingProxyType({"n": 2})), Stage(0.7)),
)
SPACE = Recipe(
    IN_SPACE,
    PAID,
    (Stage(0.3, collision=-0.5, response="pass", given=MappingProxyType({"n": 2})), Stage(0.7)),
)
ANY = Recipe(AMONG_WALLS, PAID, (Stage(1.0),))

RECIPES: dict[str, Recipe] = {
    "swap": SWAP,
    "random": RANDOM,
    "doorway": WALLS,
    "corridor": WALLS,
    "intersection": WALLS,
    "warehouse": WALLS,
    "forest": SPACE,
}


def recipe_of(scenario: str) -> Recipe:
    """That of a built-in scenario; one that fits any other."""
    return RECIPES.get(scenario, ANY)
