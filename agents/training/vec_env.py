"""Stable-Baselines3: all robots of all worlds share one policy, over the simulator's arrays.

>>> from stable_baselines3 import PPO
>>> from fgenv.agents import FleetVecEnv
>>> envs = FleetVecEnv("swap", n_envs=32, n=8, jitter=0.5)       # 32 worlds of 8 robots: 256 rows
>>> PPO("MlpPolicy", envs).learn(100_000)
"""

from __future__ import annotations

import copy
import time
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

try:
    from stable_baselines3.common.vec_env import VecEnv
    from stable_baselines3.common.vec_env.base_vec_env import VecEnvStepReturn
except ModuleNotFoundError as error:
    if error.name != "stable_baselines3":
        raise
    raise ModuleNotFoundError(
        "FleetVecEnv needs stable_baselines3; pip install 'fgenv[agents]'", name=error.name
    ) from None

from fgenv.arrays import Floats32
from fgenv.envs import Simulator
from fgenv.envs.options import first_seed, place_robots, places_in
from fgenv.envs.rendering import Frame, Screen
from fgenv.envs.simulator import Source, StepResult
from fgenv.envs.spaces import action_box, observation_box


class RowEnv:
    """One robot of one world, for `get_attr` and `env_method`; other attributes are shared."""

    def __init__(self, envs: FleetVecEnv, index: int) -> None:
        self.envs = envs
        self.world, self.robot = divmod(index, envs.simulator.n_robots)

    @property
    def name(self) -> str:
        """Name of the robot."""
        return self.envs.simulator.names[self.robot]

    @property
    def seed(self) -> int:
        """Seed of the world."""
        return int(self.envs.simulator.seeds[self.world])

    def render(self) -> Frame | None:
        """Return the frame of the world."""
        return self.envs.screen.show(self.world)

    def __getattr__(self, name: str) -> Any:
        if name == "envs" or name.startswith("__"):
            raise AttributeError(name)
        return getattr(self.envs if hasattr(self.envs, name) else self.envs.simulator, name)


