"""Environments of a curriculum's stages."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from fgenv.agents.policies.residual import ResidualConfig
from fgenv.agents.training.config import Stage, TrainingConfig
from fgenv.agents.training.multi_scenario import MultiScenarioVecEnv
from fgenv.agents.training.residual_vec_env import ResidualVecEnv
from fgenv.envs import Reward
from fgenv.scenarios import FrozenSet, Scenario, frozen
from fgenv.scenarios.library import ENTRIES

FIRST_SEED = 10_000_000  # of training cases, distinct from those of evaluation sets


def stage_envs(config: TrainingConfig, number: int) -> MultiScenarioVecEnv:
    """Return the environments of a stage."""
    stage = config.recipe.stages[number]
    seed = FIRST_SEED + 100_000 * config.seed + 10_000 * number
    variants = config.variants(stage)
    rows = config.recipe.rows // len(variants)
    return MultiScenarioVecEnv(
        [variant_envs(config, stage, variant, rows, seed) for variant in variants]
    )


def variant_envs(
    config: TrainingConfig, stage: Stage, overrides: dict[str, Any], rows: int, seed: int
) -> ResidualVecEnv:
    """Return environments of one variant of the scenario with about as many rows."""
    recipe, source = config.recipe, training_source(config, stage, overrides, seed)
    template = source.template if isinstance(source, FrozenSet) else source
    return ResidualVecEnv(
        source,
        max(1, rows // len(template.robots)),
        config=ResidualConfig(recipe.near, recipe.residual, recipe.orca),
        observation=recipe.observation,
        reward=with_collision_weight(recipe.reward, stage.collision_weight),
        actions=recipe.actions,
        starts=stage.starts,
        max_steps=recipe.max_steps,
    )


def training_source(
    config: TrainingConfig, stage: Stage, overrides: dict[str, Any], seed: int
) -> Scenario | FrozenSet:
    """Return the cases of a built-in scenario, or the scenario of a file."""
    change = {} if stage.on_collision is None else {"on_collision": stage.on_collision}
    if not has_cases(config.scenario):
        return Scenario.load(config.scenario, **overrides).model_copy(update=change)
    cases = frozen(config.scenario, cases=config.recipe.cases, seed=seed, **overrides)
    return replace(cases, template=cases.template.model_copy(update=change))


def with_collision_weight(reward: Reward, weight: float | None) -> Reward:
    """Return the reward with another weight of collisions; None keeps it."""
    if weight is None:
        return reward
    return replace(reward, weights={**reward.weights, "collision": weight})


def has_cases(scenario: str) -> bool:
    """Whether a scenario is built in with a variable number of robots, so that it has cases."""
    return scenario in ENTRIES and ENTRIES[scenario].parameters.get("n") is not None
