"""Scenarios of the command line: overrides, names and loading."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    from fgenv.scenarios import Scenario


def overrides_from(
    robots: int | None, size: float | None, settings: list[str] | None
) -> dict[str, Any]:
    """Return the overrides of --n, --size and --set; values of --set are parsed as YAML."""
    from fgenv.scenarios.yaml_core import load_value

    options = (("n", robots), ("size", size))
    overrides: dict[str, Any] = {key: value for key, value in options if value is not None}
    for setting in settings or []:
        key, equals, text = setting.partition("=")
        if not equals:
            raise ValueError(f"--set: got {setting!r}, expected KEY=VALUE, such as jitter=0.1")
        try:
            overrides[key.strip()] = load_value(text)
        except ValueError as error:
            raise ValueError(f"--set {key.strip()}: {error}") from None
    return overrides


def is_file(name: str) -> bool:
    """Return whether a scenario's name is a file name."""
    from fgenv.scenarios.load import is_file_name

    return is_file_name(name)


def is_frozen_set(name: str) -> bool:
    """Return whether a scenario's name is that of a frozen set's file."""
    return Path(name).suffix == ".npz"


def check_name(context: typer.Context, name: str, frozen_sets: bool = False) -> None:
    """Raise typer.BadParameter unless a name is a scenario file or a built-in scenario.

    Files of frozen sets are accepted on request.
    """
    from fgenv.scenarios.errors import near
    from fgenv.scenarios.library import ENTRIES

    of_file = is_file(name) or (frozen_sets and is_frozen_set(name))
    if not of_file and name not in ENTRIES:
        message = f"{name!r} is no built-in scenario; {near(name, ENTRIES)} (a file ends in .yaml)"
        raise typer.BadParameter(message, ctx=context, param_hint="SCENARIO")


def load_scenario(
    context: typer.Context, name: str | None, overrides: dict[str, Any], seed: int
) -> Scenario:
    """Load a built-in scenario or a scenario file."""
    from fgenv.scenarios import Scenario

    if name is None:
        raise typer.BadParameter("expected one, or --mesh", ctx=context, param_hint="SCENARIO")
    check_name(context, name)
    if not is_file(name) or seed != 0:
        overrides = {"seed": seed, **overrides}
    return Scenario.load(name, **overrides)
