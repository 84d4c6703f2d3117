"""The checks of a certified search: recorded, and replayed without their cost."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fgenv.arrays import Flags, Floats

from .methods import Method
from .search import SearchResult, run, seeded


@dataclass(frozen=True)
class Recording:
    """The checks of a search, in their order.

    Attributes:
        starts, ends: of the checked motions, (n, size).
        free: verdicts on the motions, (n,).
        valid: verdicts on single states.
    """

    starts: Floats
    ends: Floats
    free: Flags
    valid: list[bool]


def record_checks(method: Method, seed: int, limit: float) -> Recording:
    """Run the search of `run` and record its checks."""
    search = seeded(method, seed)
    motions, validity = search.simple.motions, search.validity
    check_motion, check_state = motions.checkMotion, validity.isValid
    read = search.buffer.read
    rows: list[tuple[Floats, Floats, bool]] = []
    valid_states: list[bool] = []

    def record_motion(a: Any, b: Any) -> bool:
        free = bool(check_motion(a, b))
        rows.append((read(a), read(b), free))
        return free

    def record_state(state: Any) -> bool:
        valid_states.append(check_state(state))
        return valid_states[-1]

    motions.checkMotion, validity.isValid = record_motion, record_state
    run(search, limit, shorten=False)
    starts, ends, free = zip(*rows, strict=True)
    return Recording(np.array(starts), np.array(ends), np.array(free), valid_states)


def run_floor(method: Method, seed: int, limit: float, recording: Recording) -> SearchResult:
    """Run the recorded search with known verdicts: the cost of OMPL itself.

    Raises:
        RuntimeError: the search is another one.
    """
    search = seeded(method, seed)
    motions, states = iter(recording.free.tolist()), iter(recording.valid)
    next_motion, next_state = motions.__next__, states.__next__
    search.simple.motions.checkMotion = lambda a, b: next_motion()
    search.validity.isValid = lambda state: next_state()
    result = run(search, limit, shorten=False)
    if next(motions, None) is not None:
        raise RuntimeError("recording: the search with its seed and verdicts differs")
    return SearchResult(result.seconds, len(recording.valid), len(recording.free), None)
