"""The edges of certified searches, checked again by every method."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from fgenv.arrays import Flags, Floats
from fgenv.bench.common.records import Record
from fgenv.bench.common.timing import race

from .methods import CERTIFIED, DISCRETE, Method, Search
from .recording import Recording
from .search import seeded

EDGES = 1000  # that all methods check
ROUNDS = 5
NATIVE = {CERTIFIED: "native", DISCRETE: "native discrete"}
ENDLESS = 1e9  # seconds: all methods check the same edges, whatever they take
Job = Callable[[Floats], object]  # of consecutive indices of edges


def replay(methods: Mapping[str, Method], recordings: Sequence[Recording], seed: int) -> Record:
    """Return seconds per edge, and per state, of each method, on the same edges.

    Returns:
        `all`, `free`, `hit`, `states`: seconds by method, through `si.checkMotion` and `si.isValid`
        of OMPL in a Python loop, among them `trivial`: a validator in Python that returns True;
        `native`, `native discrete`: fgenv in one batch. `edges`, `share`: their number, and the
        share of free edges.
    """
    starts, ends, free = select_edges(recordings, seed)
    edges, states = jobs_of(methods, starts, ends, seed)
    hits = int((~free).sum())
    kinds = {"hit": np.arange(0.0, hits), "free": np.arange(float(hits), len(free))}
    kinds = {kind: indices for kind, indices in kinds.items() if len(indices)}
    record: Record = {"edges": len(free), "share": float(free.mean())}
    record |= {kind: race(edges, indices, ROUNDS, ENDLESS) for kind, indices in kinds.items()}
    record["all"] = {
        name: sum(record[kind][name] * len(indices) for kind, indices in kinds.items()) / len(free)
        for name in edges
    }
    record["states"] = race(states, np.arange(0.0, len(free)), ROUNDS, ENDLESS)
    return record


def jobs_of(
    methods: Mapping[str, Method], starts: Floats, ends: Floats, seed: int
) -> tuple[dict[str, Job], dict[str, Job]]:
    """Return the jobs of `replay` by name: checks of edges, and checks of states."""
    edges: dict[str, Job] = {}
    states: dict[str, Job] = {}
    for name, method in methods.items():
        search = seeded(method, seed)
        search.simple.setup()
        edges[name], states[name] = python_jobs(search, starts, ends)
        if name in NATIVE:
            edges[NATIVE[name]] = native_job(search.simple.motions._core, starts, ends)
    trivial = seeded(methods[CERTIFIED], seed)
    trivial.simple.motions.checkMotion = lambda a, b: True
    edges["trivial"] = python_jobs(trivial, starts, ends)[0]
    return edges, states


def native_job(core: Any, starts: Floats, ends: Floats) -> Job:
    """Return checks of edges in native code alone."""
    return lambda indices: core.free(starts[slice_of(indices)], ends[slice_of(indices)])


def select_edges(recordings: Sequence[Recording], seed: int) -> tuple[Floats, Floats, Flags]:
    """Return at most EDGES random edges, those that are not free first."""
    starts, ends, free = (
        np.concatenate([getattr(r, name) for r in recordings])
        for name in ("starts", "ends", "free")
    )
    rows = np.random.default_rng(seed).permutation(len(starts))[:EDGES]
    rows = rows[np.argsort(free[rows], kind="stable")]
    return starts[rows], ends[rows], free[rows]


def python_jobs(search: Search, starts: Floats, ends: Floats) -> tuple[Job, Job]:
    """Return checks of edges, and of their ends, through OMPL in a Python loop."""
    si, write = search.si, search.buffer.write
    last = [write(si.allocState(), q) for q in ends]
    pairs = [(write(si.allocState(), q), s) for q, s in zip(starts, last, strict=True)]
    check, valid = si.checkMotion, si.isValid

    def edges(indices: Floats) -> None:
        for a, b in pairs[slice_of(indices)]:
            check(a, b)

    def states(indices: Floats) -> None:
        for s in last[slice_of(indices)]:
            valid(s)

    return edges, states


def slice_of(indices: Floats) -> slice:
    """Return consecutive indices as a slice."""
    return slice(int(indices[0]), int(indices[-1]) + 1)
