"""95 % confidence intervals of rates, means and medians."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

NORMAL = 1.959963984540054  # 97.5 % point of the normal distribution
SAMPLES, SEED = 2000, 0  # of the bootstrap


class Estimate(NamedTuple):
    """An estimate with its 95 % confidence interval; NaN without data."""

    value: float
    low: float
    high: float


def rate(successes: float, trials: int) -> Estimate:
    """Return the share of successes with Wilson's interval.

    E. B. Wilson, "Probable inference, the law of succession, and statistical inference", 1927.

    Raises:
        ValueError: successes below 0, or more than trials.
    """
    if not 0 <= successes <= trials:
        raise ValueError(f"successes: got {successes}, expected 0 to {trials}")
    if trials == 0:
        return Estimate(math.nan, math.nan, math.nan)
    p, z = successes / trials, NORMAL**2 / trials
    middle = (p + z / 2) / (1 + z)
    half = math.sqrt(p * (1 - p) * z + z**2 / 4) / (1 + z)
    low = 0.0 if successes == 0 else max(0.0, middle - half)
    return Estimate(p, low, 1.0 if successes == trials else min(1.0, middle + half))


def mean(values: Sequence[float]) -> Estimate:
    """Return the mean with its interval, see `bootstrap`."""
    return bootstrap(values, np.mean)


def median(values: Sequence[float]) -> Estimate:
    """Return the median with its interval, see `bootstrap`."""
    return bootstrap(values, np.median)


def bootstrap(values: Sequence[float], statistic: Callable[..., Any]) -> Estimate:
    """Return a statistic of values with the percentile interval of a bootstrap of a fixed seed.

    B. Efron, "Bootstrap methods: another look at the jackknife", 1979.

    Args:
        statistic: a function of an array and an axis, such as `numpy.mean`.
    """
    x = np.asarray(values, dtype=np.float64)
    if len(x) == 0:
        return Estimate(math.nan, math.nan, math.nan)
    drawn = np.random.default_rng(SEED).integers(len(x), size=(SAMPLES, len(x)))
    low, high = np.quantile(statistic(x[drawn], axis=1), [0.025, 0.975])
    return Estimate(float(statistic(x)), float(low), float(high))
