"""Recording of episodes while a simulator steps."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from fgenv import __version__
from fgenv.scenarios import Scenario
from fgenv.scenarios.hashes import urdf_hashes, with_hashes

from .record import ARRAYS, INITIAL, Record

if TYPE_CHECKING:
    from .simulator import Simulator, StepResult

RECORDED = (*INITIAL, "hits", "hit_robots", "hit_times", "hit_points", "clearances")


class Recorder:
    """Records an episode of one world.

    >>> recorder = Recorder(policy="mine")
    >>> simulator.reset(seed=0)
    >>> recorder.begin(simulator)
    >>> recorder.add(actions, simulator.step(actions))        # after each step
    >>> recorder.record().save("run.npz")                     # at any time
    """

    def __init__(self, policy: str = "") -> None:
        self.policy = policy
        self._rows: list[dict[str, Any]] = []
        self._simulator: Simulator | None = None

    @property
    def begun(self) -> bool:
        """Whether an episode is being recorded."""
        return self._simulator is not None

    def begin(self, simulator: Simulator, world: int = 0) -> None:
        """Begin at the start of a world's episode; discard the previous recording.

        Raises:
            ValueError: the simulator has autoreset, the episode has begun, or no such world.
        """
        if not 0 <= world < simulator.n_worlds:
            raise ValueError(f"world: got {world}, expected 0 to {simulator.n_worlds - 1}")
        if simulator.autoreset:
            raise ValueError("simulator: got autoreset=True, expected False to record it")
        if simulator.steps[world] != 0 or simulator.episodes[world] < 0:
            raise ValueError("simulator: got a running episode, expected its start; call reset()")
        self._simulator, self._world, self._rows = simulator, world, []
        self._ended = "stopped"
        self._first = {name: getattr(simulator, name)[world] for name in INITIAL}
        self._scenario = with_hashes(scenario_of_episode(simulator, world))
        self._about = metadata(simulator, world, self.policy)

    def add(self, actions: ArrayLike, step: StepResult) -> None:
        """Add the simulator's last step, made with these actions.

        Raises:
            RuntimeError: before `begin`, or a step is missing.
        """
        simulator, world = self._simulator, self._world if self._simulator else 0
        if simulator is None or simulator.steps[world] != len(self._rows) + 1:
            raise RuntimeError(
                "recorder: expected begin() after each reset, and add() for each step"
            )
        row = {name: getattr(simulator, name)[world] for name in RECORDED}
        row["actions"] = np.array(actions, dtype=np.float64)[world]
        row["rewards"] = step.rewards[world].copy()
        self._rows.append(row)
        if step.terminated[world] or step.truncated[world]:
            self._ended = "terminated" if step.terminated[world] else "truncated"

    def record(self) -> Record:
        """Return the record up to the last step.

        Raises:
            RuntimeError: before `begin`.
        """
        if self._simulator is None:
            raise RuntimeError("recorder: nothing is recorded; call begin() after a reset")
        n, size = self._simulator.n_robots, self._simulator.action_size
        tails = {"actions": (n, size), "hit_points": (n, 3)}
        arrays = {}
        for name, dtype in ARRAYS.items():
            rows = [row[name] for row in self._rows]
            if name in INITIAL:
                rows.insert(0, self._first[name])
            empty = np.empty((0, *tails.get(name, (n,))), dtype=dtype)
            arrays[name] = np.array(rows, dtype=dtype) if rows else empty
        return Record(self._scenario, {**self._about, "ended": self._ended}, arrays)


def scenario_of_episode(simulator: Simulator, world: int = 0) -> Scenario:
    """Return the scenario with the starts, goals and bodies of a world's episode."""
    scenario, frozen_set = simulator.scenario, simulator.cases.frozen_set
    if frozen_set is not None:
        case = frozen_set[int(simulator.case_numbers[world])]
        scenario = case.at(scenario.folder)
    starts, goals = simulator.configurations[world], simulator.goals[world]
    robots = tuple(
        spec.model_copy(update={"start": tuple(q[:nq].tolist()), "goal": tuple(g[:nq].tolist())})
        for spec, q, g, nq in zip(
            scenario.robots, starts, goals, (r.nq for r in simulator.robots), strict=True
        )
    )
    return scenario.model_copy(update={"robots": robots}).at(scenario.folder)


def metadata(simulator: Simulator, world: int, policy: str) -> dict[str, Any]:
    """Return a record's plain values beside the scenario."""
    return {
        "policy": policy,
        "seed": int(simulator.seeds[world]),
        "episode": int(simulator.episodes[world]),
        "actions": simulator.actions,
        "way_point_seconds": float(simulator.settings.way_point_seconds),
        "dt": simulator.dt,
        "names": {str(body): name for body, name in simulator.body_names.items()},
        "urdf": urdf_hashes(simulator.scenario),
        "versions": {"fgenv": __version__, "numpy": np.__version__},
    }
