"""What a user sees in an interactive session: names of packages, and texts of objects."""

from __future__ import annotations

import importlib

import pytest

import fgenv
from fgenv.agents import run_episode
from fgenv.envs import Simulator, policy_of
from fgenv.metrics import Results
from fgenv.scenarios import Scenario

PACKAGES = ("collision", "robots", "scenarios", "envs", "planners", "agents", "view", "testing")


@pytest.mark.parametrize("name", PACKAGES)
def test_dir_shows_the_public_names_and_they_are_documented(name: str) -> None:
    package = importlib.import_module(f"fgenv.{name}")
    assert sorted(dir(package)) == sorted(package.__all__)
    assert package.__doc__
    for public in package.__all__:
        assert getattr(package, public).__doc__


def test_objects_are_one_line_and_print_as_a_small_table() -> None:
    plan = fgenv.plan("doorway", n=1)
    record = run_episode(Simulator("swap", n=2, autoreset=False), policy_of("goto"), steps=3)
    results = Results.of(record)
    scenario = Scenario.load("swap", n=2)
    for thing in (plan, record, results, scenario):
        assert "\n" not in repr(thing)
        assert len(repr(thing)) < 100
    assert repr(scenario) == str(scenario) == "Scenario('swap': 2 robots, 0 bodies, seed 0)"
    assert str(plan).splitlines()[:2] == [repr(plan), "robot    arrives (s)  path (m)"]
    assert str(results).splitlines()[2].split() == ["robot", "1", "no", "-", "0", "0.30", "m", "-"]
