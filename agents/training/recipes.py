"""Recipes of the built-in scenarios: observations, rewards, curricula and hyperparameters."""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType
from typing import Any

from fgenv.agents.policies.orca import GUIDED
from fgenv.agents.training.config import Overrides, Recipe, Stage, overrides
from fgenv.envs import Observation, Reward


def three_stages(*variants: Overrides, **base: Any) -> tuple[Stage, ...]:
    """Return the common curriculum: bodies pass through each other at a low cost, then at a high
    cost, and then stop at contacts."""
    last = Stage(0.2, collision_weight=-1.0, base=overrides(**base), variants=variants)
    return (
        replace(last, share=0.3, collision_weight=-0.3, on_collision="pass"),
        replace(last, share=0.5, on_collision="pass"),
        last,
    )


def circles(*counts: int) -> tuple[Overrides, ...]:
    """Return circles of these numbers of robots, with and without noise; also wider small ones."""
    wide = tuple(overrides(n=n, jitter=0.3, vary=0.5) for n in counts if n < 12)
    return tuple(overrides(n=n, jitter=j) for n in counts for j in (0.0, 0.3)) + wide


FAR_SIGHTED = 0.997  # discount; at 0.99, waiting for 3 s would cost a quarter of the return
REWARD = Reward({"progress": 1.0, "arrival": 5.0, "collision": -1.0, "time": -0.03})
NEIGHBORS = Observation(lidar=False, neighbors=6, pad=True)
PATH_AND_NEIGHBORS = replace(GUIDED, neighbors=6, neighbor_range=3.0, intent=True)
LIDAR = Observation(rays=16, lidar_range=4.0, pad=True)

CIRCLES = tuple(overrides(n=n, jitter=j) for n in (4, 8, 12, 20) for j in (0.0, 0.3))
LONG = tuple(overrides(n=n, jitter=0.3) for n in (4, 6, 8))
FEW = tuple(overrides(n=n) for n in (2, 4, 6, 8))
DISCS = Recipe(  # wide circles and costly collisions teach to wait
    replace(NEIGHBORS, neighbors=3),
    REWARD,
    (
        Stage(0.3, collision_weight=-0.5, on_collision="pass", variants=LONG),
        Stage(0.25, collision_weight=-1.0, on_collision="pass", variants=circles(4, 8, 12)),
        Stage(0.3, collision_weight=-1.0, on_collision="pass", variants=circles(4, 8, 12, 20)),
        Stage(0.15, collision_weight=-1.0, variants=circles(4, 8, 12, 20)),
    ),
    gamma=FAR_SIGHTED,
    steps=8_000_000,
)
WHEEPATH_AND_NEIGHBORS_BARS = replace(
    DISCS,
    stages=(
        Stage(0.3, collision_weight=-0.5, on_collision="pass", variants=LONG),
        Stage(0.5, collision_weight=-1.0, on_collision="pass", variants=circles(4, 6, 8)),
        Stage(0.2, collision_weight=-1.0, variants=circles(4, 6, 8)),
    ),
)
BARS = Recipe(
    NEIGHBORS,
    REWARD,
    three_stages(*CIRCLES, vary=0.5),
    cases=100,
    near=0.3,
    rows=512,
    steps=12_000_000,
)
BODIES = replace(BARS, stages=three_stages(*LONG, vary=0.5))
PATIENT_REWARD = Reward({**REWARD.weights, "obstacle": -1.0, "time": -0.01})  # waiting is cheap
CLUTTER = Recipe(  # ORCA avoids most collisions, so that they are costly from the start
    PATH_AND_NEIGHBORS,
    PATIENT_REWARD,
    (Stage(1.0, collision_weight=-5.0, variants=(overrides(n=4), overrides(n=10))),),
    cases=150,
    near=0.3,
    residual=1.0,
    orca=True,
    log_std_init=-1.2,
    learning_rate=3e-4,
    rows=512,
    max_steps=400,
    gamma=FAR_SIGHTED,
    steps=1_200_000,
)
HALL = replace(
    CLUTTER,
    observation=replace(PATH_AND_NEIGHBORS, neighbors=4, priority=True),
    stages=(Stage(1.0, collision_weight=-5.0, variants=FEW),),
    residual=0.7,
    steps=600_000,
)
JUNCTION = Recipe(  # held noise explores the order in which robots wait
    replace(
        PATH_AND_NEIGHBORS,
        neighbors=3,
        neighbor_range=8.0,
        rays=24,
        lidar_range=6.0,
        look_ahead=1.5,
        priority=True,
        intent=False,
    ),
    PATIENT_REWARD,
    (
        Stage(0.8, collision_weight=-5.0, on_collision="pass", variants=FEW[1:]),
        Stage(0.2, collision_weight=-5.0, variants=FEW[1:]),
    ),
    cases=150,
    near=0.5,
    residual=1.0,
    log_std_init=-1.5,
    sde_sample_freq=16,
    learning_rate=6e-4,
    rows=512,
    gamma=0.998,
    steps=8_000_000,
)
WOOD = Recipe(  # the drone's own lidar has vertical rays, since treetops are below it
    Observation(neighbors=4, neighbor_range=5.0, intent=True, pad=True),
    PATIENT_REWARD,
    (Stage(1.0, collision_weight=-10.0, on_collision="pass", variants=FEW[1:]),),
    cases=100,
    near=0.5,
    residual=1.0,
    log_std_init=-0.7,
    rows=512,
    gamma=FAR_SIGHTED,
    steps=12_000_000,
)
ANY = Recipe(LIDAR, REWARD, (Stage(1.0),))

RECIPES: tuple[tuple[str, Overrides, Recipe], ...] = (
    ("swap", overrides(), DISCS),
    ("swap", overrides(body="long"), WHEEPATH_AND_NEIGHBORS_BARS),
    ("swap", overrides(body="long", drive="holonomic"), BARS),
    ("swap", overrides(body="l"), replace(BODIES, steps=6_000_000)),
    ("swap", overrides(body="l", drive="differential"), WHEEPATH_AND_NEIGHBORS_BARS),
    ("doorway", overrides(), HALL),
    ("corridor", overrides(), HALL),
    ("warehouse", overrides(), HALL),
    ("intersection", overrides(), JUNCTION),
    ("random", overrides(), CLUTTER),
    ("forest", overrides(), WOOD),
)


def recipe_of(scenario: str, given: Overrides = MappingProxyType({})) -> Recipe:
    """Return the most specific recipe of a built-in scenario with overrides, or a general one."""
    fitting = [
        (len(required), recipe)
        for name, required, recipe in RECIPES
        if name == scenario and required.items() <= given.items()
    ]
    return max(fitting, key=lambda item: item[0])[1] if fitting else ANY
