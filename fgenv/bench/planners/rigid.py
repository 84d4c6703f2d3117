"""Common parts of state checkers in Python on other libraries, as a careful user writes them.

Models are built once. OMPL's `serialize` writes the numbers of a state into an array whose
views are what the libraries take: no other way of reading a state was faster. All that stands is
either one merged mesh or a tree of boxes over bodies, whichever is faster on the problem at hand.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations
from time import process_time
from typing import Any

import numpy as np

from fgenv.arrays import Floats

Collides = Callable[[], bool]  # of the configuration in the row that was bound
Bind = Callable[[Floats], Collides]  # to a row (7 n,): x, y, z, qx, qy, qz, qw of each robot
TRIAL = 300  # configurations
MIXED = 0.01  # of them that two forms of one scene may differ on


def joined(
    moves: list[Callable[[], None]],
    bodies: list[Any],
    meets: Callable[[Any], bool],
    each_other: Callable[[Any, Any], Any],
) -> Collides:
    """Whether a robot collides with an obstacle or another robot; stops at the first collision."""
    if len(bodies) == 1:
        move, body = moves[0], bodies[0]

        def alone() -> bool:
            move()
            return meets(body)

        return alone
    pairs, placed = list(combinations(bodies, 2)), list(zip(moves, bodies, strict=True))

    def together() -> bool:
        for move, body in placed:
            move()
            if meets(body):
                return True
        return any(each_other(a, b) for a, b in pairs)

    return together


def faster(name: str, samples: Floats, ways: list[Bind]) -> Bind:
    """The one that takes least CPU on configurations at random.

    All say the same but where one takes a box for solid, and a mesh inside it is seen.
    """
    seconds, said = [], []
    for way in ways:
        row = np.empty(samples.shape[1])
        collides = way(row)
        runs = []
        for _ in range(3):
            began = process_time()
            said.append(asked(collides, row, samples[:TRIAL]))
            runs.append(process_time() - began)
        seconds.append(min(runs))
    if (np.mean(said, axis=0) % 1 > 0).mean() > MIXED:
        raise RuntimeError(f"{name}: two forms of the same scene differ")
    return ways[int(np.argmin(seconds))]


def asked(collides: Collides, row: Floats, configurations: Floats) -> list[bool]:
    """What each configuration's answer is."""
    answers = []
    for q in configurations:
        row[:] = q
        answers.append(collides())
    return answers
