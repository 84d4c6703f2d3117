"""Scenarios: robots with starts and goals among bodies, as files and as generators.

>>> from fgenv.scenarios import Scenario
>>> scenario = Scenario.load("swap", n=8, seed=3, jitter=0.1)  # or Scenario.load("my.yaml")
>>> built = scenario.build()                                   # robots, starts, goals, poses
>>> built.world().contact_pairs()                                   # none
"""

from fgenv.scenarios import io as io  # registers the file formats
from fgenv.scenarios import library as library  # registers the built-in scenarios
from fgenv.scenarios.build import Built
from fgenv.scenarios.errors import Problem, ScenarioError
from fgenv.scenarios.frozen_set import FrozenSet, frozen
from fgenv.scenarios.load import validate
from fgenv.scenarios.scenario import Scenario

__all__ = [
    "Built",
    "FrozenSet",
    "Problem",
    "Scenario",
    "ScenarioError",
    "frozen",
    "validate",
]


def __dir__() -> list[str]:
    return __all__
