"""The parts of ``fgenv bench planners`` in order, each yielded as it is done."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec

import numpy as np
from ompl import util as ou

from . import arm_run
from .goals import goals
from .rigid_run import Record, race_task, race_trap
from .task import Task
from .ways import FCL, PEERS

PROBLEMS = ("cubicles", "twist", "home", "cubicles:2")
TRAPS = ("bug_trap", "rings")
SOME_MBM = 3  # problems of a family


@dataclass(frozen=True)
class PlannerBenchConfig:
    """What to run.

    Attributes:
        problems: names, as `Task.of` takes them.
        seeds: of the searches.
        limit: CPU seconds of a search.
        resolution: meters, of discrete checks; None: 1 % of the room's diagonal.
        peers: of `PEERS`; python-fcl, which judges, is among them.
        traps: whether the traps are tried.
        mbm: MotionBenchMaker's problems of each family; None: a few where pinocchio is installed.
        arm_limit: CPU seconds of a search of theirs.
    """

    problems: tuple[str, ...] = PROBLEMS
    seeds: tuple[int, ...] = tuple(range(10))
    limit: float = 60.0
    resolution: float | None = None
    peers: tuple[str, ...] = tuple(PEERS)
    traps: bool = False
    mbm: int | None = None
    arm_limit: float = arm_run.LIMIT

    def check(self) -> None:
        """Raise errors of the options before anything runs.

        Raises:
            ImportError: a library is not installed.
            ValueError: a peer or number that there is not.
        """
        for name in self.peers:
            if name not in PEERS:
                raise ValueError(f"peers: got {name!r}, expected some of {', '.join(PEERS)}")
            import_module(PEERS[name])
        if FCL not in self.peers:
            raise ValueError(f"peers: expected {FCL} among them, it is the judge")
        if self.mbm and not find_spec("pinocchio"):
            raise ImportError("pinocchio is not installed; remedy: pip install pin")
        if not self.limit > 0:
            raise ValueError(f"time_limit: got {self.limit}, expected seconds over 0")

    @property
    def arms(self) -> list[int]:
        """Numbers of MotionBenchMaker's problems, spread over the hundred of a family."""
        count = self.mbm
        if count is None:
            count = SOME_MBM if find_spec("pinocchio") else 0
        return sorted({round(x) for x in np.linspace(1, 100, count).tolist()})


def bench_planners(
    config: PlannerBenchConfig, report_progress: Callable[[str], None] = lambda doing: None
) -> Iterator[tuple[str, Record]]:
    """Yield (kind, record): `problems`, `traps`, `mbm` by family, `goals` at last.

    Seconds are CPU-seconds of the process. `report_progress` receives progress messages.
    """
    config.check()
    tasks = [Task.of(name, config.resolution) for name in config.problems]
    done: dict[str, list[Record]] = {"problems": [], "traps": [], "mbm": []}
    with silent():
        for kind, record in _parts(config, tasks, report_progress):
            done[kind].append(record)
            yield kind, record
    yield "goals", goals(done)


def _parts(
    config: PlannerBenchConfig, tasks: Sequence[Task], report_progress: Callable[[str], None]
) -> Iterator[tuple[str, Record]]:
    def named(name: str) -> Callable[[str], None]:
        return lambda doing: report_progress(f"{name}: {doing}")

    for task in tasks:
        yield (
            "problems",
            race_task(task, config.peers, config.seeds, config.limit, named(task.name)),
        )
    for name in TRAPS if config.traps else ():
        task = Task.of(name, config.resolution)
        yield "traps", race_trap(task, config.seeds, config.limit, named(name))
    for family in arm_run.FAMILIES if config.arms else ():
        yield (
            "mbm",
            arm_run.race_family(
                family, config.arms, config.seeds[0], config.arm_limit, named("mbm")
            ),
        )


@contextmanager
def silent() -> Iterator[None]:
    """OMPL says nothing meanwhile."""
    level = ou.getLogLevel()
    ou.setLogLevel(ou.LOG_NONE)
    try:
        yield
    finally:
        ou.setLogLevel(level)
