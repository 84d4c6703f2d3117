"""Contract tests for what others build on fgenv: what holds here holds there as well.

>>> from fgenv.testing import environment_test, scenario_test, simulator_test
>>> scenario_test("my.yaml")                                  # and all that stands on it
>>> environment_test(lambda: fgenv.parallel_env("my.yaml"))

Each raises AssertionError saying which law does not hold.
"""

from .environments import environment_test
from .scenarios import scenario_test
from .simulators import simulator_test

__all__ = ["environment_test", "scenario_test", "simulator_test"]
