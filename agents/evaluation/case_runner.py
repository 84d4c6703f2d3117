"""Episodes of the cases of a frozen set: one world per case, all stepped at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fgenv.agents.policies.goto import GoToPolicy
from fgenv.envs import Observation, Policy, Simulator, View
from fgenv.metrics import Results
from fgenv.scenarios import FrozenSet


@dataclass(frozen=True)
class CaseResult:
    """Result of a policy in one case.

    Attributes:
        case: number of the case in the set.
        results: of the robots.
        robot_collisions, body_collisions: number of steps in which each robot collided with
            another robot, or with anything else.
    """

    case: int
    results: Results
    robot_collisions: tuple[int, ...]
    body_collisions: tuple[int, ...]

    @property
    def success(self) -> bool:
        """Whether every robot reached its goal in time without a collision."""
        return all(robot.success for robot in self.results.robots)


def run_cases(
    cases: FrozenSet,
    policy: Policy,
    indices: Sequence[int],
    *,
    clearance: bool = True,
    max_steps: int | None = None,
    threads: int | None = None,
    progress: Callable[[int], object] | None = None,
) -> list[CaseResult]:
    """Run episodes of some cases; return the results in the same order.

    The simulator uses the attributes `observation` and `actions` of the policy, if it has them. A
    world with an ended episode runs its case again; the repetition is not counted.

    Args:
        indices: numbers of distinct cases.
        clearance: measure clearances, which takes longer.
        max_steps: of an episode, instead of the scenario's horizon.
        progress: called with the number of completed episodes.
    """
    simulator = Simulator(
        cases,
        len(indices),
        observation=getattr(policy, "observation", None),
        actions=getattr(policy, "actions", "drive"),
        case_order="seed",
        clearance=clearance,
        max_steps=max_steps,
        autoreset=False,
        threads=threads,
    )
    observations, seeds = simulator.reset(seed=indices), np.asarray(indices)
    policy.reset(View(simulator))
    collisions = np.zeros((2, simulator.n_worlds, simulator.n_robots), dtype=np.int64)
    results: dict[int, CaseResult] = {}  # by world
    while len(results) < len(indices):
        step = simulator.step(policy.act(observations))
        collisions += step_collisions(simulator)
        observations, ended = step.observations, np.flatnonzero(step.terminated | step.truncated)
        for w in ended.tolist():
            with_robots, with_bodies = map(tuple, collisions[:, w].tolist())
            result = CaseResult(indices[w], Results.of(simulator, w), with_robots, with_bodies)
            results.setdefault(w, result)
        if len(ended) and len(results) < len(indices):
            observations[ended] = simulator.reset(seeds[ended].tolist(), worlds=ended)
        if len(ended) and progress is not None:
            progress(len(results))
    return [results[w] for w in range(len(indices))]


def step_collisions(simulator: Simulator) -> list[np.ndarray]:
    """Return collisions of the last step with other robots and with other bodies, (worlds, n)."""
    hits, robots = simulator.hits >= 0, simulator.hit_robots
    others = (robots >= 0) & (robots != np.arange(simulator.n_robots))  # not its own links
    return [hits & others, hits & ~others]


def run_unobstructed(
    cases: FrozenSet, indices: Sequence[int], *, threads: int | None = None
) -> list[Results]:
    """Run `goto` where all bodies pass through each other: the baseline of times and distances."""
    template = cases.template.model_copy(update={"on_collision": "pass"})
    policy = GoToPolicy()
    policy.observation = Observation(velocity=False, lidar=False, neighbors=0)
    passing = replace(cases, template=template)
    episodes = run_cases(passing, policy, indices, clearance=False, threads=threads)
    return [episode.results for episode in episodes]
