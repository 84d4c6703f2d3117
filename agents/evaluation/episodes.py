"""Running policies through the cases of a frozen set: a world each, all stepped at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fgenv.agents.policies.goto import GoToPolicy
from fgenv.envs import Observation, Policy, Simulator, View
from fgenv.metrics import Results
from fgenv.scenarios import FrozenSet


@dataclass(frozen=True)
class Episode:
    """How a policy did in one case.

    Attributes:
        case: its number in the set.
        results: of its robots.
        met_robots, met_bodies: for each robot, steps in which it met another one, or anything else.
    """

    case: int
    results: Results
    met_robots: tuple[int, ...]
    met_bodies: tuple[int, ...]

    @property
    def success(self) -> bool:
        """Whether every robot came to its goal in time and met nothing."""
        return all(robot.success for robot in self.results.robots)


def run_cases(
    cases: FrozenSet,
    policy: Policy,
    which: Sequence[int],
    *,
    clearance: bool = True,
    max_steps: int | None = None,
    threads: int | None = None,
    progress: Callable[[int], object] | None = None,
) -> list[Episode]:
    """Episodes of some cases, in their order.

    The simulator has the policy's `observation` and `actions`, where it has such attributes. A
    world that is done begins its case again, and what happens then is not looked at.

    Args:
        which: numbers of cases, none twice.
        clearance: measure the least one, which takes longer.
        max_steps: of an episode, in place of the scenario's horizon.
        progress: called with the number of episodes that are done.
    """
    simulator = Simulator(
        cases,
        len(which),
        observation=getattr(policy, "observation", None),
        actions=getattr(policy, "actions", "drive"),
        case_order="seed",
        clearance=clearance,
        max_steps=max_steps,
        autoreset=False,
        threads=threads,
    )
    rows, seeds = simulator.reset(seed=which), np.asarray(which)
    policy.reset(View(simulator))
    met = np.zeros((2, simulator.n_worlds, simulator.n_robots), dtype=np.int64)
    found: dict[int, Episode] = {}
    while len(found) < len(which):
        step = simulator.step(policy.act(rows))
        hits, robots = simulator.hits >= 0, simulator.hit_robots
        robots = (robots >= 0) & (robots != np.arange(simulator.n_robots))  # not its own links
        met += [hits & robots, hits & ~robots]
        rows, ended = step.observations, np.flatnonzero(step.terminated | step.truncated)
        for w in ended.tolist():
            case, counts = which[w], met[:, w].tolist()
            found.setdefault(
                w, Episode(case, Results.of(simulator, w), tuple(counts[0]), tuple(counts[1]))
            )
        if len(ended) and len(found) < len(which):
            rows[ended] = simulator.reset(seeds[ended].tolist(), worlds=ended)
        if len(ended) and progress is not None:
            progress(len(found))
    return [found[w] for w in range(len(which))]


def straight(
    cases: FrozenSet, which: Sequence[int], *, threads: int | None = None
) -> list[Results]:
    """How each robot would do with nothing in its way: `goto`, and all pass through each other."""
    template = cases.template.model_copy(update={"on_collision": "pass"})
    open_, policy = replace(cases, template=template), GoToPolicy()
    policy.observation = Observation(velocity=False, lidar=False, neighbors=0)
    found = run_cases(open_, policy, which, clearance=False, threads=threads)
    return [episode.results for episode in found]
