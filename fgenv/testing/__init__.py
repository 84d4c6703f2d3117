"""Contract tests for scenarios, simulators and environments built on fgenv.

>>> from fgenv.testing import environment_test, scenario_test, simulator_test
>>> scenario_test("my.yaml")                                  # includes the two other tests
>>> environment_test(lambda: fgenv.parallel_env("my.yaml"))

Each raises AssertionError with the violated law.
"""

from .environments import environment_test
from .scenarios import scenario_test
from .simulators import simulator_test

__all__ = ["environment_test", "scenario_test", "simulator_test"]


def __dir__() -> list[str]:
    return __all__
