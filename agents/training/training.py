"""Training of one policy for all robots of a scenario, by PPO over the simulator's arrays.

Needs the extra `agents`. After each evaluation and at the end, the folder of a training has:

    policy.npz     best policy of the evaluations so far: `--policy mlp:FILE`
    model.zip      current model of Stable-Baselines3, with its normalization in model.pkl and its
                   observation in model.json: `--policy sb3:FILE`
    training.json  settings and progress
    evaluations.csv, log/  evaluations; losses, also for TensorBoard
"""

from __future__ import annotations

import io
import pickle
from pathlib import Path
from typing import Any

import torch
from stable_baselines3 import PPO
from stable_baselines3.common import logger
from stable_baselines3.common.logger import configure
from stable_baselines3.common.utils import set_random_seed
from stable_baselines3.common.vec_env import VecNormalize

from fgenv import trust
from fgenv.agents.policies.network import NetworkPolicy
from fgenv.agents.policies.policy_file import PolicyFile
from fgenv.agents.training.callback import EvaluationCallback, Progress
from fgenv.agents.training.checkpoint import Checkpoint
from fgenv.agents.training.config import TrainingConfig
from fgenv.agents.training.curriculum import stage_envs
from fgenv.agents.training.export import export_policy
from fgenv.agents.training.masked_rollout_buffer import MaskedRolloutBuffer
from fgenv.agents.training.multi_scenario import MultiScenarioVecEnv
from fgenv.agents.training.ppo import equal_batch_size, ppo
from fgenv.agents.training.validation import EvaluationResult, validate, validation_cases


class Training:
    """Trains in the stages of a curriculum.

    An interrupted training continues where it was with `resume=True`, with other random numbers
    than an uninterrupted one.

    Raises:
        ValueError: no training to resume, or other settings.
    """

    def __init__(self, config: TrainingConfig, folder: Path, *, resume: bool = False) -> None:
        self.config, self.checkpoint = config, Checkpoint(folder)
        self.steps = 0
        self.best: EvaluationResult | None = None
        self.model: Any = None
        self.normalization: Any = None
        torch.set_num_threads(1)
        folder.mkdir(parents=True, exist_ok=True)
        if resume:
            self.steps, self.best = self.checkpoint.load_state(config.settings)
        else:
            self.checkpoint.begin()
        self._evaluated = self._saved = self.steps
        self._cases = validation_cases(config)

    def run(self, progress: Progress | None = None) -> PolicyFile:
        """Train all stages.

        After Ctrl-C the state of the training is saved as it is, to be resumed.

        Args:
            progress: called with the steps so far and, after an evaluation, its result.
        """
        try:
            self._run(progress)
        except KeyboardInterrupt:
            if self.model is not None and self.steps > self._saved:
                self.save()
            raise
        return PolicyFile.load(self.checkpoint.policy)

    def _run(self, progress: Progress | None) -> None:
        stages, end = self.config.recipe.stages, 0.0
        for number, stage in enumerate(stages):
            end += stage.share
            last = number == len(stages) - 1
            target = self.config.steps if last else round(end * self.config.steps)
            if self.steps >= target:
                continue
            self.begin_stage(number)
            callback = self._callback(progress)
            self.model.learn(target - self.steps, callback=callback, reset_num_timesteps=False)
            self.steps = self.model.num_timesteps
        if self.model is not None and self.steps > self._evaluated:
            self.evaluate(progress)

    def _callback(self, progress: Progress | None) -> EvaluationCallback:
        def on_step(steps: int) -> None:
            self.steps = steps
            if progress is not None:
                progress(steps, None)

        def evaluate(steps: int) -> EvaluationResult | None:
            due = steps >= self._evaluated + self.config.every
            return self.evaluate(progress) if due else None

        return EvaluationCallback(on_step, evaluate)

    def evaluate(self, progress: Progress | None = None) -> EvaluationResult:
        """Evaluate the policy, save it if it is the best so far, and save the training."""
        self._evaluated = self.steps
        file, max_steps = self.export(), self.config.recipe.max_steps
        result = validate(NetworkPolicy(file), self._cases, self.steps, max_steps)
        if self.best is None or result.rank > self.best.rank:
            self.best = result
            file.save(self.checkpoint.policy)
        self.checkpoint.append(result)
        self.save()
        if progress is not None:
            progress(self.steps, result)
        return result

    def save(self) -> None:
        """Save the model and the state of the training; the policy too if there is none yet."""
        self._saved, file = self.steps, self.export()
        if self.best is None:
            file.save(self.checkpoint.policy)
        self._save_model()
        self._save_normalization()
        self.checkpoint.save_settings(file.about)
        self.checkpoint.save_state(self.config.settings, self.steps, self.best)

    def export(self) -> PolicyFile:
        """Return the current policy."""
        config = self.config
        about = {
            "name": config.scenario,
            "command": config.command,
            "seed": config.seed,
            "scenario": {"name": config.scenario, **config.overrides},
            "steps": self.steps,
        }
        envs = self.normalization.venv.parts[0]
        return export_policy(self.model, self.normalization, envs.simulator, about, envs.config)

    def begin_stage(self, number: int) -> None:
        """Make the environments of a stage, and move the model to them."""
        envs = stage_envs(self.config, number)
        self._normalize(envs)
        seed = self.config.seed + 1000 * number + self.steps
        self._load_model(seed)
        self.model.lr_schedule = self.learning_rate
        self.model.rollout_buffer.envs = envs
        self.normalization.seed(seed)
        formats = ["csv"]
        if getattr(logger, "SummaryWriter", None):
            formats.append("tensorboard")
        log = self.checkpoint.folder / "log" / f"{number}-{self.steps}"
        self.model.set_logger(configure(str(log), formats))

    def _normalize(self, envs: MultiScenarioVecEnv) -> None:
        """Wrap environments with the current normalization, or with a new one."""
        if self.normalization is None and self.steps == 0:
            self.normalization = VecNormalize(envs, gamma=self.config.recipe.gamma)
            return
        if self.normalization is not None:
            self._save_normalization()
        self.normalization = pickle.loads(_trusted(self.checkpoint.normalization))
        self.normalization.set_venv(envs)

    def _load_model(self, seed: int) -> None:
        """Make a new model, or load the current one for the environments of a new stage."""
        recipe = self.config.recipe
        if self.model is None and self.steps == 0:
            self.model = ppo(recipe, self.normalization, self.config.seed, MaskedRolloutBuffer)
            return
        if self.model is not None:
            self._save_model()
        model = io.BytesIO(_trusted(self.checkpoint.model))
        self.model = PPO.load(model, env=self.normalization, device="cpu")
        self.model.batch_size = equal_batch_size(recipe, self.normalization.num_envs)
        set_random_seed(seed)

    def _save_model(self) -> None:
        """Save the model without its learning-rate schedule, which is a method of this object."""
        with trust.written(self.checkpoint.model) as partial:
            self.model.save(partial, exclude=["lr_schedule"])

    def _save_normalization(self) -> None:
        with trust.written(self.checkpoint.normalization) as partial:
            self.normalization.save(str(partial))

    def learning_rate(self, _: float) -> float:
        """Return the current learning rate; with `anneal` it decreases to 0 over all stages."""
        recipe = self.config.recipe
        remaining = 1.0 - self.steps / self.config.steps if recipe.anneal else 1.0
        return recipe.learning_rate * max(0.0, remaining)


def _trusted(path: Path) -> bytes:
    """Return the content of a pickle that a training on this machine wrote."""
    content = trust.read(path)
    trust.check(path, content)
    return content
