"""The parts of ``fgenv bench env`` in order."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from time import process_time

import numpy as np

from fgenv.arrays import Floats
from fgenv.bench.common.records import OWN, Record
from fgenv.bench.common.timing import Clock
from fgenv.bench.env import fgenv_
from fgenv.bench.env.batch import Batch, Library, race

ROBOTS, WORLDS = (4, 10), (1, 32, 1024)
GROWTH, GROWTH_WORLDS = (8, 16, 32, 64), 4  # numbers of robots; worlds of each
CARTS, CARTS_WORLDS = 64, (1, 32)


def bench_env(
    libraries: Sequence[Library],
    *,
    seed: int = 0,
    quick: bool = False,
    clock: Clock = process_time,
) -> Iterator[tuple[str, Record]]:
    """Yield (kind, record): `rates` for each number of robots and worlds; then, of fgenv alone,
    `warehouse` for each number of worlds, `growth` and `views`.

    Rates are robot-steps per CPU second of the process. `quick`: short rounds, 32 worlds at most.
    """
    rounds, seconds = (3, 0.15) if quick else (9, 0.8)

    def timed(batches: Mapping[str, Batch]) -> dict[str, Floats]:
        return race(batches, rounds, seconds, clock=clock)

    for worlds in WORLDS[: 2 if quick else None]:
        for robots in ROBOTS:
            able = [library for library in libraries if library.batched or worlds == 1]
            batches = {library.name: library.make(robots, worlds, seed) for library in able}
            yield "rates", rates(robots, worlds, timed(batches))
    if OWN not in {library.name for library in libraries}:
        return
    for worlds in CARTS_WORLDS:
        batches = {OWN: fgenv_.warehouse_batch(CARTS, worlds, seed)}
        yield "warehouse", rates(CARTS, worlds, timed(batches))
    crowds = {str(n): fgenv_.random_batch(n, GROWTH_WORLDS, seed) for n in GROWTH}
    yield "growth", growth(timed(crowds))
    for name, (view, below) in fgenv_.views(ROBOTS[-1], seed).items():
        yield "views", view_cost(name, view, timed({"view": view, "simulator": below}))


def rates(robots: int, worlds: int, times: Mapping[str, Floats]) -> Record:
    """Return the record of one size.

    It has the rate of each library (median, least and most over the rounds) and `ratio`, fgenv's
    speed-up: the median of the ratios of each round.
    """
    peers = {
        name: {"rate": 1.0 / float(np.median(t)), "least": 1.0 / t.max(), "most": 1.0 / t.min()}
        for name, t in times.items()
    }
    own = times.get(OWN)
    ratio = {
        name: float(np.median(t / own))
        for name, t in times.items()
        if own is not None and name != OWN
    }
    return {"robots": robots, "worlds": worlds, "peers": peers, "ratio": ratio}


def growth(times: Mapping[str, Floats]) -> Record:
    """Return seconds per robot-step by number of robots; `times`: the last over the first."""
    rows = [{"robots": int(n), "seconds": float(np.median(t))} for n, t in times.items()]
    fewest, *_, most = times.values()
    return {"rows": rows, "times": float(np.median(most / fewest))}


def view_cost(name: str, view: Batch, times: Mapping[str, Floats]) -> Record:
    """Return seconds per step of a view and its simulator; `rate`: relative rate of the view."""
    above, below = times["view"], times["simulator"]
    return {
        "name": name,
        "robots": view.robots,
        "worlds": view.worlds,
        "view": float(np.median(above)) * view.size,
        "simulator": float(np.median(below)) * view.size,
        "overhead": float(np.median(above - below)) * view.size,
        "rate": float(np.median(below / above)),
    }
