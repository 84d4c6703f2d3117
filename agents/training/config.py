"""Settings of a training: its curriculum, hyperparameters, scenario and seed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from types import MappingProxyType
from typing import Any

from fgenv.envs import Observation, Reward

Overrides = Mapping[str, Any]  # of a scenario's parameters


def overrides(**values: Any) -> Overrides:
    """Return read-only overrides of a scenario."""
    return MappingProxyType(values)


@dataclass(frozen=True)
class Stage:
    """A stage of a curriculum.

    Attributes:
        share: of all steps.
        starts: `scenario` or `random`, see `Simulator`.
        collision_weight: instead of the reward's. A large weight at first teaches robots to wait
            wherever paths cross.
        on_collision: instead of the scenario's. With `pass`, robots do not get stuck, so that the
            policy first learns to reach goals, and steps are cheaper.
        base: overrides of the scenario (n, jitter, ...); those of the command have precedence.
        variants: further overrides, trained at once with equal shares of the rows; in sequence,
            the policy would forget the earlier ones.
    """

    share: float
    starts: str = "scenario"
    collision_weight: float | None = None
    on_collision: str | None = None
    base: Overrides = field(default_factory=overrides)
    variants: tuple[Overrides, ...] = (overrides(),)


@dataclass(frozen=True)
class Recipe:
    """Hyperparameters of a scenario; those of PPO have the names of Stable-Baselines3.

    Attributes:
        stages: in order; the shares sum to 1. The last is the target of the training.
        cases: number of cases of each scenario in each stage.
        max_steps: of a training episode.
        actions: `drive` or `way_points`, see `Simulator`. Way points suit drives that cannot move
            sideways: the robot turns toward the point, then drives.
        near, residual, orca: see `ResidualConfig`.
        steps: of robots, in total.
        rows: approximate number of robots that are stepped at once.
        anneal: decrease the learning rate linearly to 0.
        sde_sample_freq: number of steps for which exploration noise, a function of the
            observation, is held (A. Raffin et al., "Smooth exploration for robotic reinforcement
            learning", 2021); 0: independent noise in each step.
        net_arch: widths of the hidden layers.
        activation: `tanh` or `relu`.
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
    batch_size: int = 2048
    n_epochs: int = 5
    learning_rate: float = 1e-3
    anneal: bool = True
    gamma: float = 0.99
    gae_lambda: float = 0.95
    ent_coef: float = 0.0
    log_std_init: float = -0.5
    sde_sample_freq: int = 0
    net_arch: tuple[int, ...] = (64, 64)
    activation: str = "tanh"


@dataclass(frozen=True)
class TrainingConfig:
    """Configuration of a training.

    Attributes:
        scenario: name of a built-in scenario, or a file.
        overrides: of the scenario, with precedence over those of the stages.
        steps: of robots, in total.
        seed: of all random numbers; with one thread the same seed gives the same file.
        command: stored in the file.
        every: steps between evaluations.
    """

    scenario: str
    recipe: Recipe
    overrides: dict[str, Any] = field(default_factory=dict)
    steps: int = 1_000_000
    seed: int = 0
    command: str = ""
    every: int = 250_000

    @property
    def settings(self) -> dict[str, Any]:
        """Settings that must be equal to resume, as plain values."""
        recipe = asdict(replace(self.recipe, stages=()))
        recipe["reward"] = dict(self.recipe.reward.weights)
        scenario = {"scenario": self.scenario, "overrides": self.overrides}
        return {**scenario, "seed": self.seed, "recipe": recipe}

    def variants(self, stage: Stage) -> list[dict[str, Any]]:
        """Return the distinct overrides of the scenario in a stage."""
        every = [{**stage.base, **variant, **self.overrides} for variant in stage.variants]
        return [variant for k, variant in enumerate(every) if variant not in every[:k]]
