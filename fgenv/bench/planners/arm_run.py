"""MotionBenchMaker's problems for the Panda: fgenv certified against pinocchio and coal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, get_args

import numpy as np
from ompl import geometric as og

from fgenv.planners.ompl.spaces import StateLayout, state_space
from fgenv.planners.problem import Problem
from fgenv.scenarios.library.mbm import Family

from .arm import ARM, ArmTask, arm_bodies
from .rigid import Bind
from .rigid_run import Record, Told
from .search import Found, judge_of, run, seeded
from .ways import CERTIFIED, PythonChecker, Search, Way, ours

FAMILIES: tuple[str, ...] = get_args(Family)
LIMIT = 20.0  # seconds


def race_family(family: str, numbers: Sequence[int], seed: int, limit: float, told: Told) -> Record:
    """Problems of a family, one search each; the order of checkers rotates."""
    found: dict[str, list[Found]] = {CERTIFIED: [], ARM: []}
    hidden = dict.fromkeys(found, 0)
    for k, number in enumerate(numbers):
        task = ArmTask(
            f"{family} {number}", Problem.from_scenario("mbm", family=family, problem=number)
        )
        bind = arm_bodies(task)
        ways = {CERTIFIED: ours(task.problem), ARM: theirs(task, bind)}
        judge = judge_of(task, bind)
        for name in list(ways)[:: 1 if k % 2 else -1]:
            told(f"{family} {number}, {name}")
            run(seeded(ways[name], seed), 1e-3, shorten=False)  # the first touch pays for caches
            found[name].append(run(seeded(ways[name], seed), limit))
            path = found[name][-1].path
            hidden[name] += path is not None and judge(path)
    return {
        "family": family,
        "limit": limit,
        "ways": {name: told_of(runs, hidden[name]) for name, runs in found.items()},
    }


def theirs(task: ArmTask, bind: Bind) -> Way:
    """A checker in Python under OMPL's discrete motion validator, a step 1/32 rad at most."""
    robot = task.problem.models[0]
    layout = StateLayout(robot, robot.steering())
    ends = [layout.states(q) for q in (task.problem.starts[0], task.problem.goals[0])]

    def make() -> Search:
        space = state_space(layout)
        space.setLongestValidSegmentFraction(task.resolution / space.getMaximumExtent())
        simple = og.SimpleSetup(space)
        si = simple.getSpaceInformation()
        checker = PythonChecker(si, bind, robot.nq)
        simple.setStateValidityChecker(checker)
        search = Search(simple, checker)
        simple.setStartAndGoalStates(*(search.buffer.write(si.allocState(), q) for q in ends))
        return search

    return make


def told_of(runs: Sequence[Found], hidden: int) -> Record:
    """One way's searches, a problem each."""
    return {
        "seconds": [one.seconds for one in runs],
        "solved": [one.path is not None for one in runs],
        "motions": [one.motions for one in runs],
        "hidden": int(hidden),
    }


def summed(records: Sequence[Record]) -> dict[str, Any]:
    """Over some families, by way: problems, share solved, median and 95th percentile of seconds (a
    search that failed took for ever: None), hidden collisions, motions."""
    out = {}
    for name in records[0]["ways"]:
        ways = [record["ways"][name] for record in records]
        solved = np.concatenate([way["solved"] for way in ways])
        seconds = np.where(solved, np.concatenate([way["seconds"] for way in ways]), np.inf)
        middle, high = np.quantile(seconds, (0.5, 0.95), method="higher")
        out[name] = {
            "problems": len(solved),
            "solved": float(solved.mean()),
            "median": float(middle) if np.isfinite(middle) else None,
            "p95": float(high) if np.isfinite(high) else None,
            "motions": float(np.median(np.concatenate([way["motions"] for way in ways]))),
            "hidden": sum(way["hidden"] for way in ways),
        }
    return out