class FleetVecEnv(VecEnv):
    """Steps `n_envs` worlds at once; row w * n + i is robot i of world w, for n robots per world.

    As in Stable-Baselines3, `num_envs` is the number of rows, here n_envs * n.

    All rows of a world end together: when all robots have arrived, a collision ends the episode, or
    the horizon is reached. Robots that have arrived rest until then, at reward 0. World w of seed s
    is the world of `Simulator.reset(seed=s + w)`. Infos of rows that end have
    `terminal_observation`, `is_success` (the robot has arrived), `steps_in_contact`, and `episode`
    as Stable-Baselines3's Monitor gives it: return `r`, length `l`, seconds `t`; all infos have
    `TimeLimit.truncated`.

    Args:
        scenario: a name, a file, a Scenario, a FrozenSet; or a Simulator without autoreset.
        n_envs: number of worlds; ignored with a Simulator.
        render_mode: `rgb_array`, `human` or None.
        options: of `Simulator` (observation, reward, actions, starts, cases, clearance, max_steps,
            threads), and overrides of the scenario (n, jitter, ...).

    Raises:
        ScenarioError, ValueError, TypeError: invalid arguments.
    """

    def __init__(
        self,
        scenario: Source | Simulator,
        n_envs: int = 1,
        *,
        render_mode: str | None = None,
        **options: Any,
    ) -> None:
        if not isinstance(scenario, Simulator):
            scenario = Simulator(scenario, n_envs, autoreset=False, **options)
        self.simulator = scenario
        if self.simulator.autoreset:
            raise ValueError("simulator: got autoreset=True, expected False")
        observation, action = shared_spaces(self.simulator)
        self.render_mode, self.screen = render_mode, Screen(self.simulator, render_mode)
        self._seed: int | None = None
        self._returns = np.zeros(self.simulator.n_worlds * self.simulator.n_robots)
        self._began = time.perf_counter()
        rows = self.simulator.n_worlds * self.simulator.n_robots
        super().__init__(rows, observation, action)
        self.metadata: dict[str, Any] = {
            **self.metadata,
            "render_fps": 1.0 / self.simulator.dt,
        }

    def seed(self, seed: int | None = None) -> Sequence[int | None]:
        """Seed world w with seed + w at the next reset (None: randomly); return seeds of rows."""
        if seed is None:
            seed = int(np.random.default_rng().integers(2**32))
        self._seed = seed
        return [seed + w for w in range(self.simulator.n_worlds) for _ in self.simulator.names]

    def reset(self) -> Floats32:
        """Begin episodes; return observations (rows, size).

        The options `starts` and `goals` of `set_options` are configurations (nq,) by name of robot;
        a list of options has one per row, and those of a world's first row hold.

        Raises:
            TypeError, ValueError: as `fgenv.envs.FleetEnv.reset`.
        """
        simulator = self.simulator
        every = self._options[:: simulator.n_robots]
        given = [(w, places_in(simulator, options)) for w, options in enumerate(every)]
        rows = simulator.reset(first_seed(simulator, self._seed))
        placed = [place_robots(simulator, places, [w]) for w, places in given]
        if any(placed):
            rows = simulator.observe()
        self._seed = None
        self._returns[:] = 0.0
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
            ValueError: wrong shape, or a number that is not finite. The state is unchanged.
        """
        simulator, actions = self.simulator, np.asarray(self._actions)
        expected = (self.num_envs, simulator.action_size)
        if actions.shape != expected:
            raise ValueError(
                f"actions: got shape {actions.shape}, expected {expected}, (rows, size)"
            )
        shape = (simulator.n_worlds, simulator.n_robots, simulator.action_size)
        step = simulator.step(actions.reshape(shape))
        ended, observations = step.terminated | step.truncated, step.observations
        rewards = step.rewards.astype(np.float32).reshape(-1)
        self._returns += rewards
        infos: list[dict[str, Any]] = [{"TimeLimit.truncated": False} for _ in range(self.num_envs)]
        if ended.any():
            worlds = np.flatnonzero(ended)
            self._set_final_infos(worlds, step, infos)
            observations[worlds] = simulator.reset(worlds=worlds)
        return self._flat(observations), rewards, np.repeat(ended, simulator.n_robots), infos

    def get_state(self) -> tuple[bytes, NDArray[np.float64]]:
        """Return the state of all worlds and the returns of rows, for `set_state`."""
        return self.simulator.state(), self._returns.copy()

    def set_state(self, state: tuple[bytes, NDArray[np.float64]]) -> None:
        """Continue from a state of `get_state`, bit for bit.

        Raises:
            ValueError: the state is of another environment.
        """
        self.simulator.set_state(state[0])
        self._returns = state[1].copy()

    def get_images(self) -> Sequence[Frame | None]:
        """Return a frame of each world."""
        return [self.screen.show(w) for w in range(self.simulator.n_worlds)]

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return an attribute of each row: `name`, `world`, `robot`, `seed`, or a shared one of the
        environment or the simulator.

        Raises:
            AttributeError: no such attribute.
        """
        return [getattr(row, attr_name) for row in self._rows(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Set an attribute for all rows.

        Raises:
            ValueError: for some rows only; rows share their attributes.
        """
        if indices is not None:
            raise ValueError(f"indices: got {indices!r}, expected None: rows share {attr_name!r}")
        setattr(self, attr_name, value)

    def env_method(
        self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any
    ) -> list[Any]:
        """Call a method of each row, see `get_attr`."""
        rows = self._rows(indices)
        return [getattr(row, method_name)(*method_args, **method_kwargs) for row in rows]

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        """Return False for each row."""
        return [False for _ in self._rows(indices)]

    def close(self) -> None:
        """End the live view, if there is one."""
        self.screen.close()

    def __copy__(self) -> FleetVecEnv:
        return copy.deepcopy(self)

    def _rows(self, indices: Any) -> Iterable[RowEnv]:
        return [RowEnv(self, int(i)) for i in self._get_indices(indices)]

    def _flat(self, rows: Floats32) -> Floats32:
        return rows.reshape(self.num_envs, -1)

    def _set_final_infos(
        self, worlds: NDArray[np.int64], step: StepResult, infos: list[dict[str, Any]]
    ) -> None:
        n = self.simulator.n_robots
        last, truncated = step.observations[worlds], step.truncated[worlds].tolist()
        arrived = (self.simulator.arrival_steps[worlds] >= 0).tolist()
        in_contact = self.simulator.collision_counts[worlds].tolist()
        steps, seconds = self.simulator.steps[worlds].tolist(), time.perf_counter() - self._began
        for k, w in enumerate(worlds.tolist()):
            for i in range(n):
                row = w * n + i
                episode = {"r": float(self._returns[row]), "l": steps[k], "t": round(seconds, 6)}
                self._returns[row] = 0.0
                infos[row] = {
                    "episode": episode,
                    "terminal_observation": last[k, i],
                    "TimeLimit.truncated": truncated[k],
                    "is_success": arrived[k][i],
                    "steps_in_contact": in_contact[k][i],
                }


def shared_spaces(simulator: Simulator) -> tuple[Any, Any]:
    """Return the observation and action space of all robots.

    Raises:
        ValueError: spaces of robots differ.
    """
    robots = range(simulator.n_robots)
    observations = [observation_box(simulator, i) for i in robots]
    actions = [action_box(simulator, i) for i in robots]
    for i in robots:
        if observations[i] != observations[0] or actions[i] != actions[0]:
            first, other = simulator.names[0], simulator.names[i]
            raise ValueError(
                f"scenario: got {first!r} and {other!r} with different spaces, expected robots of"
                " one kind; use fgenv.parallel_env, or one learning robot with gymnasium.make_vec"
            )
    return observations[0], actions[0]
