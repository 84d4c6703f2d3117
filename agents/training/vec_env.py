"""Stable-Baselines3: all robots of all worlds learn one policy, over the simulator's arrays.

>>> from stable_baselines3 import PPO
>>> from fgenv.agents import FleetVecEnv
>>> envs = FleetVecEnv("swap", worlds=32, n=8, jitter=0.5)       # 256 rows
>>> PPO("MlpPolicy", envs).learn(100_000)
"""

from __future__ import annotations

import copy
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import VecEnv
from stable_baselines3.common.vec_env.base_vec_env import VecEnvStepReturn

from fgenv.envs import Simulator
from fgenv.envs.rendering import Frame, Screen
from fgenv.envs.simulator import Source, Step
from fgenv.envs.spaces import action_box, observation_box


class Row:
    """A robot of a world: what `get_attr` and `env_method` find, beside what all rows share."""

    def __init__(self, envs: FleetVecEnv, index: int) -> None:
        self.envs = envs
        self.world, self.robot = divmod(index, envs.simulator.n_robots)

    @property
    def name(self) -> str:
        """Of the robot."""
        return self.envs.simulator.names[self.robot]

    @property
    def seed(self) -> int:
        """Of the world."""
        return int(self.envs.simulator.seeds[self.world])

    def render(self) -> Frame | None:
        """The frame of the world."""
        return self.envs.screen.show(self.world)

    def __getattr__(self, name: str) -> Any:
        if name == "envs" or name.startswith("__"):
            raise AttributeError(name)
        return getattr(self.envs if hasattr(self.envs, name) else self.envs.simulator, name)


