"""Gymnasium: one robot learns in each of many worlds, stepped at once in native code.

>>> import gymnasium
>>> import fgenv
>>> envs = gymnasium.make_vec("fgenv/swap-v0", num_envs=32, n=8, jitter=0.5, others="goto")
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import ArrayLike, NDArray

from fgenv.arrays import Flags, Floats, Floats32

from .infos import Info, info_arrays
from .options import check_reset_options, first_seed, place_robots, places_in, refuse_worlds
from .rendering import MODES, Frame, Screen
from .simulator import Simulator, Source, world_seeds
from .single_agent import LearnerState, LearningRobot
from .spaces import action_box, observation_box


class FleetVectorEnv(VectorEnv[Floats32, Any, NDArray[Any]]):
    """Worlds of one scenario; world k of reset(seed=s) equals a FleetEnv of reset(seed=s + k).

    Infos are arrays (worlds,), with the keys of `infos`.

    Args:
        scenario, robot, others, render_mode, options: see `FleetEnv`. `reset` of a policy is called
            when all worlds begin, not for single worlds.
        num_envs: number of worlds.
        max_episode_steps: instead of the scenario's horizon.
        autoreset_mode: `SAME_STEP`: a world with an ended episode begins the next one in the same
            step; `final_obs` and `final_info` have the last observation and info. `NEXT_STEP`: in
            the next step, whose action is ignored and whose reward is 0. `DISABLED`: reset it with
            the option `reset_mask`.
    """

    metadata: ClassVar[dict[str, Any]] = {  # type: ignore[misc]
        "render_modes": MODES,
        "render_fps": 10,
        "autoreset_mode": AutoresetMode.SAME_STEP,
    }

    def __init__(
        self,
        scenario: Source,
        num_envs: int = 1,
        *,
        robot: str | int = 0,
        others: Any = "rest",
        render_mode: str | None = None,
        max_episode_steps: int | None = None,
        autoreset_mode: str | AutoresetMode = AutoresetMode.SAME_STEP,
        **options: Any,
    ) -> None:
        self.autoreset_mode = autoreset_mode_of(autoreset_mode)
        refuse_worlds("a vector environment", options)
        options.setdefault("max_steps", max_episode_steps)
        self.simulator = Simulator(scenario, num_envs, autoreset=False, **options)
        self.learner = LearningRobot(self.simulator, robot, others)
        self.num_envs = num_envs
        self.single_observation_space = observation_box(self.simulator, self.learner.index)
        self.single_action_space = action_box(self.simulator, self.learner.index)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.render_mode, self._screen = render_mode, Screen(self.simulator, render_mode)
        self.metadata = {  # type: ignore[misc]
            **type(self).metadata,
            "render_fps": 1.0 / self.simulator.dt,
            "autoreset_mode": self.autoreset_mode,
        }

    def reset(
        self,
        *,
        seed: int | Sequence[int] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Floats32, Info]:
        """Begin episodes: the first of seeds seed + k, or seed[k]; or the next ones.

        Without a seed the first episodes have seeds of fresh entropy, see `np_random_seed`.

        Args:
            options: `reset_mask`, (worlds,) bool: the worlds that begin; `starts` and `goals`:
                configurations (nq,), or (worlds that begin, nq), by name of robot.

        Raises:
            TypeError, ValueError: as `FleetEnv.reset`, or a mask of another shape.
        """
        check_reset_options(options)
        seed = first_seed(self.simulator, seed)
        seeds = None if seed is None else world_seeds(seed, self.num_envs).tolist()
        super().reset(seed=seeds and seeds[0])
        worlds = (options or {}).get("reset_mask")
        if worlds is not None:
            worlds = np.flatnonzero(checked_mask(worlds, self.num_envs))
            seeds = seeds and [seeds[k] for k in worlds.tolist()]
        begin = self.num_envs if worlds is None else len(worlds)
        places = places_in(self.simulator, options, begin)
        rows = self.learner.reset(seeds, worlds)
        if place_robots(self.simulator, places, worlds):
            rows = self.learner.observe()
        return rows, self._infos()

    def get_state(self) -> LearnerState:
        """Return the state of the episode and of the other robots' policy, for `set_state`."""
        return self.learner.get_state()

    def set_state(self, state: LearnerState) -> None:
        """Continue from a state of `get_state`, bit for bit.

        Raises:
            ValueError: the state is of another environment.
        """
        self.learner.set_state(state)

    def step(self, actions: ArrayLike) -> tuple[Floats32, Floats, Flags, Flags, Info]:
        """Step all worlds with actions (worlds, size); errors are those of `FleetEnv.step`."""
        step = self.learner.step(actions, self.autoreset_mode == AutoresetMode.NEXT_STEP)
        ended = step.terminated | step.truncated
        if not ended.any() or self.autoreset_mode != AutoresetMode.SAME_STEP:
            return *step, self._infos()
        final: Info = {
            "final_obs": as_objects(step.observations, ended),
            "final_info": self._infos(ended),
        }
        observations = self.learner.reset(worlds=np.flatnonzero(ended))
        return observations, *step[1:], {**self._infos(), **with_masks(final, ended)}

    def render(self) -> tuple[Frame | None, ...] | None:  # type: ignore[override]
        """Return a frame (360, 480, 3) of each world in mode `rgb_array`, else None.

        `human` shows the first world live.
        """
        if self.render_mode != "rgb_array":
            return self._screen.show()  # type: ignore[return-value]
        return tuple(self._screen.show(k) for k in range(self.num_envs))

    def close_extras(self, **kwargs: Any) -> None:
        """End the live view, if there is one."""
        self._screen.close()

    def _infos(self, mask: Flags | None = None) -> Info:
        """Infos of all worlds, or of those of a mask."""
        arrays, robot = info_arrays(self.simulator), self.learner.index
        info: Info = {name: values[:, robot] for name, values in arrays.items()}
        return with_masks(info, np.ones(self.num_envs) if mask is None else mask)

    def __copy__(self) -> FleetVectorEnv:
        return copy.deepcopy(self)


def autoreset_mode_of(value: str | AutoresetMode) -> AutoresetMode:
    """Return a mode, given by itself or by its name or value.

    Raises:
        ValueError: no such mode.
    """
    for mode in AutoresetMode:
        if value in (mode, mode.name, mode.value):
            return mode
    expected = ", ".join(mode.name for mode in AutoresetMode)
    raise ValueError(f"autoreset_mode: got {value!r}, expected one of {expected}")


def with_masks(info: Info, where: ArrayLike) -> Info:
    """Return the arrays, each with the mask `_name` of the worlds for which it is valid."""
    mask = np.asarray(where, dtype=bool)
    return {**info, **{f"_{name}": mask.copy() for name in info}}


def as_objects(rows: Floats32, where: Flags) -> NDArray[np.object_]:
    """Return rows as objects; None outside of the mask."""
    objects = np.full(len(rows), None, dtype=object)
    for k in np.flatnonzero(where):
        objects[k] = rows[k]
    return objects


def checked_mask(value: Any, n: int) -> Flags:
    """Return a mask (n,).

    Raises:
        ValueError: wrong shape or dtype, or no world selected.
    """
    mask = np.asarray(value)
    if mask.dtype != bool or mask.shape != (n,) or not mask.any():
        raise ValueError(f"reset_mask: got {value!r}, expected ({n},) bool, one at least True")
    return mask
