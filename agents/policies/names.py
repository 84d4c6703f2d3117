"""Names of policies, and the check of their arguments."""

from __future__ import annotations

from fgenv.agents.weights import included
from fgenv.registry import POLICIES


def policy_names() -> list[str]:
    """Return names of policies for tab completion, with planning methods and included networks."""
    from fgenv.planners.methods import METHODS  # imports OMPL

    names = list(POLICIES)
    names += [f"{kind}:{method}" for kind in ("plan", "replan") for method in METHODS]
    return names + [f"mlp:{name}" for name in included()]


def refuse_argument(name: str, argument: str) -> None:
    """Raise ValueError if a policy without options has an argument."""
    if argument:
        raise ValueError(f"policy: got '{name}:{argument}', expected {name!r} without an argument")
