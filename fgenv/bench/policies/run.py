"""Avoidance of the included policies and of ORCA, on frozen sets that are not used in training.

The sets are those with goals. Each included policy is also run behind the safety filter, as a row
of its own.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from fgenv.agents.evaluation.evaluation import Evaluation, evaluate
from fgenv.agents.weights import included
from fgenv.bench.common.records import Record
from fgenv.bench.common.selection import select, split_names
from fgenv.scenarios import frozen

GUIDED = "orca:shortest"


@dataclass(frozen=True)
class Trial:
    """A frozen set, the policy that is trained for it, and its goal.

    Attributes:
        name: of the row.
        scenario, overrides: for `frozen`.
        policy: name of the included policy, `mlp:POLICY`, if there is one.
        goal: expected share of successful episodes.
        above: expected margin over ORCA's share.
        base: the policy to compare with.
    """

    name: str
    scenario: str
    overrides: dict[str, Any]
    policy: str
    goal: float
    above: float = 0.0
    base: str = "orca"

    @property
    def policies(self) -> tuple[str, ...]:
        """Names of the policies: the base, ORCA along shortest paths if there are walls, and the
        included policy with and without the safety filter."""
        bases = (self.base, GUIDED) if self.walls else (self.base,)
        own = (f"mlp:{self.policy}", f"safe:mlp:{self.policy}")
        return (*bases, *own) if self.policy in included() else bases

    @property
    def walls(self) -> bool:
        """Whether the scenario has obstacles for planar robots."""
        return self.scenario not in ("swap", "forest")


def trials() -> Iterator[Trial]:
    """All trials, with holonomic and differential drives; the goal of the latter is 0.05 lower."""
    for drive, less in (("holonomic", 0.0), ("differential", 0.05)):
        for n, goal in ((4, 0.99), (8, 0.99), (12, 0.95), (20, 0.95)):
            given = {"n": n, "vary": 0.5, "drive": drive}
            name = f"swap-{drive}"
            noisy = {**given, "jitter": 0.2}
            yield Trial(f"swap {n} jittered {drive}", "swap", noisy, name, goal - less)
            if n > 4:
                yield Trial(f"swap {n} symmetric {drive}", "swap", given, name, 0.95 - less)
        for body in ("long", "l"):
            for n in (4, 8):
                given = {"n": n, "vary": 0.5, "jitter": 0.2, "body": body, "drive": drive}
                name = f"{body}-{drive}"
                yield Trial(f"{body} {n} {drive}", "swap", given, name, 0.9 - less, 0.2)
        for scenario, goals in (
            ("doorway", ((4, 0.9), (8, 0.9))),
            ("intersection", ((4, 0.9), (8, 0.9))),
            ("random", ((10, 0.95), (20, 0.9))),
        ):
            above = 0.0 if scenario == "random" else 0.2
            for n, goal in goals:
                given, name = {"n": n, "drive": drive}, f"{scenario}-{drive}"
                yield Trial(f"{scenario} {n} {drive}", scenario, given, name, goal - less, above)
    yield Trial("forest 6", "forest", {"n": 6}, "forest", 0.9, base="goto")  # ORCA does not fly


def select_trials(which: str) -> tuple[Trial, ...]:
    """Return the trials for `all`, for `shipped` (with an included policy), or for parts of names.

    Raises:
        ValueError: no trial matches.
    """
    every = tuple(trials())
    if which == "all":
        return every
    if which == "shipped":
        return tuple(trial for trial in every if trial.policy in included())
    return select(every, split_names(which), "sets")


def run(trial: Trial, cases: int, jobs: int) -> list[Record]:
    """Evaluate the policies of a trial, one record each."""
    frozen_set = frozen(trial.scenario, cases=cases, **trial.overrides)
    evaluation = evaluate(frozen_set, trial.policies, jobs=jobs, clearance=False)
    return [record(trial, name, evaluation) for name in trial.policies]


def record(trial: Trial, name: str, evaluation: Evaluation) -> Record:
    """The record of one policy; `met`: whether it reaches its goal, None for the base."""
    score, base = evaluation.scores[name], evaluation.scores[trial.base].success.value
    above = min(1.0, base + trial.above) if trial.above else 0.0
    goal = max(trial.goal, above)
    return {
        "set": trial.name,
        "id": evaluation.cases.id,
        "cases": score.episodes,
        "policy": name,
        "success": score.success,
        "robot_collision": score.robot_collision.value + score.body_collision.value,
        "time_out": score.time_out.value,
        "extra_time": score.extra_time,
        "shared": score.shared,
        "goal": goal,
        "met": None if name in (trial.base, GUIDED) else score.success.value >= goal,
    }
