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
from numpy.typing import ArrayLike, NDArray
from pettingzoo.utils import ParallelEnv

from .infos import Told, infos
from .rendering import MODES, Frame, Screen
from .simulator import Simulator, Source, Step
from .spaces import action_box, observation_box, state_box, state_of

Rows = dict[str, NDArray[np.float32]]
Infos = dict[str, Told]


class FleetParallelEnv(ParallelEnv):  # type: ignore[misc]
    """One world of a simulator, each robot an agent by its name.

    A robot that arrives is terminated, and leaves `agents`. At the horizon all who are left are
    truncated; where a collision ends the episode, all are terminated. Infos are those of `infos`.

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
            raise ValueError("simulator: expected worlds=1, autoreset=False")
        self.simulator, self.render_mode = simulator, render_mode
        self.possible_agents = list(simulator.names)
        self.agents: list[str] = []
        self.metadata = {  # type: ignore[misc]
            **type(self).metadata,
            "name": f"fgenv/{simulator.scenario.name}",
            "render_fps": 1.0 / simulator.dt,
        }
        self._places = {name: i for i, name in enumerate(self.possible_agents)}
        self._observation_spaces = [observation_box(simulator, i) for i in self._places.values()]
        self._action_spaces = [action_box(simulator, i) for i in self._places.values()]
        self._sizes = simulator.observation_sizes
        self._shapes = [(n,) for n in simulator.action_sizes]
        self._alike = len(set(self._shapes)) == 1
        self._screen = Screen(simulator, render_mode)

    def observation_space(self, agent: str) -> Box:
        """Float32 (size,), see `Simulator.layouts`; the same object for each call."""
        return self._observation_spaces[self._place(agent)]

    def action_space(self, agent: str) -> Box:
        """[-1, 1], float32 (size,), see `Simulator.action_names`; the same object each time."""
        return self._action_spaces[self._place(agent)]

    @cached_property
    def state_space(self) -> Box:
        """Of `state`."""
        return state_box(self.simulator)

    def state(self) -> NDArray[np.float32]:
        """The time gone, and of all robots: configuration, goal, velocity, if it is on its way."""
        if not self.simulator.begun:
            raise RuntimeError("state: before the first reset, call reset()")
        return state_of(self.simulator)

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Rows, Infos]:
        """Begin an episode: the first of a seed, or the next one. Options are not looked at."""
        rows = self.simulator.reset(seed)[0]
        self.agents = list(self.possible_agents)
        told = dict(zip(self.agents, infos(self.simulator), strict=True))
        return self._rows(rows, self.agents), told

    def step(
        self, actions: Mapping[str, ArrayLike]
    ) -> tuple[Rows, dict[str, float], dict[str, bool], dict[str, bool], Infos]:
        """Step with an action (size,) for each of `agents`.

        Raises:
            ValueError: naming a robot that is missing, unknown or there already, or an action of
                another shape or not finite. Nothing has changed then.
            RuntimeError: nobody is on the way.
        """
        if not self.agents:
            raise RuntimeError("step: nobody is on the way, call reset()")
        simulator, acting = self.simulator, self.agents
        done = self._stepped(actions)
        over, late = bool(done.terminated[0]), bool(done.truncated[0])
        places = [self._places[name] for name in acting]
        rewards, told = done.rewards[0].tolist(), infos(simulator)
        ends = [over or told[i]["success"] for i in places]
        self.agents = [n for n, end in zip(acting, ends, strict=True) if not (late or end)]
        return (
            self._rows(done.observations[0], acting),
            dict(zip(acting, [rewards[i] for i in places], strict=True)),
            dict(zip(acting, ends, strict=True)),
            {name: late and not end for name, end in zip(acting, ends, strict=True)},
            dict(zip(acting, [told[i] for i in places], strict=True)),
        )

    def render(self) -> Frame | None:
        """The frame (360, 480, 3) in mode `rgb_array`, else None; `human` is shown live."""
        return self._screen.show()

    def close(self) -> None:
        """End the live view, if there is one."""
        self._screen.close()

    def checked(self, agent: str, action: Any) -> NDArray[np.float64]:
        """An action as numbers (size,).

        Raises:
            ValueError: naming the robot, saying what came and what is expected.
        """
        expected = self._shapes[self._place(agent)]
        try:
            numbers = np.asarray(action, dtype=np.float64)
        except (TypeError, ValueError):
            raise ValueError(f"action of {agent!r}: got {action!r}, expected numbers") from None
        if numbers.shape != expected:
            raise ValueError(f"action of {agent!r}: shape {numbers.shape}, expected {expected}")
        if not np.isfinite(numbers).all():
            raise ValueError(
                f"action of {agent!r}: got {numbers.tolist()}, expected finite numbers"
            )
        return numbers

    def __copy__(self) -> FleetParallelEnv:
        return copy.deepcopy(self)

    def _rows(self, rows: NDArray[np.float32], agents: list[str]) -> Rows:
        places, sizes = self._places, self._sizes
        return {name: rows[places[name], : sizes[places[name]]] for name in agents}

    def _stepped(self, actions: Mapping[str, ArrayLike]) -> Step:
        self._check_names(actions)
        asked = np.zeros((1, len(self._places), self.simulator.action_size))
        try:
            if self._alike:  # all at once is faster
                rows = np.array([actions[name] for name in self.agents], dtype=np.float64)
                if rows.shape == asked.shape[1:]:
                    return self.simulator.step(rows[None])
                if rows.shape == (len(self.agents), asked.shape[2]):
                    asked[0, [self._places[name] for name in self.agents]] = rows
                    return self.simulator.step(asked)
            for name in self.agents:
                numbers = self.checked(name, actions[name])
                asked[0, self._places[name], : len(numbers)] = numbers
            return self.simulator.step(asked)
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
                raise ValueError(f"actions: none for {name!r}, expected one for each of agents")
        if len(actions) > len(self.agents):
            name = next(name for name in actions if name not in self.agents)
            self._place(name)
            raise ValueError(f"actions: {name!r} has arrived, expected one for each of agents")

    def _place(self, agent: str) -> int:
        if agent not in self._places:
            raise ValueError(f"robot: {agent!r} is unknown, expected {', '.join(self._places)}")
        return self._places[agent]


def parallel_env(
    scenario: Source,
    *,
    render_mode: str | None = None,
    max_cycles: int | None = None,
    **options: Any,
) -> FleetParallelEnv:
    """A scenario as a PettingZoo ParallelEnv.

    Args:
        scenario: a name, a file, a Scenario, or a FrozenSet, each episode being one of its cases.
        render_mode: `rgb_array`, `human` or None.
        max_cycles: steps of an episode at most, in place of the scenario's horizon.
        options: of `Simulator` (observation, reward, actions, starts, cases, clearance, threads),
            and overrides of the scenario (n, jitter...).

    Raises:
        ScenarioError, ValueError, TypeError: saying what does not fit, and the remedy.
    """
    single("parallel_env", options)
    simulator = Simulator(scenario, 1, autoreset=False, max_steps=max_cycles, **options)
    return FleetParallelEnv(simulator, render_mode)


def single(face: str, options: dict[str, Any]) -> None:
    """TypeError where options ask for what a face of one world has not."""
    for name in ("worlds", "autoreset"):
        if name in options:
            raise TypeError(
                f"{name}: {face} has one world that ends; many are stepped by fgenv.envs.Simulator,"
                " gymnasium.make_vec or fgenv.agents.FleetVecEnv"
            )
