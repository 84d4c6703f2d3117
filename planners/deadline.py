"""Deadline of a planning call, checked within its long loops."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

from .errors import PlanningError


@dataclass(frozen=True)
class Deadline:
    """An instant of the monotonic clock, in seconds; by default there is none."""

    end: float = math.inf

    @classmethod
    def after(cls, seconds: float) -> Deadline:
        """Return the deadline that many seconds from now."""
        return cls(time.monotonic() + seconds)

    @property
    def left(self) -> float:
        """Seconds until the deadline; negative after it."""
        return self.end - time.monotonic()

    def check(self, work: str) -> None:
        """Raise PlanningError after the deadline."""
        if self.left < 0:
            raise PlanningError(f"the time limit ended during {work}; allow more time")


NEVER = Deadline()
