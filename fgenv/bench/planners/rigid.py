"""Common parts of state checkers in Python on other libraries.

Models are built once. OMPL's `serialize` writes the numbers of a state into an array, and the
libraries read views of it: the fastest way to read a state in Python. Obstacles are either one
merged mesh or a tree of boxes over bodies, whichever is faster on the problem.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from itertools import combinations
from typing import Any

import numpy as np

from fgenv.arrays import Floats
from fgenv.bench.common.timing import round_seconds

Collides = Callable[[], bool]  # of the configuration in the bound row
Bind = Callable[[Floats], Collides]  # to a row (7 n,): x, y, z, qx, qy, qz, qw of each robot
TRIAL = 300  # configurations
MIXED = 0.01  # share of them that two models of one scene may differ on


def any_collision(
    moves: list[Callable[[], None]],
    bodies: list[Any],
    hits_obstacle: Callable[[Any], bool],
    hits_other: Callable[[Any, Any], Any],
) -> Collides:
    """Return a check of robots with obstacles and each other; it stops at the first collision."""
    if len(bodies) == 1:
        move, body = moves[0], bodies[0]

        def single() -> bool:
            move()
            return hits_obstacle(body)

        return single
    pairs, placed = list(combinations(bodies, 2)), list(zip(moves, bodies, strict=True))

    def several() -> bool:
        for move, body in placed:
            move()
            if hits_obstacle(body):
                return True
        return any(hits_other(a, b) for a, b in pairs)

    return several


def fastest(name: str, samples: Floats, binds: Sequence[Bind]) -> Bind:
    """Return the one of several models that takes least CPU time on random configurations.

    Their verdicts are equal, except where one uses a solid box, which contains a mesh.

    Raises:
        RuntimeError: the models differ.
    """
    row = np.empty(samples.shape[1])
    checks = [partial(verdicts, bind(row), row, samples[:TRIAL]) for bind in binds]
    if (np.mean([check() for check in checks], axis=0) % 1 > 0).mean() > MIXED:
        raise RuntimeError(f"{name}: two models of the same scene differ")
    seconds = round_seconds(dict(enumerate(checks)), 3)
    return min(enumerate(binds), key=lambda item: seconds[item[0]].min())[1]


def verdicts(collides: Collides, row: Floats, configurations: Floats) -> list[bool]:
    """Return whether each configuration collides."""
    results = []
    for q in configurations:
        row[:] = q
        results.append(collides())
    return results
