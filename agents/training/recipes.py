"""How a policy is trained in each scenario: what it sees, what it is paid for, in which order."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

from fgenv.agents.policies.orca import GUIDED
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
        near: meters from the goal at which `goto` takes over; 0: it never does.
        residual, orca: what a network's output counts beside that of `goto`, see
            `BaseAction`; 0: alone.
        steps: of robots, in all.
        rows: robots that are stepped at once, about.
        n_steps: of each row between two updates; batch, epochs: of an update.
        learning_rate: at first; with `anneal` it falls to 0 at the end.
        held: steps that the noise of exploration is held, a function of what is seen (A. Raffin et
            al., "Smooth exploration for robotic reinforcement learning", 2021); 0: it is drawn
            anew in each.
        hidden: widths of the network's layers.
    """

    observation: Observation
    reward: Reward
    stages: tuple[Stage, ...]
    cases: int = 200
    max_steps: int = 300
    actions: str = "drive"
    near: float = 1.0
    residual: float = 0.0
    orca: bool = False
    steps: int = 4_000_000
    rows: int = 256
    n_steps: int = 64
    batch: int = 2048
    epochs: int = 5
    learning_rate: float = 1e-3
    anneal: bool = True
    gamma: float = 0.99
    gae_lambda: float = 0.95
    entropy: float = 0.0
    log_std: float = -0.5
    held: int = 0
    hidden: tuple[int, ...] = (64, 64)
    activation: str = "tanh"


def some(**given: Any) -> Given:
    """Overrides of a scenario."""
    return MappingProxyType(given)


def staged(*mix: Given, **given: Any) -> tuple[Stage, ...]:
    """What most learn in: at first bodies pass through each other and that is cheap, then dear,
    and at last they stop."""
    return (
        Stage(0.3, collision=-0.3, response="pass", given=some(**given), mix=mix),
        Stage(0.5, collision=-1.0, response="pass", given=some(**given), mix=mix),
        Stage(0.2, collision=-1.0, given=some(**given), mix=mix),
    )


def circles(*counts: int) -> tuple[Given, ...]:
    """Circles of so many, with noise and without, and wider ones of few."""
    wide = tuple(some(n=n, jitter=0.3, vary=0.5) for n in counts if n < 12)
    return tuple(some(n=n, jitter=j) for n in counts for j in (0.0, 0.3)) + wide


PATIENT = 0.997  # discount: who waits for 3 s at 0.99 loses a quarter of all that comes after
PAID = Reward({"progress": 1.0, "arrival": 5.0, "collision": -1.0, "time": -0.03})
CROWD = Observation(lidar=False, neighbors=6, pad=True)
LED = replace(GUIDED, neighbors=6, neighbor_range=3.0, intent=True)
SEEING = Observation(rays=16, lidar_range=4.0, pad=True)

CIRCLES = tuple(some(n=n, jitter=j) for n in (4, 8, 12, 20) for j in (0.0, 0.3))
LONG = tuple(some(n=n, jitter=0.3) for n in (4, 6, 8))
FEW = tuple(some(n=n) for n in (2, 4, 6, 8))
DISCS = Recipe(  # it learns to wait where collisions are dear and circles wide
    replace(CROWD, neighbors=3),
    PAID,
    (
        Stage(0.3, collision=-0.5, response="pass", mix=LONG),
        Stage(0.25, collision=-1.0, response="pass", mix=circles(4, 8, 12)),
        Stage(0.3, collision=-1.0, response="pass", mix=circles(4, 8, 12, 20)),
        Stage(0.15, collision=-1.0, mix=circles(4, 8, 12, 20)),
    ),
    gamma=PATIENT,
    steps=8_000_000,
)
WHEELED_BARS = replace(
    DISCS,
    stages=(
        Stage(0.3, collision=-0.5, response="pass", mix=LONG),
        Stage(0.5, collision=-1.0, response="pass", mix=circles(4, 6, 8)),
        Stage(0.2, collision=-1.0, mix=circles(4, 6, 8)),
    ),
)
BARS = Recipe(
    CROWD,
    PAID,
    staged(*CIRCLES, vary=0.5),
    cases=100,
    near=0.3,
    rows=512,
    steps=12_000_000,
)
BODIES = replace(BARS, stages=staged(*LONG, vary=0.5))
SLOW = Reward({**PAID.weights, "obstacle": -1.0, "time": -0.01})  # where waiting is to be cheap
CLUTTER = Recipe(  # over ORCA few meet, so that meeting is dear from the first step on
    LED,
    SLOW,
    (Stage(1.0, collision=-5.0, mix=(some(n=4), some(n=10))),),
    cases=150,
    near=0.3,
    residual=1.0,
    orca=True,
    log_std=-1.2,
    learning_rate=3e-4,
    rows=512,
    max_steps=400,
    gamma=PATIENT,
    steps=1_200_000,
)
HALL = replace(
    CLUTTER,
    observation=replace(LED, neighbors=4, priority=True),
    stages=(Stage(1.0, collision=-5.0, mix=FEW),),
    residual=0.7,
    steps=600_000,
)
JUNCTION = Recipe(  # who is to wait: noise that is held tries that
    replace(
        LED,
        neighbors=3,
        neighbor_range=8.0,
        rays=24,
        lidar_range=6.0,
        look_ahead=1.5,
        priority=True,
        intent=False,
    ),
    SLOW,
    (
        Stage(0.8, collision=-5.0, response="pass", mix=FEW[1:]),
        Stage(0.2, collision=-5.0, mix=FEW[1:]),
    ),
    cases=150,
    near=0.5,
    residual=1.0,
    log_std=-1.5,
    held=16,
    learning_rate=6e-4,
    rows=512,
    gamma=0.998,
    steps=8_000_000,
)
WOOD = Recipe(  # its own lidar looks up and down: tips of trees are below who flies over them
    Observation(neighbors=4, neighbor_range=5.0, intent=True, pad=True),
    SLOW,
    (Stage(1.0, collision=-10.0, response="pass", mix=FEW[1:]),),
    cases=100,
    near=0.5,
    residual=1.0,
    log_std=-0.7,
    rows=512,
    gamma=PATIENT,
    steps=12_000_000,
)
ANY = Recipe(SEEING, PAID, (Stage(1.0),))

RECIPES: tuple[tuple[str, Given, Recipe], ...] = (
    ("swap", some(), DISCS),
    ("swap", some(body="long"), WHEELED_BARS),
    ("swap", some(body="long", drive="holonomic"), BARS),
    ("swap", some(body="l"), replace(BODIES, steps=6_000_000)),
    ("swap", some(body="l", drive="differential"), WHEELED_BARS),
    ("doorway", some(), HALL),
    ("corridor", some(), HALL),
    ("warehouse", some(), HALL),
    ("intersection", some(), JUNCTION),
    ("random", some(), CLUTTER),
    ("forest", some(), WOOD),
)


def recipe_of(scenario: str, overrides: Given = MappingProxyType({})) -> Recipe:
    """That of a built-in scenario with overrides, the most special; one that fits any other."""
    fit = [
        (len(given), recipe)
        for name, given, recipe in RECIPES
        if name == scenario and given.items() <= overrides.items()
    ]
    return max(fit, key=lambda found: found[0])[1] if fit else ANY
