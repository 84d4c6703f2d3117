"""Clocks of plans that are driven: how far each is, and whom it waits for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fgenv.agents.tracking.executable_plan import Course
from fgenv.arrays import Flags, Floats

HALVINGS = 7  # of how much a clock changes its rate at once
NEARER, PATIENCE = 1e-4, 3  # meters, steps: who comes no nearer for so long does not
BESIDE = 0.2  # meters: who comes no nearer than that goes on beside its course


@dataclass
class Run:
    """An episode of a world.

    Attributes:
        key: seed and number of the episode.
        course: None: there is none, all rest.
        clock: steps of the course that were made; a part of one where robots were held up.
        rate: that the clock went on by in the last step.
        steps: of the episode, when it was last looked at.
        waited: steps by which the clock is behind the episode's.
        held: no step was proved, so that who is off its course stays where it is.
        nearest, stuck: how near each robot that is off its course came (m), and for how many steps
            it has come no nearer.
    """

    key: tuple[int, int]
    course: Course | None
    clock: float = 0.0
    rate: float = 1.0
    steps: int = 0
    waited: float = 0.0
    held: bool = False
    nearest: Floats = field(default_factory=lambda: np.empty(0))
    stuck: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, dtype=np.int64))

    def late(self, off: Floats, tolerance: Floats) -> Flags:
        """Who is to be waited for, of robots that are `off` their courses (robots,).

        Not for who comes no nearer, a small way off: it drives along its course, beside it.
        """
        if len(self.nearest) == 0:
            self.nearest, self.stuck = np.full(len(off), np.inf), np.zeros(len(off), dtype=np.int64)
        nearer, out = off < self.nearest - NEARER, off > tolerance
        self.stuck = np.where(out & ~nearer, self.stuck + 1, 0)
        self.nearest = np.where(out, np.minimum(self.nearest, off), np.inf)
        return np.asarray(out & ((self.stuck < PATIENCE) | (off > BESIDE)))


def rates(run: Run, waits: bool) -> Sequence[float]:
    """How far the clock may go on in a step, best first: to a whole step where it is between."""
    expected = 0.0 if waits else 1.0
    order = [run.rate + (expected - run.rate) * 0.5**k for k in range(HALVINGS)]
    whole = int(run.clock) + 1 - run.clock
    return [*([] if waits or whole == 1.0 else [whole]), *order, run.rate]
