"""Policies: the protocol, and policies by name.

`register_policy` adds a policy of this process. Another package registers its policies by an entry
point of the group `fgenv.policies` in its pyproject.toml:

    [project.entry-points."fgenv.policies"]
    mine = "my_package:make"

where `make(argument, seed)` returns a policy: the argument is "" for `--policy mine` and
"model.bin" for `--policy mine:model.bin`.
"""

from __future__ import annotations

import importlib.util
import inspect
from collections.abc import Callable
from importlib.metadata import entry_points
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np

from fgenv.arrays import Floats, Floats32
from fgenv.registry import POLICIES, load
from fgenv.scenarios.errors import near
from fgenv.trust import trusting

if TYPE_CHECKING:
    from .simulator import Simulator
    from .simulator_view import View

GROUP = "fgenv.policies"


@runtime_checkable
class Policy(Protocol):
    """Decides on the actions of all robots in all worlds at once."""

    def reset(self, view: View) -> None:
        """Begin new episodes; the view stays valid and follows the simulator."""

    def act(self, observations: Floats32) -> Any:
        """Return actions (worlds, robots, action_size) in [-1, 1]; the simulator clips them.

        Args:
            observations: (worlds, robots, size) float32; `view.layouts` lists their parts.
        """


PolicyFactory = Callable[[str, int], Policy]  # of (argument, seed)


class FunctionPolicy:
    """A function of observations as a policy."""

    def __init__(self, function: Callable[[Floats32], Any]) -> None:
        self._function = function

    def reset(self, view: View) -> None:
        """See `Policy`."""

    def act(self, observations: Floats32) -> Any:
        """See `Policy`."""
        return self._function(observations)


def register_policy(name: str, factory: PolicyFactory | str) -> None:
    """Register a policy, or replace the one of that name.

    Args:
        name: without a colon.
        factory: called with (argument, seed), where the argument is the text after the colon of
            `name:argument`, or ""; or a string "module:attribute", imported on first use.
    """
    POLICIES[name] = factory


def policy_of(
    policy: str | Policy | Callable[[Floats32], Any], seed: int = 0, *, trust: bool = False
) -> Policy:
    """Return a policy by name, or make one of a function of observations.

    Args:
        policy: `goto`, `random`, `rest`; `orca`, `orca:shortest` (along the shortest path between
            static bodies); `plan`, `plan:METHOD`, `plan:METHOD:PLANNER` (plan each episode),
            `plan:FILE.npz` (drive a plan); `replan` with the same methods; `mlp:FILE`, `sb3:FILE`;
            `safe:POLICY` (any of these behind a safety filter); `FILE.py:NAME`, a policy of a
            Python file: a class (its argument `seed`, if it has one, is the seed), an object, or a
            function of observations; or a registered name. A policy is returned as it is.
        seed: of random numbers in the policy, 0 or more.
        trust: load the pickles of `sb3:FILE` also if this machine did not write them.

    Raises:
        TrustError: `sb3:FILE` was not written on this machine.
        ValueError: unknown policy, method or planner, seed below 0, or invalid file.
        TypeError: not a policy.
        PlanError, FileNotFoundError: invalid or missing file.
    """
    if isinstance(policy, str):
        with trusting(trust):
            return _make(policy, seed)
    if isinstance(policy, Policy):
        return policy
    if callable(policy):
        return FunctionPolicy(policy)
    raise TypeError(
        f"policy: got {type(policy).__name__}, expected a name ('rest', 'goto', ...), a policy with"
        " reset(view) and act(observations), or a function of observations"
    )


def _make(name: str, seed: int) -> Policy:
    if seed < 0:
        raise ValueError(f"seed: got {seed}, expected 0 or more")
    kind, _, argument = name.partition(":")
    file, _, attribute = name.rpartition(":")
    if file.endswith(".py"):
        return policy_of(_policy_of_file(Path(file), attribute, seed), seed)
    policy = _factory(kind)(argument, seed)
    if not isinstance(policy, Policy):
        raise TypeError(
            f"policy: {name!r} makes a {type(policy).__name__}, expected one with reset(view),"
            " act(observations)"
        )
    return policy


def _policy_of_file(path: Path, name: str, seed: int) -> Any:
    """Return a policy that a Python file defines: an object, or a class without arguments."""
    if not path.is_file():
        raise FileNotFoundError(f"policy: {path} does not exist, expected a Python file")
    spec = importlib.util.spec_from_file_location(path.stem, path)
    if spec is None or spec.loader is None:
        raise ValueError(f"policy: {path} is not importable, expected a Python file")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    if not hasattr(module, name):
        names = [n for n, value in vars(module).items() if callable(value) and n[:1] != "_"]
        raise ValueError(f"policy: {path} has no {name!r}; {near(name, names)}")
    found = getattr(module, name)
    if not isinstance(found, type):
        return found
    return found(seed=seed) if "seed" in inspect.signature(found).parameters else found()


def _factory(name: str) -> PolicyFactory:
    if name in POLICIES:
        factory: PolicyFactory = load(POLICIES[name])
        return factory
    for point in entry_points(group=GROUP, name=name):
        loaded: PolicyFactory = point.load()
        return loaded
    raise ValueError(f"policy: got {name!r}, which is unknown; {near(name, POLICIES)}")


def checked_actions(policy: Policy, simulator: Simulator, observations: Floats32) -> Floats:
    """Return a copy of a policy's actions, (worlds, robots, action_size).

    Raises:
        ValueError: wrong shape, or a number that is not finite.
    """
    actions = np.array(policy.act(observations), dtype=np.float64)
    expected = (simulator.n_worlds, simulator.n_robots, simulator.action_size)
    if actions.shape != expected:
        raise ValueError(f"policy: got actions of shape {actions.shape}, expected {expected}")
    if not np.isfinite(actions).all():
        raise ValueError("policy: got an action that is not finite, expected finite numbers")
    return actions
