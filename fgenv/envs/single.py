"""Gymnasium: one robot of one world learns, the others follow a policy.

>>> import gymnasium
>>> import fgenv
>>> env = gymnasium.make("fgenv/swap-v0", n=8, jitter=0.5, robot="robot 1", others="goto")
"""

from __future__ import annotations

import copy
from typing import Any, ClassVar

import gymnasium
from numpy.typing import ArrayLike

from fgenv.arrays import Floats32

from .infos import Info, infos
from .options import check_reset_options, first_seed, place_robots, places_in, refuse_worlds
from .rendering import MODES, Frame, Screen
from .simulator import Simulator, Source
from .single_agent import LearnerState, LearningRobot, real_numbers
from .spaces import action_box, observation_box


class FleetEnv(gymnasium.Env[Any, Any]):
    """One learning robot among other robots.

    An episode is terminated when the robot arrives or a collision ends it, and truncated at the
    horizon. Infos are those of `infos`.

    Args:
        scenario: a name, a file, a Scenario, or a FrozenSet with a case per episode.
        robot: name or index of the learning robot.
        others: policy of the other robots: a name, a policy, or a function of observations, see
            `policy_of`.
        render_mode: `rgb_array`, `human` or None.
        options: of `Simulator` (observation, reward, actions, starts, cases, clearance, max_steps,
            threads), and overrides of the scenario (n, jitter, ...).

    Raises:
        ScenarioError, ValueError, TypeError: invalid arguments.
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
        refuse_worlds("a Gymnasium environment", options)
        self.simulator = Simulator(scenario, 1, autoreset=False, **options)
        self.learner = LearningRobot(self.simulator, robot, others)
        self.observation_space = observation_box(self.simulator, self.learner.index)
        self.action_space = action_box(self.simulator, self.learner.index)
        self.render_mode, self._screen = render_mode, Screen(self.simulator, render_mode)
        self.metadata = {**type(self).metadata, "render_fps": 1.0 / self.simulator.dt}  # type: ignore[misc]

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Floats32, Info]:
        """Begin an episode: the first of a seed, or the next one.

        Without a seed the first episode has a seed of fresh entropy, see `np_random_seed`.

        Args:
            options: `starts` and `goals`: configurations (nq,) by name of robot; other robots have
                those of the episode. Options that other environments take are ignored.

        Raises:
            TypeError: options are no dict.
            ValueError: a start or goal of an unknown robot, of a wrong shape, outside the limits,
                or a start in contact.
        """
        check_reset_options(options)
        places = places_in(self.simulator, options)
        seed = first_seed(self.simulator, seed)
        super().reset(seed=seed)
        rows = self.learner.reset(seed)
        if place_robots(self.simulator, places):
            rows = self.learner.observe()
        return rows[0], self._info()

    def get_state(self) -> LearnerState:
        """Return the state of the episode and of the other robots' policy, for `set_state`."""
        return self.learner.get_state()

    def set_state(self, state: LearnerState) -> None:
        """Continue from a state of `get_state`, bit for bit.

        Raises:
            ValueError: the state is of another environment.
        """
        self.learner.set_state(state)

    def step(self, action: ArrayLike) -> tuple[Floats32, float, bool, bool, Info]:
        """Step with the robot's action (size,).

        Raises:
            ValueError: wrong shape, or a number that is not finite. The state is unchanged.
            RuntimeError: the episode is over.
        """
        own = real_numbers(action, label := f"action of {self.learner.name!r}")
        if own.shape != self.action_space.shape:
            raise ValueError(f"{label}: got shape {own.shape}, expected {self.action_space.shape}")
        step = self.learner.step(own[None])
        terminated, truncated = bool(step.terminated[0]), bool(step.truncated[0])
        return step.observations[0], float(step.rewards[0]), terminated, truncated, self._info()

    def render(self) -> Frame | None:
        """Return the frame (360, 480, 3) in mode `rgb_array`, else None; `human` shows it live."""
        return self._screen.show()

    def close(self) -> None:
        """End the live view, if there is one."""
        self._screen.close()

    def _info(self) -> Info:
        return infos(self.simulator)[self.learner.index]

    def __copy__(self) -> FleetEnv:
        return copy.deepcopy(self)
