"""Gymnasium: one robot of one world learns, the others follow a policy.

>>> import gymnasium
>>> import fgenv.envs
>>> env = gymnasium.make("fgenv/swap-v0", n=8, jitter=0.5, robot="robot 1", others="goto")
"""

from __future__ import annotations

import copy
from typing import Any, ClassVar

import gymnasium
import numpy as np
from numpy.typing import ArrayLike

from fgenv.arrays import Floats32

from .infos import infos
from .parallel import single
from .rendering import MODES, Frame, Screen
from .simulator import Simulator, Source
from .single_agent import Learner
from .spaces import action_box, observation_box


class FleetEnv(gymnasium.Env[Any, Any]):
    """A robot among others.

    Its episode is terminated where it arrives, or where a collision ends it; truncated at the
    horizon. What is told beside is that of `infos`.

    Args:
        scenario: a name, a file, a Scenario, or a FrozenSet, each episode being one of its cases.
        robot: name or place of the one that learns.
        others: a policy with reset(view) and act(observations), a function of observations, or
            `rest`, `random`, `goto`.
        render_mode: `rgb_array`, `human` or None.
        options: of `Simulator` (observation, reward, actions, starts, cases, clearance, max_steps,
            threads), and overrides of the scenario (n, jitter...).

    Raises:
        ScenarioError, ValueError, TypeError: saying what does not fit, and the remedy.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": MODES, "render_fps": 10}  # type: ignore[misc]

    def __init__(
        self,
        scenario: Source,
        *,
        robot: str | int = 0,
        others: Any = "rest",
        render_mode: str | None = None,
        **options: Any,
    ) -> None:
        single("a Gymnasium environment", options)
        self.simulator = Simulator(scenario, 1, autoreset=False, **options)
        self.learner = Learner(self.simulator, robot, others)
        self.observation_space = observation_box(self.simulator, self.learner.place)
        self.action_space = action_box(self.simulator, self.learner.place)
        self.render_mode, self._screen = render_mode, Screen(self.simulator, render_mode)
        self.metadata = {**type(self).metadata, "render_fps": 1.0 / self.simulator.dt}  # type: ignore[misc]

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Floats32, dict[str, Any]]:
        """Begin an episode: the first of a seed, or the next one. Options are not looked at."""
        super().reset(seed=seed)
        return self.learner.reset(seed)[0], self._told()

    def step(self, action: ArrayLike) -> tuple[Floats32, float, bool, bool, dict[str, Any]]:
        """Step with the robot's action (size,).

        Raises:
            ValueError: wrong shape, or a number that is not finite. Nothing has changed then.
            RuntimeError: the episode is over.
        """
        done = self.learner.step(np.asarray(action)[None])
        ended, late = bool(done.terminated[0]), bool(done.truncated[0])
        return done.observations[0], float(done.rewards[0]), ended, late, self._told()

    def render(self) -> Frame | None:
        """The frame (360, 480, 3) in mode `rgb_array`, else None; `human` is shown live."""
        return self._screen.show()

    def close(self) -> None:
        """End the live view, if there is one."""
        self._screen.close()

    def _told(self) -> dict[str, Any]:
        return infos(self.simulator)[self.learner.place]

    def __copy__(self) -> FleetEnv:
        return copy.deepcopy(self)
