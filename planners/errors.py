"""Errors of planning."""

from __future__ import annotations

from typing import Any


class PlanningError(RuntimeError):
    """No plan was found; the message gives the reason and the remedy.

    Attributes:
        best: partial result of the method, or None.
    """

    def __init__(self, message: str, best: Any = None) -> None:
        super().__init__(message)
        self.best = best
