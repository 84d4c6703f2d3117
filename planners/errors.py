"""What goes wrong in planning."""

from __future__ import annotations

from typing import Any


class PlanningError(RuntimeError):
    """No plan: the message says why, and what to change.

    Attributes:
        best: what there was by then, as far as a method has something to show; else None.
    """

    def __init__(self, message: str, best: Any = None) -> None:
        super().__init__(message)
        self.best = best
