"""Random numbers that are the same on every machine and with every NumPy.

NumPy promises the raw bits of PCG64 for good, but not what `Generator` makes of them. Numbers that
go into a scenario are rounded to a micrometer or a microradian: short in a file, exact in a frozen
set, and without trace of the last bits.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

import numpy as np

from fgenv import _core

T = TypeVar("T")
MICRO = 6  # decimals


def micro(value: float) -> float:
    """Rounded to a micrometer or a microradian, and no -0."""
    return round(float(value), MICRO) + 0.0


class Dice:
    """A stream of random numbers."""

    def __init__(self, *seed: int) -> None:
        self._bits = np.random.PCG64(np.random.SeedSequence(seed))

    def unit(self) -> float:
        """Uniform in [0, 1), of 53 bits."""
        return float(int(self._bits.random_raw()) >> 11) * 2.0**-53

    def between(self, low: float, high: float) -> float:
        """Uniform, rounded to a millionth."""
        return micro(low + (high - low) * self.unit())

    def below(self, n: int) -> int:
        """A whole number from 0 to n - 1."""
        return int(self.unit() * n)

    def pick(self, items: Sequence[T]) -> T:
        """One of them."""
        return items[self.below(len(items))]

    def shuffled(self, items: Sequence[T]) -> list[T]:
        """All of them, in any order (Fisher and Yates)."""
        left = list(items)
        for k in range(len(left) - 1, 0, -1):
            j = self.below(k + 1)
            left[k], left[j] = left[j], left[k]
        return left


def sin_cos(angle: float) -> tuple[float, float]:
    """Sine and cosine by the native core."""
    sine, cosine = _core.sin_cos(angle)
    return float(sine), float(cosine)
