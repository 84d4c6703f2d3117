"""The edges that certified searches asked for, asked again by every way."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Floats
from fgenv.bench.common.timing import race

from .edges import Recording
from .search import seeded
from .ways import CERTIFIED, DISCRETE, Search, Way

EDGES = 1000  # that all ways are asked
ROUNDS = 5
NATIVE = {CERTIFIED: "native", DISCRETE: "native discrete"}
ENDLESS = 1e9  # seconds: all ways are asked the same edges, whatever they take
Ask = Callable[[Floats], object]  # about edges by their places, which follow each other


def replay(ways: Mapping[str, Way], recordings: list[Recording], seed: int) -> dict[str, Any]:
    """Seconds an edge, and a state, of each way, on the same edges.

    Returns:
        `all`, `free`, `hit`, `states`: seconds by way, through `si.checkMotion` and `si.isValid` of
        OMPL from a loop of Python; `trivial` among them: a validator in Python that says yes;
        `native`, `native discrete`: ours in one batch. `edges`, `share`: how many, and how many of
        them are free.
    """
    starts, ends, free = chosen(recordings, seed)
    edges, states = jobs_of(ways, starts, ends, seed)
    kinds = {"hit": places(0, int((~free).sum())), "free": places(int((~free).sum()), len(free))}
    out: dict[str, Any] = {"edges": len(free), "share": float(free.mean())}
    for kind, which in kinds.items():
        if len(which):
            out[kind] = race(edges, which, ROUNDS, ENDLESS)
    both = [(out[kind], len(which)) for kind, which in kinds.items() if len(which)]
    out["all"] = {name: sum(o[name] * n for o, n in both) / len(free) for name in edges}
    out["states"] = race(states, places(0, len(free)), ROUNDS, ENDLESS)
    return out


def jobs_of(
    ways: Mapping[str, Way], starts: Floats, ends: Floats, seed: int
) -> tuple[dict[str, Ask], dict[str, Ask]]:
    """What `replay` races, by name: about edges, and about states."""
    edges: dict[str, Ask] = {}
    states: dict[str, Ask] = {}
    for name, way in ways.items():
        search = seeded(way, seed)
        search.simple.setup()
        edges[name], states[name] = questions(search, starts, ends)
        if name in NATIVE:
            edges[NATIVE[name]] = batch(search.simple.motions._core, starts, ends)
    nothing = seeded(ways[CERTIFIED], seed)
    nothing.simple.motions.checkMotion = lambda a, b: True
    edges["trivial"] = questions(nothing, starts, ends)[0]
    return edges, states


def batch(core: Any, starts: Floats, ends: Floats) -> Ask:
    """Ask about edges in native code alone."""
    return lambda some: core.free(starts[run_of(some)], ends[run_of(some)])


def chosen(recordings: list[Recording], seed: int) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """At most EDGES of all, those that are not free first."""
    starts, ends, free = (
        np.concatenate([getattr(r, name) for r in recordings])
        for name in ("starts", "ends", "free")
    )
    some = np.random.default_rng(seed).permutation(len(starts))[:EDGES]
    some = some[np.argsort(free[some], kind="stable")]
    return starts[some], ends[some], free[some]


def questions(search: Search, starts: Floats, ends: Floats) -> tuple[Ask, Ask]:
    """Ask OMPL about edges, and about their ends, one after another."""
    si, write = search.si, search.buffer.write
    last = [write(si.allocState(), q) for q in ends]
    pairs = [(write(si.allocState(), q), s) for q, s in zip(starts, last, strict=True)]
    check, valid = si.checkMotion, si.isValid

    def edges(some: Floats) -> None:
        for a, b in pairs[run_of(some)]:
            check(a, b)

    def states(some: Floats) -> None:
        for s in last[run_of(some)]:
            valid(s)

    return edges, states


def places(first: int, last: int) -> Floats:
    """Numbers that `race` cuts into chunks."""
    return np.arange(first, last, dtype=np.float64)


def run_of(some: Floats) -> slice:
    """What a chunk of them stands for."""
    return slice(int(some[0]), int(some[-1]) + 1)
