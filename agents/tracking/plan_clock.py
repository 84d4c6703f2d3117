"""Clock of an executed plan, which waits for delayed robots."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fgenv.agents.tracking.executable_plan import ExecutablePlan
from fgenv.arrays import Flags, Floats

HALVINGS = 7  # of the change of the clock's rate in a step
MIN_APPROACH, PATIENCE = 1e-4, 3  # meters, steps: a robot without progress for so long is stuck
MAX_PARALLEL = 0.2  # meters: a stuck robot that is closer continues beside its plan


@dataclass
class PlanExecution:
    """Execution of a plan in an episode of a world.

    Attributes:
        key: seed and number of the episode.
        course: the plan; None: all robots rest.
        clock: time in the plan, in steps; fractional after delays.
        rate: advance of the clock in the last step.
        steps: steps of the episode at the last update.
        waited: steps by which the clock is behind the episode.
        held: no step was certified; robots off the plan stay in place.
        nearest, stuck: smallest deviation of each robot off the plan (m), and the number of steps
            without progress.
    """

    key: tuple[int, int]
    course: ExecutablePlan | None
    clock: float = 0.0
    rate: float = 1.0
    steps: int = 0
    waited: float = 0.0
    held: bool = False
    nearest: Floats = field(default_factory=lambda: np.empty(0))
    stuck: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, dtype=np.int64))

    def delayed(self, off: Floats, tolerance: Floats) -> Flags:
        """Flags of robots that the clock waits for, (robots,).

        A stuck robot with a small deviation continues beside its plan, without a wait.

        Args:
            off: deviations from the plan (robots,), meters.
            tolerance: deviations that count as on the plan (robots,), meters.
        """
        if len(self.nearest) == 0:
            self.nearest, self.stuck = np.full(len(off), np.inf), np.zeros(len(off), dtype=np.int64)
        nearer, out = off < self.nearest - MIN_APPROACH, off > tolerance
        self.stuck = np.where(out & ~nearer, self.stuck + 1, 0)
        self.nearest = np.where(out, np.minimum(self.nearest, off), np.inf)
        return np.asarray(out & ((self.stuck < PATIENCE) | (off > MAX_PARALLEL)))


def clock_rates(run: PlanExecution, waits: bool) -> Sequence[float]:
    """Candidate advances of the clock in a step, best first; completes a fractional step."""
    target = 0.0 if waits else 1.0
    order = [run.rate + (target - run.rate) * 0.5**k for k in range(HALVINGS)]
    whole = int(run.clock) + 1 - run.clock
    return [*([] if waits or whole == 1.0 else [whole]), *order, run.rate]
