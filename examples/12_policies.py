"""Your own policy against ORCA; then one that is trained for seconds and run from its file."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from fgenv.agents import NetworkPolicy, evaluate, run_episode
from fgenv.agents.training.config import Stage, TrainingConfig
from fgenv.agents.training.recipes import recipe_of
from fgenv.agents.training.training import Training
from fgenv.envs import Simulator, View, register_policy
from fgenv.scenarios import frozen


class KeepRight:
    """Drives to the goal, turned to the right by an angle that grows with the distance."""

    def reset(self, view: View) -> None:
        self.view = view

    def act(self, observations: np.ndarray) -> np.ndarray:
        way = self.view.goals - self.view.configurations
        aside = np.stack([way[..., 1], -way[..., 0], 0 * way[..., 2]], axis=-1)
        return self.view.toward(self.view.goals + 0.6 * aside)


register_policy("keep_right", lambda argument, seed: KeepRight())
cases = frozen("swap", n=4, jitter=0.2, cases=10)
for name, score in evaluate(cases, ["keep_right", "orca"]).scores.items():
    low, high = score.success[1:]
    print(f"{name}: success {score.success.value:.2f} of episodes, 95 % in {low:.2f} to {high:.2f}")

short = replace(recipe_of("swap"), stages=(Stage(1.0, "random"),), cases=5, rows=64)
expected = TrainingConfig("swap", short, {"n": 2}, steps=20_000, every=20_000)
Training(expected, Path("swap")).run()  # as fgenv train does

policy = NetworkPolicy.load("swap/policy.npz")  # no PyTorch from here on
simulator = Simulator("swap", n=2, observation=policy.observation, autoreset=False)
record = run_episode(simulator, policy)
assert len(record) > 10