class FleetVecEnv(VecEnv):
    """Rows are worlds times robots: row w * n + i is robot i of world w.

    All rows of a world end together, where all have arrived, a collision ends the episode, or the
    horizon is reached; who arrives early rests until then, at reward 0. World w of seed s is that
    of a simulator's reset(seed=s + w). Infos of rows that end have `terminal_observation`,
    `is_success` (the robot has arrived) and `collisions` (steps in which it met something);
    `TimeLimit.truncated` is in all.

    Args:
        scenario: a name, a file, a Scenario, a FrozenSet; or a Simulator, without autoreset.
        worlds: how many.
        render_mode: `rgb_array`, `human` or None.
        options: of `Simulator` (observation, reward, actions, starts, cases, clearance, max_steps,
            threads), and overrides of the scenario (n, jitter...).

    Raises:
        ScenarioError, ValueError, TypeError: saying what does not fit, and the remedy.
    """

    def __init__(
        self,
        scenario: Source | Simulator,
        worlds: int = 1,
        *,
        render_mode: str | None = None,
        **options: Any,
    ) -> None:
        if not isinstance(scenario, Simulator):
            scenario = Simulator(scenario, worlds, autoreset=False, **options)
        self.simulator = scenario
        if self.simulator.autoreset:
            raise ValueError("simulator: autoreset=True, expected False: the rows tell of the end")
        observation, action = shared_spaces(self.simulator)
        self.render_mode, self.screen = render_mode, Screen(self.simulator, render_mode)
        self._seed: int | None = None
        rows = self.simulator.n_worlds * self.simulator.n_robots
        super().__init__(rows, observation, action)
        self.metadata: dict[str, Any] = {
            **self.metadata,
            "render_fps": 1.0 / self.simulator.dt,
        }

    def seed(self, seed: int | None = None) -> Sequence[int | None]:
        """World w gets seed + w at the next reset; returns that of each row. None: a random one."""
        if seed is None:
            seed = int(np.random.default_rng().integers(2**32))
        self._seed = seed
        return [seed + w for w in range(self.simulator.n_worlds) for _ in self.simulator.names]

    def reset(self) -> NDArray[np.float32]:
        """Begin episodes; observations (rows, size)."""
        rows, self._seed = self.simulator.reset(self._seed), None
        self._reset_seeds()
        self._reset_options()
        self.reset_infos = [{} for _ in range(self.num_envs)]
        return self._flat(rows)

    def step_async(self, actions: NDArray[Any]) -> None:
        """See `step_wait`."""
        self._actions = actions

    def step_wait(self) -> VecEnvStepReturn:
        """Step with actions (rows, size).

        Returns:
            observations (rows, size), rewards (rows,) float32, dones (rows,) bool, infos.

        Raises:
            ValueError: wrong shape, or a number that is not finite. Nothing has changed then.
        """
        simulator, actions = self.simulator, np.asarray(self._actions)
        expected = (self.num_envs, simulator.action_size)
        if actions.shape != expected:
            raise ValueError(f"actions: shape {actions.shape}, expected {expected}, (rows, action)")
        shape = (simulator.n_worlds, simulator.n_robots, simulator.action_size)
        done = simulator.step(actions.reshape(shape))
        over, rows = done.terminated | done.truncated, done.observations
        infos: list[dict[str, Any]] = [{"TimeLimit.truncated": False} for _ in range(self.num_envs)]
        if over.any():
            ended = np.flatnonzero(over)
            self._tell_ends(ended, done, infos)
            rows[ended] = simulator.reset(worlds=ended)
        rewards = done.rewards.astype(np.float32).reshape(-1)
        return self._flat(rows), rewards, np.repeat(over, simulator.n_robots), infos

    def get_images(self) -> Sequence[Frame | None]:
        """A frame of each world."""
        return [self.screen.show(w) for w in range(self.simulator.n_worlds)]

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Of each row: `name`, `world`, `robot`, `seed`; else the environment's or simulator's.

        Raises:
            AttributeError: there is none.
        """
        return [getattr(row, attr_name) for row in self._rows(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Set it for all rows.

        Raises:
            ValueError: for some only; rows share what they have.
        """
        if indices is not None:
            raise ValueError(f"indices: rows share {attr_name!r}, set it for all: indices=None")
        setattr(self, attr_name, value)

    def env_method(
        self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any
    ) -> list[Any]:
        """Call a method of each row, see `get_attr`."""
        rows = self._rows(indices)
        return [getattr(row, method_name)(*method_args, **method_kwargs) for row in rows]

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        """No row is."""
        return [False for _ in self._rows(indices)]

    def close(self) -> None:
        """End the live view, if there is one."""
        self.screen.close()

    def __copy__(self) -> FleetVecEnv:
        return copy.deepcopy(self)

    def _rows(self, indices: Any) -> Iterable[Row]:
        return [Row(self, int(i)) for i in self._get_indices(indices)]

    def _flat(self, rows: NDArray[np.float32]) -> NDArray[np.float32]:
        return rows.reshape(self.num_envs, -1)

    def _tell_ends(self, ended: NDArray[np.int64], done: Step, infos: list[dict[str, Any]]) -> None:
        last, late = done.observations[ended], done.truncated[ended].tolist()
        arrived = (self.simulator.arrival_steps[ended] >= 0).tolist()
        collisions = self.simulator.collision_counts[ended].tolist()
        for k, w in enumerate(ended.tolist()):
            for i in range(self.simulator.n_robots):
                infos[w * self.simulator.n_robots + i] = {
                    "terminal_observation": last[k, i],
                    "TimeLimit.truncated": late[k],
                    "is_success": arrived[k][i],
                    "collisions": collisions[k][i],
                }


def shared_spaces(simulator: Simulator) -> tuple[Any, Any]:
    """The spaces of observation and action that all robots have.

    Raises:
        ValueError: they differ.
    """
    robots = range(simulator.n_robots)
    seen = [observation_box(simulator, i) for i in robots]
    done = [action_box(simulator, i) for i in robots]
    for i in robots:
        if seen[i] != seen[0] or done[i] != done[0]:
            first, other = simulator.names[0], simulator.names[i]
            raise ValueError(
                f"scenario: {first!r} and {other!r} observe or act differently; one policy needs"
                " robots of one kind, else use fgenv.parallel_env, or one learner of"
                " gymnasium.make_vec"
            )
    return seen[0], done[0]
