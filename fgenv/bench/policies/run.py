"""How policies avoid each other: those that come along and ORCA, on sets that no training saw.

Sets are those that the project has goals for. A policy that comes along is also run behind the
safety filter, which is a row of its own.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from fgenv.agents.evaluation.evaluation import Evaluation, evaluate
from fgenv.agents.weights import included
from fgenv.scenarios import frozen

Record = dict[str, Any]
GUIDED = "orca:shortest"


@dataclass(frozen=True)
class Trial:
    """A frozen set, who is trained for it, and what is expected of it.

    Attributes:
        name: of the row.
        scenario, overrides: for `frozen`.
        policy: the file that comes along for it, if there is one: `mlp:POLICY`.
        goal: share of episodes that are to succeed.
        above: by how much more than those of ORCA.
        base: what it is compared with.
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
        """Names of those that are run: the base, where walls stand also ORCA along shortest paths;
        the one that comes along, and the same filtered."""
        found = (self.base, GUIDED) if self.walls else (self.base,)
        own = (f"mlp:{self.policy}", f"safe:mlp:{self.policy}")
        return (*found, *own) if self.policy in included() else found

    @property
    def walls(self) -> bool:
        """Whether something stands in the way of planar robots."""
        return self.scenario not in ("swap", "forest")


def trials() -> Iterator[Trial]:
    """All of them, each with a holonomic and a differential drive; the latter may lose 0.05."""
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


def chosen(which: str) -> list[Trial]:
    """Those with one of these words (with commas) in their names; all of `all`, `shipped` those
    that a policy comes along for.

    Raises:
        ValueError: there is none.
    """
    every = list(trials())
    if which == "all":
        return every
    if which == "shipped":
        return [trial for trial in every if trial.policy in included()]
    words = [word.strip() for word in which.split(",")]
    found = [trial for trial in every if any(word in trial.name for word in words)]
    if not found:
        names = "; ".join(trial.name for trial in every)
        raise ValueError(f"sets: nothing has {which!r} in its name, expected a part of: {names}")
    return found


def run(trial: Trial, cases: int, jobs: int) -> list[Record]:
    """Scores of its policies, one record each."""
    several = frozen(trial.scenario, cases=cases, **trial.overrides)
    several = frozen(trial.scenario, cases=cases, **trial.overrides)
    found = evaluate(several, trial.policies, jobs=jobs, clearance=False)
    return [record(trial, name, found) for name in trial.policies]


def record(trial: Trial, name: str, found: Evaluation) -> Record:
    """What is told of one policy; `met`: whether it is as good as expected, None of the base."""
    score, base = found.scores[name], found.scores[trial.base].success.value
    above = min(1.0, base + trial.above) if trial.above else 0.0
    goal = max(trial.goal, above)
    return {
        "set": trial.name,
        "id": found.cases.id,
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
