"""The parts of ``fgenv bench planners`` in order."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec

import numpy as np
from ompl import util as ou

from fgenv.bench.common.records import Record

from . import arm_run
from .goals import goals
from .methods import FCL, PEERS
from .rigid_run import race_task, race_trap
from .search import Progress
from .task import Task

PROBLEMS = ("cubicles", "twist", "home", "cubicles:2")
TRAPS = ("bug_trap", "rings")
SOME_MBM = 3  # problems of a family


@dataclass(frozen=True)
class PlannerBenchConfig:
    """Options of the benchmark.

    Attributes:
        problems: names for `Task.of`.
        seeds: seeds of the searches.
        limit: CPU seconds per search.
        resolution: meters per step of discrete checks; None: 1 % of the room's diagonal.
        peers: names from `PEERS`, python-fcl among them, which checks all paths.
        traps: whether to run the traps.
        mbm: MotionBenchMaker's problems per family; None: a few if pinocchio is installed.
        arm_limit: CPU seconds per search of these.
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
        """Check the options.

        Raises:
            ImportError: a library is not installed.
            ValueError: an unknown peer, or a limit that is not positive.
        """
        for name in self.peers:
            if name not in PEERS:
                raise ValueError(f"peers: got {name!r}, expected some of {', '.join(PEERS)}")
            import_module(PEERS[name])
        if FCL not in self.peers:
            raise ValueError(f"peers: got {', '.join(self.peers)}, expected {FCL} among them")
        if self.mbm and not find_spec("pinocchio"):
            raise ImportError("pinocchio is not installed; remedy: pip install pin")
        if not self.limit > 0:
            raise ValueError(f"time_limit: got {self.limit}, expected seconds over 0")

    @property
    def arms(self) -> list[int]:
        """Numbers of MotionBenchMaker's problems, spread over the 100 of a family."""
        count = self.mbm
        if count is None:
            count = SOME_MBM if find_spec("pinocchio") else 0
        return sorted({round(x) for x in np.linspace(1, 100, count).tolist()})


def bench_planners(
    config: PlannerBenchConfig, report_progress: Progress = lambda message: None
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
    config: PlannerBenchConfig, tasks: Sequence[Task], report_progress: Progress
) -> Iterator[tuple[str, Record]]:
    def prefixed(name: str) -> Progress:
        return lambda message: report_progress(f"{name}: {message}")

    for task in tasks:
        progress = prefixed(task.name)
        yield "problems", race_task(task, config.peers, config.seeds, config.limit, progress)
    for name in TRAPS if config.traps else ():
        task = Task.of(name, config.resolution)
        yield "traps", race_trap(task, config.seeds, config.limit, prefixed(name))
    for family in arm_run.FAMILIES if config.arms else ():
        seed, limit = config.seeds[0], config.arm_limit
        yield "mbm", arm_run.race_family(family, config.arms, seed, limit, prefixed("mbm"))


@contextmanager
def silent() -> Iterator[None]:
    """Turn off the messages of OMPL."""
    level = ou.getLogLevel()
    ou.setLogLevel(ou.LOG_NONE)
    try:
        yield
    finally:
        ou.setLogLevel(level)
