"""The contract of a scenario."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from fgenv.envs import FleetParallelEnv, Simulator
from fgenv.scenarios import Scenario

from .environments import environment_test
from .laws import require
from .simulators import simulator_test


def scenario_test(source: str | Path | Scenario, steps: int = 30, **overrides: Any) -> None:
    """Test that a scenario is valid, and the contracts of its simulator and environment.

    Args:
        source: a name, a file, or a Scenario.
        steps: of each rollout.
        overrides: for `Scenario.load`.

    Raises:
        AssertionError, ScenarioError: the violated law, or the problem.
    """
    scenario = source if isinstance(source, Scenario) else Scenario.load(source, **overrides)
    problems = scenario.problems()
    require(not problems, f"{scenario.name}: {'; '.join(map(str, problems))}")

    def make(*, worlds: int, threads: int) -> Simulator:
        return Simulator(scenario, worlds, threads=threads, max_steps=max(2, steps // 2))

    def parallel() -> FleetParallelEnv:
        max_steps = max(3, steps // 2)
        return FleetParallelEnv(Simulator(scenario, 1, autoreset=False, max_steps=max_steps))

    simulator_test(make, steps)
    environment_test(parallel, steps)
