"""The very questions that a certified search asked: recorded, and answered beforehand."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Floats

from .search import Found, run, seeded
from .ways import Way


@dataclass(frozen=True)
class Recording:
    """A search's questions and answers, in their order.

    Attributes:
        starts, ends: of the motions asked, (n, size).
        free: (n,), the verdicts.
        valid: the verdicts on single states.
    """

    starts: Floats
    ends: Floats
    free: NDArray[np.bool_]
    valid: list[bool]


def recorded(way: Way, seed: int, limit: float) -> Recording:
    """The same search as `run` does, watched."""
    search = seeded(way, seed)
    motions, validity = search.simple.motions, search.validity
    free, valid, read = motions.checkMotion, validity.isValid, search.buffer.read
    rows: list[tuple[Floats, Floats, bool]] = []
    answers: list[bool] = []

    def watched_motion(a: Any, b: Any) -> bool:
        answer = free(a, b)
        rows.append((read(a), read(b), answer))
        return bool(answer)

    def watched_state(state: Any) -> bool:
        answers.append(valid(state))
        return answers[-1]

    motions.checkMotion, validity.isValid = watched_motion, watched_state
    run(search, limit, shorten=False)
    starts, ends, said = zip(*rows, strict=True)
    return Recording(np.array(starts), np.array(ends), np.array(said), answers)


def floor(way: Way, seed: int, limit: float, known: Recording) -> Found:
    """The same search once more, its answers known beforehand: what OMPL itself takes.

    Raises:
        RuntimeError: it asked for something else.
    """
    search = seeded(way, seed)
    motions, states = iter(known.free.tolist()), iter(known.valid)
    next_motion, next_state = motions.__next__, states.__next__
    search.simple.motions.checkMotion = lambda a, b: next_motion()
    search.validity.isValid = lambda state: next_state()
    found = run(search, limit, shorten=False)
    if next(motions, None) is not None:
        raise RuntimeError("a search with the same seed and answers was another one")
    return Found(found.seconds, len(known.valid), len(known.free), None)
