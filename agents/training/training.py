"""Training: one policy for all robots of a scenario, by PPO over the simulator's arrays.

Needs the extra `agents`. In its folder there are, after each evaluation and at the end:

    policy.npz     the policy that did best in the evaluations so far: `--policy mlp:FILE`
    model.zip      the model of Stable-Baselines3 as it is now, model.pkl what it normalizes by,
                   model.json what it observes: `--policy sb3:FILE`
    training.json  settings, and how far it is
    evaluations.csv, log/  what it did: the evaluations; the losses, for TensorBoard too
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common import logger
from stable_baselines3.common.buffers import RolloutBuffer
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import configure
from stable_baselines3.common.utils import set_random_seed
from stable_baselines3.common.vec_env import VecNormalize

from fgenv.agents.evaluation.episodes import run_cases
from fgenv.agents.policies.network import NetworkPolicy
from fgenv.agents.policies.policy_file import PolicyFile
from fgenv.agents.policies.residual import ResidualConfig
from fgenv.agents.training.base_policy import HomingVecEnv
from fgenv.agents.training.export import exported
from fgenv.agents.training.masked_rollout_buffer import MovingRollouts
from fgenv.agents.training.multi_scenario import MixedVecEnv
from fgenv.agents.training.recipes import Recipe, Stage
from fgenv.envs import Reward
from fgenv.scenarios import FrozenSet, Scenario, frozen

LEARN, CHECK = 10_000_000, 3_000_000  # seeds of cases, far from those of evaluation sets
CHECKED = 100  # cases of an evaluation while it learns
ACTIVATIONS = {"tanh": torch.nn.Tanh, "relu": torch.nn.ReLU}
HEAD = "steps,success,robot_success,collision,seconds\n"


@dataclass(frozen=True)
class TrainingConfig:
    """What is to be trained.

    Attributes:
        scenario: of a built-in one, the name.
        overrides: of the scenario, over those of the stages.
        steps: of robots, in all.
        seed: of all that is random; with one thread the same seed gives the same file.
        command: that is told in the file.
        every: steps between two evaluations.
    """

    scenario: str
    recipe: Recipe
    overrides: dict[str, Any] = field(default_factory=dict)
    steps: int = 1_000_000
    seed: int = 0
    command: str = ""
    every: int = 250_000


@dataclass(frozen=True)
class Check:
    """An evaluation while it learns: steps so far; shares of episodes, robots, robots."""

    steps: int
    success: float
    robot_success: float
    collision: float
    seconds: float  # makespan of what succeeded, mean

    @property
    def rank(self) -> tuple[float, float, float]:
        """The greater the better."""
        return self.success, self.robot_success, -self.seconds


class Training:
    """Learns in stages; `run` may be interrupted, and a new one with `resume=True` goes on.

    A resumed training learns on from the last evaluation, but draws other random numbers than one
    that was not interrupted.

    Raises:
        ValueError: nothing to resume, or other settings there.
    """

    def __init__(self, config: TrainingConfig, folder: Path, *, resume: bool = False) -> None:
        self.config, self.folder = config, folder
        self.steps, self.next, self.checked = 0, config.every, 0
        self.best: Check | None = None
        self.model: Any = None
        self.normal: Any = None
        torch.set_num_threads(1)
        folder.mkdir(parents=True, exist_ok=True)
        if resume:
            self._resume()
        else:
            for name in ("training.json", "model.zip", "model.pkl", "model.json", "policy.npz"):
                (folder / name).unlink(missing_ok=True)  # or --resume would go on with an older one
            (folder / "evaluations.csv").write_text(HEAD, encoding="utf-8")
        self._cases = self._check_cases()

    @property
    def settings(self) -> dict[str, Any]:
        """What has to be the same to go on."""
        recipe = asdict(replace(self.config.recipe, stages=()))
        recipe["reward"] = dict(self.config.recipe.reward.weights)
        given = {"scenario": self.config.scenario, "overrides": self.config.overrides}
        return {**given, "seed": self.config.seed, "recipe": recipe}

    def run(self, progress: Callable[[int, Check | None], object] | None = None) -> PolicyFile:
        """Learn all stages.

        Args:
            progress: called with the steps so far and, after an evaluation, what it told.
        """
        end = 0.0
        for number, stage in enumerate(self.config.recipe.stages):
            end += stage.share
            last = number == len(self.config.recipe.stages) - 1
            target = self.config.steps if last else round(end * self.config.steps)
            if self.steps >= target:
                continue
            self._begin(number, stage)
            ear = Ear(self, progress)
            self.model.learn(target - self.steps, callback=ear, reset_num_timesteps=False)
            self.steps = self.model.num_timesteps
        if self.model is None:  # resumed at its end
            return PolicyFile.load(self.folder / "policy.npz")
        if self.steps > self.checked:
            self.check(progress)
        return PolicyFile.load(self.folder / "policy.npz")

    def check(self, progress: Callable[[int, Check | None], object] | None = None) -> Check:
        """Evaluate, and write what there is; the policy where it is better than before."""
        self.next, self.checked = self.steps + self.config.every, self.steps
        file, most = self.export(), self.config.recipe.max_steps
        found = checked(NetworkPolicy(file), self._cases, self.steps, most)
        if self.best is None or found.rank > self.best.rank:
            self.best = found
            file.save(self.folder / "policy.npz")
        with (self.folder / "evaluations.csv").open("a", encoding="utf-8") as out:
            numbers = (found.success, found.robot_success, found.collision, found.seconds)
            out.write(f"{found.steps}," + ",".join(f"{x:.4f}" for x in numbers) + "\n")
        self.save()
        if progress is not None:
            progress(self.steps, found)
        return found

    def export(self) -> PolicyFile:
        """The policy as it is."""
        config = self.config
        about = {
            "name": config.scenario,
            "command": config.command,
            "seed": config.seed,
            "scenario": {"name": config.scenario, **config.overrides},
            "steps": self.steps,
        }
        envs = self.normal.venv.parts[0]
        return exported(self.model, self.normal, envs.simulator, about, envs.base)

    def save(self) -> None:
        """Write what is needed to go on."""
        self._save_model()
        self.normal.save(str(self.folder / "model.pkl"))
        about = self.export().about
        names = ("observation", "actions", *(of.name for of in fields(ResidualConfig)))
        told = {name: about[name] for name in names}
        (self.folder / "model.json").write_text(json.dumps(told), encoding="utf-8")
        state = {**self.settings, "steps": self.steps, "best": self.best and asdict(self.best)}
        half = self.folder / ".training.json.part"
        half.write_text(json.dumps(state, indent=1, default=list) + "\n", encoding="utf-8")
        os.replace(half, self.folder / "training.json")

    def _resume(self) -> None:
        path = self.folder / "training.json"
        if not path.exists():
            raise ValueError(f"--resume: nothing to go on with in {self.folder}; leave it out")
        state = json.loads(path.read_text(encoding="utf-8"))
        for name, value in json.loads(json.dumps(self.settings, default=list)).items():
            if state.get(name) != value:
                told = f"--resume: {name} was {state.get(name)}, expected the same again"
                raise ValueError(f"{told}; or leave --resume out")
        self.steps = self.checked = state["steps"]
        self.next = self.steps + self.config.every
        self.best = state["best"] and Check(**state["best"])

    def _given(self, stage: Stage) -> list[dict[str, Any]]:
        """Overrides of the scenario in each part of a stage; those that are the same once."""
        every = [{**stage.given, **own, **self.config.overrides} for own in stage.mix]
        return [given for k, given in enumerate(every) if given not in every[:k]]

    def _check_cases(self) -> list[FrozenSet]:
        """Cases of the last stage that it does not learn from; none of a file."""
        name, parts = self.config.scenario, self._given(self.config.recipe.stages[-1])
        if not built_in(name):
            return []
        many = -(-CHECKED // len(parts))
        return [frozen(name, cases=many, seed=CHECK, **given) for given in parts]

    def _begin(self, number: int, stage: Stage) -> None:
        """The environment of a stage, and the model in it."""
        envs = self._envs(number, stage)
        if self.normal is None and self.steps > 0:
            self.normal = VecNormalize.load(str(self.folder / "model.pkl"), envs)
        elif self.normal is None:
            self.normal = VecNormalize(envs, gamma=self.config.recipe.gamma)
        else:
            self.normal.save(str(self.folder / "model.pkl"))
            self.normal = VecNormalize.load(str(self.folder / "model.pkl"), envs)
        seed = self.config.seed + 1000 * number + self.steps
        if self.model is None and self.steps == 0:
            self.model = model_of(self.config.recipe, self.normal, self.config.seed, MovingRollouts)
        else:
            if self.model is not None:
                self._save_model()
            self.model = PPO.load(self.folder / "model.zip", env=self.normal, device="cpu")
            self.model.batch_size = batch_of(self.config.recipe, self.normal.num_envs)
            set_random_seed(seed)
        self.model.lr_schedule = self._rate
        self.model.rollout_buffer.envs = envs
        self.normal.seed(seed)
        kinds = ["csv", *(["tensorboard"] if getattr(logger, "SummaryWriter", None) else [])]
        self.model.set_logger(configure(str(self.folder / "log" / f"{number}-{self.steps}"), kinds))

    def _save_model(self) -> None:
        """Without its learning rate, which is a method of this."""
        self.model.save(self.folder / "model.zip", exclude=["lr_schedule"])

    def _rate(self, _: float) -> float:
        """The learning rate now: it may fall to 0 at the end of all stages."""
        recipe = self.config.recipe
        left = 1.0 - self.steps / self.config.steps if recipe.anneal else 1.0
        return recipe.learning_rate * max(0.0, left)

    def _envs(self, number: int, stage: Stage) -> MixedVecEnv:
        seed = LEARN + 100_000 * self.config.seed + 10_000 * number
        parts = self._given(stage)
        rows = self.config.recipe.rows // len(parts)
        return MixedVecEnv([self._part(stage, given, rows, seed) for given in parts])

    def _part(self, stage: Stage, given: dict[str, Any], rows: int, seed: int) -> HomingVecEnv:
        """About so many rows of a scenario."""
        source: Any = self.config.scenario
        recipe = self.config.recipe
        if built_in(source):
            source = frozen(source, cases=recipe.cases, seed=seed, **given)
        else:
            source = Scenario.load(source, **given)
        source, robots = responding(source, stage.response)
        envs = HomingVecEnv(
            source,
            max(1, rows // robots),
            observation=recipe.observation,
            reward=paid(recipe.reward, stage.collision),
            actions=recipe.actions,
            starts=stage.starts,
            max_steps=recipe.max_steps,
        )
        envs.base = ResidualConfig(recipe.near, recipe.residual, recipe.orca)
        return envs


class Ear(BaseCallback):
    """Tells of progress, and evaluates now and then."""

    def __init__(self, training: Training, progress: Any) -> None:
        super().__init__()
        self.training, self.progress = training, progress

    def _on_step(self) -> bool:
        self.training.steps = self.num_timesteps
        if self.progress is not None:
            self.progress(self.num_timesteps, None)
        return True

    def _on_rollout_start(self) -> None:
        if self.num_timesteps >= self.training.next:
            found = self.training.check(self.progress)
            for name, value in asdict(found).items():
                self.logger.record(f"evaluation/{name}", value)


def model_of(
    recipe: Recipe, envs: Any, seed: int, rollouts: type[RolloutBuffer] | None = None
) -> PPO:
    """PPO as a recipe wants it."""
    return PPO(
        "MlpPolicy",
        envs,
        n_steps=recipe.n_steps,
        batch_size=batch_of(recipe, envs.num_envs),
        n_epochs=recipe.epochs,
        learning_rate=recipe.learning_rate,
        gamma=recipe.gamma,
        gae_lambda=recipe.gae_lambda,
        ent_coef=recipe.entropy,
        seed=seed,
        use_sde=recipe.held > 0,
        sde_sample_freq=recipe.held or -1,
        device="cpu",
        rollout_buffer_class=rollouts,
        policy_kwargs={
            "net_arch": list(recipe.hidden),
            "activation_fn": ACTIVATIONS[recipe.activation],
            "log_std_init": recipe.log_std,
        },
    )


def batch_of(recipe: Recipe, rows: int) -> int:
    """The greatest size of equal batches, up to that of the recipe."""
    samples = rows * recipe.n_steps
    return next(b for b in range(min(recipe.batch, samples), 0, -1) if samples % b == 0)


def checked(policy: NetworkPolicy, cases: Sequence[FrozenSet], steps: int, most: int) -> Check:
    """How it does in cases that it does not learn from; where there are none the last is best."""
    if not cases:
        return Check(steps, float(steps), 0.0, 0.0, 0.0)
    found = []
    for each in cases:
        found += run_cases(each, policy, range(len(each)), clearance=False, max_steps=most)
    robots = [robot for episode in found for robot in episode.results.robots]
    spans = [e.results.makespan for e in found if e.success and e.results.makespan is not None]
    return Check(
        steps,
        float(np.mean([episode.success for episode in found])),
        float(np.mean([robot.success for robot in robots])),
        float(np.mean([robot.collisions > 0 for robot in robots])),
        float(np.mean(spans)) if spans else 0.0,
    )


def responding(source: Any, response: str | None) -> tuple[Any, int]:
    """A scenario or a set of it with another response to collisions; and how many robots."""
    change = {} if response is None else {"on_collision": response}
    if isinstance(source, FrozenSet):
        template = source.template.model_copy(update=change)
        return replace(source, template=template), len(template.robots)
    return source.model_copy(update=change), len(source.robots)


def paid(reward: Reward, collision: float | None) -> Reward:
    """A reward with another weight of collisions."""
    if collision is None:
        return reward
    return replace(reward, weights={**reward.weights, "collision": collision})


def built_in(name: str) -> bool:
    """Whether a scenario has cases: it is no file."""
    from fgenv.scenarios.library import ENTRIES

    return name in ENTRIES and ENTRIES[name].parameters.get("n") is not None
