"""Policies that are named with what they are made of, and those of other packages.

A package offers its own by an entry point of the group `fgenv.policies`, in its pyproject.toml:

    [project.entry-points."fgenv.policies"]
    mine = "my_package:make"

where `make(argument, seed)` returns a policy: for `--policy mine` the argument is "", for
`--policy mine:model.bin` it is "model.bin".
"""

from __future__ import annotations

from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

from fgenv.envs import Policy

GROUP = "fgenv.policies"
FOLDER = Path(__file__).parent / "weights"


def named(name: str, seed: int) -> Policy | None:
    """The policy that a name such as `mlp:FILE` means; None: no one knows it.

    Raises:
        ValueError: what it is made of does not fit.
        TypeError: what another package makes is no policy.
    """
    kind, _, argument = name.partition(":")
    if kind in ("mlp", "sb3"):
        if not argument:
            come = ", ".join(f"mlp:{own}" for own in shipped())
            raise ValueError(
                f"policy: got {name!r}, expected {kind}:FILE, or one that comes along: {come}"
            )
        return from_file(kind, argument)
    for point in entry_points(group=GROUP, name=kind):
        return checked(point.load()(argument, seed), name)
    return None


def from_file(kind: str, path: str) -> Policy:
    """A trained network, also one that comes along, or a model of Stable-Baselines3."""
    if kind == "mlp":
        from fgenv.agents.policies.network import Trained

        return Trained.load(shipped().get(path, path))
    from fgenv.agents.policies.sb3 import Sb3Policy

    return Sb3Policy(path)


def shipped() -> dict[str, Path]:
    """Networks that come along, by name."""
    return {path.stem: path for path in sorted(FOLDER.glob("*.npz"))}


def checked(made: Any, name: str) -> Policy:
    """TypeError where it does not act."""
    if not isinstance(made, Policy):
        kind = type(made).__name__
        raise TypeError(
            f"policy: {name!r} makes a {kind}, expected one with reset(view), act(observations)"
        )
    return made
