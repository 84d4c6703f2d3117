"""Callback of Stable-Baselines3 that reports progress and evaluates."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict

from stable_baselines3.common.callbacks import BaseCallback

from fgenv.agents.training.validation import EvaluationResult

Progress = Callable[[int, EvaluationResult | None], object]  # of (steps, evaluation)


class EvaluationCallback(BaseCallback):
    """Calls a function after each step, and an evaluation between rollouts when it is due.

    Args:
        on_step: called with the number of steps.
        evaluate: called with the number of steps, 0 before the first of a stage; returns a result
            if an evaluation was due.
    """

    def __init__(
        self,
        on_step: Callable[[int], object],
        evaluate: Callable[[int], EvaluationResult | None],
    ) -> None:
        super().__init__()
        self._report, self._evaluate = on_step, evaluate

    def _on_step(self) -> bool:
        self._report(self.num_timesteps)
        return True

    def _on_rollout_start(self) -> None:
        result = self._evaluate(self.num_timesteps)
        if result is not None:
            for name, value in asdict(result).items():
                self.logger.record(f"evaluation/{name}", value)
