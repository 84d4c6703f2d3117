"""Evaluation during a training, on cases that are not trained on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fgenv.agents.evaluation.case_runner import run_cases
from fgenv.agents.policies.network import NetworkPolicy
from fgenv.agents.training.config import TrainingConfig
from fgenv.agents.training.curriculum import has_cases
from fgenv.scenarios import FrozenSet, frozen

FIRST_SEED = 3_000_000  # of validation cases, distinct from those of evaluation sets
CASES = 100  # per evaluation


@dataclass(frozen=True)
class EvaluationResult:
    """Result of an evaluation during a training.

    Attributes:
        steps: of robots so far.
        success: share of successful episodes.
        robot_success: share of successful robots.
        collision: share of robots with a collision.
        seconds: mean makespan of successful episodes, s.
    """

    steps: int
    success: float
    robot_success: float
    collision: float
    seconds: float

    @property
    def rank(self) -> tuple[float, float, float]:
        """Sort key; greater is better."""
        return self.success, self.robot_success, -self.seconds


def validation_cases(config: TrainingConfig) -> list[FrozenSet]:
    """Return validation cases of the last stage; none for a scenario file."""
    variants = config.variants(config.recipe.stages[-1])
    if not has_cases(config.scenario):
        return []
    n = -(-CASES // len(variants))
    return [frozen(config.scenario, cases=n, seed=FIRST_SEED, **variant) for variant in variants]


def validate(
    policy: NetworkPolicy, cases: Sequence[FrozenSet], steps: int, max_steps: int
) -> EvaluationResult:
    """Evaluate a policy; without cases the latest policy ranks best.

    Args:
        steps: of the training so far.
        max_steps: of an episode.
    """
    if not cases:
        return EvaluationResult(steps, float(steps), 0.0, 0.0, 0.0)
    episodes = []
    for each in cases:
        episodes += run_cases(each, policy, range(len(each)), clearance=False, max_steps=max_steps)
    robots = [robot for episode in episodes for robot in episode.results.robots]
    times = [e.results.makespan for e in episodes if e.success and e.results.makespan is not None]
    return EvaluationResult(
        steps,
        float(np.mean([episode.success for episode in episodes])),
        float(np.mean([robot.success for robot in robots])),
        float(np.mean([robot.steps_in_contact > 0 for robot in robots])),
        float(np.mean(times)) if times else 0.0,
    )
