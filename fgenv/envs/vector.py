"""Gymnasium: one robot learns in each of many worlds, stepped at once in native code.

>>> import gymnasium
>>> import fgenv.envs
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

from .infos import measured
from .parallel import single
from .rendering import MODES, Frame, Screen
from .simulator import Simulator, Source, seeds_of
from .single_agent import Learner
from .spaces import action_box, observation_box
from .state_readers import MOVING

Told = dict[str, Any]


class FleetVectorEnv(VectorEnv[Floats32, Any, NDArray[Any]]):
    """Worlds of one scenario; world k of reset(seed=s) is a FleetEnv of reset(seed=s + k).

    A world that ends begins anew in the same step; what its robot observed at the end is in
    `final_obs`, and what was told of it in `final_info`. Infos are arrays (worlds,): `collision`
    (whether it met something), `masked`, `checks`, `success`, and `clearance` where measured.

    Args:
        scenario, robot, others, render_mode, options: see `FleetEnv`. A policy's `reset` is called
            when all begin anew, not where one world does.
        num_envs: worlds.
        max_episode_steps: in place of the scenario's horizon.
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
        **options: Any,
    ) -> None:
        single("a vector environment", options)
        options.setdefault("max_steps", max_episode_steps)
        self.simulator = Simulator(scenario, num_envs, autoreset=False, **options)
        self.learner = Learner(self.simulator, robot, others)
        self.num_envs = num_envs
        self.single_observation_space = observation_box(self.simulator, self.learner.place)
        self.single_action_space = action_box(self.simulator, self.learner.place)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.render_mode, self._screen = render_mode, Screen(self.simulator, render_mode)
        self.metadata = {**type(self).metadata, "render_fps": 1.0 / self.simulator.dt}  # type: ignore[misc]

    def reset(
        self,
        *,
        seed: int | Sequence[int] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Floats32, Told]:
        """Begin episodes: the first of seeds seed + k, or seed[k]; or the next ones.

        Args:
            options: `reset_mask`, (worlds,) bool: only those begin.
        """
        seeds = None if seed is None else seeds_of(seed, self.num_envs).tolist()
        super().reset(seed=seeds and seeds[0])
        which = (options or {}).get("reset_mask")
        if which is not None:
            which = np.flatnonzero(checked_mask(which, self.num_envs))
            seeds = seeds and [seeds[k] for k in which.tolist()]
        rows = self.learner.reset(seeds, which)
        return rows, with_masks(self._told(), np.ones(self.num_envs))

    def step(self, actions: ArrayLike) -> tuple[Floats32, Floats, Flags, Flags, Told]:
        """Step all worlds with actions (worlds, size); errors are those of `FleetEnv.step`."""
        done = self.learner.step(actions)
        ended = done.terminated | done.truncated
        told, rows = self._told(), done.observations
        if not ended.any():
            return *done, with_masks(told, np.ones(self.num_envs))
        final: Told = {
            "final_obs": objects(rows, ended),
            "final_info": with_masks(told, ended),
        }
        rows = self.learner.reset(worlds=np.flatnonzero(ended))
        told = with_masks(self._told(), np.ones(self.num_envs))
        return rows, *done[1:], {**told, **with_masks(final, ended)}

    def render(self) -> tuple[Frame | None, ...] | None:  # type: ignore[override]
        """A frame (360, 480, 3) of each world in mode `rgb_array`, else None.

        `human` shows the first world live.
        """
        if self.render_mode != "rgb_array":
            return self._screen.show()  # type: ignore[return-value]
        return tuple(self._screen.show(k) for k in range(self.num_envs))

    def close_extras(self, **kwargs: Any) -> None:
        """End the live view, if there is one."""
        self._screen.close()

    def _told(self) -> Told:
        simulator, place = self.simulator, self.learner.place
        told: Told = {
            "collision": simulator.hits[:, place] >= 0,
            "masked": simulator.masked[:, place],
            "checks": simulator.checks[:, place],
            "success": simulator.status[:, place] != MOVING,
        }
        if measured(simulator):
            told["clearance"] = simulator.clearances[:, place]
        return told

    def __copy__(self) -> FleetVectorEnv:
        return copy.deepcopy(self)


def with_masks(told: Told, where: ArrayLike) -> Told:
    """Each array with a mask `_name` of the worlds that it tells of."""
    mask = np.asarray(where, dtype=bool)
    return {**told, **{f"_{name}": mask.copy() for name in told}}


def objects(rows: Floats32, where: Flags) -> NDArray[np.object_]:
    """Rows as objects, None elsewhere."""
    found = np.full(len(rows), None, dtype=object)
    for k in np.flatnonzero(where):
        found[k] = rows[k]
    return found


def checked_mask(value: Any, n: int) -> Flags:
    """A mask (n,).

    Raises:
        ValueError: it is none.
    """
    mask = np.asarray(value)
    if mask.dtype != bool or mask.shape != (n,) or not mask.any():
        raise ValueError(f"reset_mask: got {value!r}, expected ({n},) bool, one at least True")
    return mask
