"""PettingZoo: all robots of one world act at once.

>>> import fgenv
>>> env = fgenv.parallel_env("swap", n=8, jitter=0.5)
>>> observations, infos = env.reset(seed=0)
>>> actions = {name: env.action_space(name).sample() for name in env.agents}
>>> observations, rewards, terminations, truncations, infos = env.step(actions)
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from gymnasium.spaces import Box
from gymnasium.utils.seeding import np_random
from numpy.typing import ArrayLike
from pettingzoo.utils import ParallelEnv

from fgenv.arrays import Floats, Floats32

from .infos import Info, infos
from .options import check_reset_options, first_seed, place_robots, places_in, refuse_worlds
from .rendering import MODES, Frame, Screen
from .simulator import Simulator, Source, StepResult
from .simulator_settings import MAX_STEPS, check_integer
from .single_agent import real_numbers
from .spaces import action_box, observation_box, state_box, state_of
from .state_readers import MOVING

Rows = dict[str, Floats32]
Infos = dict[str, Info]


class FleetParallelEnv(ParallelEnv):  # type: ignore[misc]
    """One world of a simulator; the names of the robots are the agents.

    A robot that arrives is terminated and leaves `agents`. At the horizon all other robots are
    truncated; if a collision ends the episode, all are terminated. Infos are those of `infos`.

    Args:
        simulator: of one world, without autoreset.
        render_mode: `rgb_array`, `human` or None.
    """

    metadata: ClassVar[dict[str, Any]] = {
        "name": "fgenv",
        "render_modes": MODES,
        "render_fps": 10,
        "is_parallelizable": True,
    }

    def __init__(self, simulator: Simulator, render_mode: str | None = None) -> None:
        if simulator.n_worlds != 1 or simulator.autoreset:
            raise ValueError(
                f"simulator: got worlds={simulator.n_worlds}, autoreset={simulator.autoreset},"
                " expected worlds=1, autoreset=False"
            )
        self.simulator, self.render_mode = simulator, render_mode
        self.possible_agents = list(simulator.names)
        self._active: tuple[int, list[str]] = -1, []
        self.metadata = {  # type: ignore[misc]
            **type(self).metadata,
            "name": f"fgenv/{simulator.scenario.name}",
            "render_fps": 1.0 / simulator.dt,
        }
        self._indices = {name: i for i, name in enumerate(self.possible_agents)}
        self._observation_spaces = [observation_box(simulator, i) for i in self._indices.values()]
        self._action_spaces = [action_box(simulator, i) for i in self._indices.values()]
        self._sizes = simulator.observation_sizes
        self._shapes = [(n,) for n in simulator.action_sizes]
        self._uniform = len(set(self._shapes)) == 1
        self._screen = Screen(simulator, render_mode)
        self.np_random, self.np_random_seed = np_random()

    @property
    def agents(self) -> list[str]:
        """Names of the robots whose episode is not over, also after `Simulator.set_state`."""
        if self._active[0] != self.simulator.changes:
            moving = self.simulator.begun and not self.simulator.over[0]
            status = self.simulator.status[0].tolist() if moving else ()
            names = [n for n, s in zip(self.possible_agents, status, strict=False) if s == MOVING]
            self._active = self.simulator.changes, names
        return self._active[1]

    @property
    def observation_spaces(self) -> dict[str, Box]:
        """Spaces of observations by robot."""
        return dict(zip(self.possible_agents, self._observation_spaces, strict=True))

    @property
    def action_spaces(self) -> dict[str, Box]:
        """Spaces of actions by robot."""
        return dict(zip(self.possible_agents, self._action_spaces, strict=True))

    def observation_space(self, agent: str) -> Box:
        """Return the space of observations (size,), see `Simulator.layouts`."""
        return self._observation_spaces[self._index(agent)]

    def action_space(self, agent: str) -> Box:
        """Return the space [-1, 1] of actions (size,), see `Simulator.action_names`."""
        return self._action_spaces[self._index(agent)]

    @cached_property
    def state_space(self) -> Box:
        """Space of `state`."""
        return state_box(self.simulator)

    def state(self) -> Floats32:
        """Return the state of the world, see `fgenv.envs.spaces.state_of`."""
        if not self.simulator.begun:
            raise RuntimeError("state: before the first reset, call reset()")
        return state_of(self.simulator)

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Rows, Infos]:
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
        if seed is not None:
            self.np_random, self.np_random_seed = np_random(seed)
        rows = self.simulator.reset(seed)
        if place_robots(self.simulator, places):
            rows = self.simulator.observe()
        return self._rows(rows[0], self.agents), dict(
            zip(self.agents, infos(self.simulator), strict=True)
        )

    def get_state(self) -> bytes:
        """Return the state of the episode, for `set_state`; see `Simulator.state`."""
        return self.simulator.state()

    def set_state(self, state: bytes) -> None:
        """Continue from a state of `get_state`, bit for bit.

        Raises:
            ValueError: the state is of another environment.
        """
        self.simulator.set_state(state)

    def step(
        self, actions: Mapping[str, ArrayLike]
    ) -> tuple[Rows, dict[str, float], dict[str, bool], dict[str, bool], Infos]:
        """Step with an action (size,) for each of `agents`.

        Actions of robots that have left are ignored: some libraries send actions of all robots
        until the last one has left. Without agents the episode is over, and nothing happens.

        Raises:
            ValueError: the action of an agent is missing, of a wrong shape or not finite, or an
                action is of an unknown robot. The state is unchanged.
            RuntimeError: before the first reset.
        """
        self._check_names(actions)
        if not self.agents:
            if not self.simulator.begun:
                raise RuntimeError("step: before the first reset, call reset()")
            return {}, {}, {}, {}, {}
        simulator, acting = self.simulator, self.agents
        step = self._step(actions)
        over, late = bool(step.terminated[0]), bool(step.truncated[0])
        indices = [self._indices[name] for name in acting]
        rewards, every = step.rewards[0].tolist(), infos(simulator)
        ends = [over or every[i]["success"] for i in indices]
        left = [n for n, end in zip(acting, ends, strict=True) if not (late or end)]
        self._active = simulator.changes, left  # without asking the simulator again
        return (
            self._rows(step.observations[0], acting),
            dict(zip(acting, [rewards[i] for i in indices], strict=True)),
            dict(zip(acting, ends, strict=True)),
            {name: late and not end for name, end in zip(acting, ends, strict=True)},
            dict(zip(acting, [every[i] for i in indices], strict=True)),
        )

    def render(self) -> Frame | None:
        """Return the frame (360, 480, 3) in mode `rgb_array`, else None; `human` shows it live."""
        return self._screen.show()

    def close(self) -> None:
        """End the live view, if there is one."""
        self._screen.close()

    def checked(self, agent: str, action: Any) -> Floats:
        """Return an action as an array (size,).

        Raises:
            ValueError: wrong shape, or not finite numbers.
        """
        expected = self._shapes[self._index(agent)]
        numbers = real_numbers(action, f"action of {agent!r}")
        if numbers.shape != expected:
            raise ValueError(f"action of {agent!r}: got shape {numbers.shape}, expected {expected}")
        if not np.isfinite(numbers).all():
            raise ValueError(
                f"action of {agent!r}: got {numbers.tolist()}, expected finite numbers"
            )
        return numbers

    def __copy__(self) -> FleetParallelEnv:
        return copy.deepcopy(self)

    def _rows(self, rows: Floats32, agents: list[str]) -> Rows:
        indices, sizes = self._indices, self._sizes
        return {name: rows[indices[name], : sizes[indices[name]]] for name in agents}

    def _step(self, actions: Mapping[str, ArrayLike]) -> StepResult:
        every = np.zeros((1, len(self._indices), self.simulator.action_size))
        try:
            if self._uniform:  # one array is faster
                rows = np.array([actions[name] for name in self.agents])
                if rows.dtype.kind not in "biuf":
                    raise TypeError("actions: expected real numbers")  # named below
                if rows.shape == every.shape[1:]:
                    return self.simulator.step(rows[None])
                if rows.shape == (len(self.agents), every.shape[2]):
                    every[0, [self._indices[name] for name in self.agents]] = rows
                    return self.simulator.step(every)
            for name in self.agents:
                numbers = self.checked(name, actions[name])
                every[0, self._indices[name], : len(numbers)] = numbers
            return self.simulator.step(every)
        except (TypeError, ValueError):
            for name in self.agents:
                self.checked(name, actions[name])
            raise

    def _check_names(self, actions: Mapping[str, ArrayLike]) -> None:
        if not isinstance(actions, Mapping):
            kind = type(actions).__name__
            raise TypeError(f"actions: got {kind}, expected a dict, an action for each of agents")
        for name in self.agents:
            if name not in actions:
                raise ValueError(f"actions: got none for {name!r}, expected one for each of agents")
        if len(actions) > len(self.agents):
            for name in actions:
                self._index(name)

    def _index(self, agent: str) -> int:
        if agent not in self._indices:
            raise ValueError(f"robot: got {agent!r}, expected {', '.join(self._indices)}")
        return self._indices[agent]


def parallel_env(
    scenario: Source,
    *,
    render_mode: str | None = None,
    max_cycles: int | None = None,
    **options: Any,
) -> FleetParallelEnv:
    """Return a scenario as a PettingZoo ParallelEnv.

    Args:
        scenario: a name, a file, a Scenario, or a FrozenSet with a case per episode.
        render_mode: `rgb_array`, `human` or None.
        max_cycles: maximum number of steps of an episode, instead of the scenario's horizon.
        options: of `Simulator` (observation, reward, actions, starts, cases, clearance, threads),
            and overrides of the scenario (n, jitter, ...).

    Raises:
        ScenarioError, ValueError, TypeError: invalid arguments.
    """
    refuse_worlds("parallel_env", options)
    if max_cycles is not None:
        check_integer(max_cycles, "max_cycles", MAX_STEPS)
    simulator = Simulator(scenario, 1, autoreset=False, max_steps=max_cycles, **options)
    return FleetParallelEnv(simulator, render_mode)
