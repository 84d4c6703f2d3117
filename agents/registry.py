"""Policies: what decides on actions. One protocol for all, and the built-in ones by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from fgenv.agents.named_policies import named
from fgenv.agents.policies.goto import GoTo
from fgenv.agents.policies.orca import Orca
from fgenv.agents.policies.random import RandomPolicy
from fgenv.agents.policies.rest import Rest
from fgenv.agents.policies.safety_filter import Safe
from fgenv.envs import Policy
from fgenv.scenarios.errors import near

if TYPE_CHECKING:
    from fgenv.agents.policies.plan import Planned


def _planned(seed: int, rest: str = "") -> Planned:
    from fgenv.agents.policies.plan import Planned

    if rest.endswith(".npz"):
        return Planned(plan=rest)
    return Planned(*_method(rest), seed=seed)


def _replanning(seed: int, rest: str = "") -> Planned:
    from fgenv.agents.policies.replan import Replanning

    return Replanning(*_method(rest), seed=seed)


def _orca(seed: int, rest: str = "") -> Orca:
    if rest not in ("", SHORTEST):
        raise ValueError(f"policy: 'orca:{rest}', expected orca, or orca:{SHORTEST}")
    return Orca.guided() if rest else Orca()


SHORTEST = "shortest"
POLICIES: dict[str, Callable[[int], Policy]] = {
    "goto": lambda seed: GoTo(),
    "orca": _orca,
    "random": RandomPolicy,
    "rest": lambda seed: Rest(),
    "plan": _planned,
    "replan": _replanning,
}
PLANNING: dict[str, Callable[[int, str], Policy]] = {"plan": _planned, "replan": _replanning}
SPECIAL: dict[str, Callable[[int, str], Policy]] = {**PLANNING, "orca": _orca}
FORMS = (
    "goto, orca[:shortest], random, rest, plan[:METHOD[:PLANNER]], plan:FILE.npz,"
    " replan[:METHOD[:PLANNER]], mlp:FILE.npz, sb3:FILE.zip, safe:POLICY"
)


def policy_of(name: str, seed: int = 0) -> Policy:
    """A built-in policy, one from a file, or one that another package has registered.

    Args:
        name: of `POLICIES`. `plan` and `replan` may say how to plan: `plan:prioritized`,
            `plan:composite:PRM`; or which plan file to drive: `plan:FILE.npz`. `orca:shortest`
            goes along the shortest path among what stands, see `Orca.guided`.
            `mlp:FILE`, `sb3:FILE` and those of other packages: see `fgenv.agents.named_policies`.
            `safe:NAME`: any of these behind a safety filter, see `Safe`.
        seed: of what is random in it, 0 or more.

    Raises:
        ValueError: no policy, method or planner has that name, the seed is below 0, or a file
            cannot be used.
        PlanError, FileNotFoundError: no such plan, or file.
    """
    kind, _, rest = name.partition(":")
    if seed < 0:
        raise ValueError(f"seed: got {seed}, expected 0 or more")
    if kind == "safe":
        return Safe(policy_of(rest, seed))
    if kind not in POLICIES:
        found = named(name, seed)
        if found is not None:
            return found
        raise ValueError(f"policy: {name!r} is not known; {near(kind, POLICIES)}")
    if rest and kind not in SPECIAL:
        raise ValueError(f"policy: {name!r}, {kind!r} takes nothing after it; expected {kind!r}")
    return SPECIAL[kind](seed, rest) if rest else POLICIES[kind](seed)


def names(methods: bool = True) -> list[str]:
    """Names of policies; with those of the planning ones by method."""
    found = list(POLICIES)
    if methods:
        from fgenv.planners.methods import METHODS

        found += [f"{kind}:{method}" for kind in PLANNING for method in METHODS]
    return found


def _method(rest: str) -> tuple[str | None, str]:
    """Method and planner of METHOD[:PLANNER], either may be empty."""
    from fgenv.planners import PLANNERS
    from fgenv.planners.methods import METHODS

    method, _, planner = rest.partition(":")
    if method and method not in METHODS:
        raise ValueError(f"method: {method!r} is not known; {near(method, METHODS)}")
    if planner and planner not in PLANNERS:
        raise ValueError(f"planner: {planner!r} is not known; {near(planner, PLANNERS)}")
    return method or None, planner or "RRTConnect"
