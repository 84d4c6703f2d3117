"""Built-in scenarios by name."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, validate_call

from fgenv.scenarios.errors import Problem, ScenarioError, near
from fgenv.scenarios.schema import Scenario

FOLDER = Path(__file__).parent

N = Annotated[int, Field(ge=1, le=64, strict=True)]  # robots
Seed = Annotated[int, Field(ge=0, lt=2**63, strict=True)]
Size = Annotated[float, Field(gt=0, le=1000, strict=True, allow_inf_nan=False)] | None  # meters
Drive = Literal["differential", "holonomic"]
Meters = Annotated[float, Field(gt=0, le=1000, strict=True, allow_inf_nan=False)]


@dataclass(frozen=True)
class Entry:
    """A built-in scenario.

    Attributes:
        name: for `Scenario.load`.
        make: makes it; its parameters are the overrides that it takes.
        dimension: 2 or 3.
        about: in one line.
        most: robots.
    """

    name: str
    make: Callable[..., Scenario]
    dimension: int
    about: str
    most: int = 64

    @property
    def parameters(self) -> dict[str, Any]:
        """Overrides with their defaults."""
        known = inspect.signature(self.make).parameters.values()
        return {parameter.name: parameter.default for parameter in known}

    @property
    def facts(self) -> dict[str, Any]:
        """All of that, for JSON."""
        plain = {"name": self.name, "dimension": self.dimension, "about": self.about}
        return {**plain, "most": self.most, "takes": self.parameters}

    @property
    def robots(self) -> str:
        """How many it takes, and has if not told."""
        default, limits = self.parameters.get("n"), self.most
        return "1" if default is None else f"1 to {limits} ({default})"


ENTRIES: dict[str, Entry] = {}


def builtin(
    dimension: int, most: int = 64
) -> Callable[[Callable[..., Scenario]], Callable[..., Scenario]]:
    """Register a generator by its name, its docstring's first line, and its checked parameters."""

    def register(make: Callable[..., Scenario]) -> Callable[..., Scenario]:
        checked = validate_call(make)
        name, about = make.__name__.strip("_"), inspect.getdoc(make) or ""
        ENTRIES[name] = Entry(name, checked, dimension, about.splitlines()[0].rstrip("."), most)
        return checked

    return register


def entry(name: str) -> Entry:
    """The built-in scenario of that name.

    Raises:
        ScenarioError: there is none.
    """
    if name not in ENTRIES:
        remedy = f"{near(name, ENTRIES)} (a file ends in .yaml)"
        raise ScenarioError(name, [Problem("is no built-in scenario", remedy)])
    return ENTRIES[name]


@builtin(dimension=2)
def three_tanks() -> Scenario:
    """The published experiment: a mobile robot with a fork, a tank in its way, two beside it."""
    from fgenv.scenarios.load import from_file

    return from_file(FOLDER / "three_tanks.yaml")
