"""Built-in scenarios by name."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, ParamSpec, TypeVar

from pydantic import Field, validate_call

from .errors import Problem, ScenarioError, near
from .schema import ScenarioSpec

P = ParamSpec("P")
AnyScenario = TypeVar("AnyScenario", bound=ScenarioSpec)

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
        make: the generator; its parameters are the overrides of the scenario.
        dimension: 2 or 3.
        about: a description in one line.
        most: maximum number of robots.
        driven: whether the robots have drives; others are for planners, not for environments.
    """

    name: str
    make: Callable[..., ScenarioSpec]
    dimension: int
    about: str
    most: int = 64
    driven: bool = True

    @property
    def parameters(self) -> dict[str, Any]:
        """Overrides with their defaults."""
        known = inspect.signature(self.make).parameters.values()
        return {parameter.name: parameter.default for parameter in known}

    @property
    def facts(self) -> dict[str, Any]:
        """All attributes, for JSON."""
        plain = {"name": self.name, "dimension": self.dimension, "about": self.about}
        return {**plain, "most": self.most, "takes": self.parameters}

    @property
    def robots(self) -> str:
        """The possible numbers of robots, and the default."""
        default, limits = self.parameters.get("n"), self.most
        return "1" if default is None else f"1 to {limits} ({default})"


ENTRIES: dict[str, Entry] = {}
OWN_KEYS = {"version", "shapes", "models", "robots", "bodies"}  # of a scenario


@dataclass(frozen=True)
class FileFormat:
    """A format of files of other programs that hold scenarios.

    Attributes:
        name: for messages.
        suffixes: lower case; .yaml for formats that are recognized by their keys.
        keys: top-level keys of which a YAML file of this format has at least one.
        make: the reader; its parameters after the path are the overrides.
    """

    name: str
    suffixes: tuple[str, ...]
    keys: frozenset[str]
    make: Callable[..., ScenarioSpec]

    @property
    def parameters(self) -> dict[str, Any]:
        """Overrides with their defaults."""
        known = list(inspect.signature(self.make).parameters.values())[1:]
        return {parameter.name: parameter.default for parameter in known}


FORMATS: list[FileFormat] = []


def file_format(
    name: str, *suffixes: str, keys: Iterable[str] = ()
) -> Callable[[Callable[P, AnyScenario]], Callable[P, AnyScenario]]:
    """Register a reader of files with these suffixes, or of YAML with one of these keys."""

    def register(make: Callable[P, AnyScenario]) -> Callable[P, AnyScenario]:
        checked = validate_call(make)
        FORMATS.append(FileFormat(name, suffixes, frozenset(keys), checked))
        return checked

    return register


def format_of_suffix(path: str | Path) -> FileFormat | None:
    """The format with the suffix of a file; None for YAML and unknown suffixes."""
    suffix = Path(path).suffix.lower()
    return next((item for item in FORMATS if suffix in item.suffixes), None)


def format_of_keys(data: object) -> FileFormat | None:
    """The format of the content of a YAML file; None for a scenario or unknown content."""
    if not isinstance(data, dict) or not OWN_KEYS.isdisjoint(map(str, data)):
        return None
    return next((item for item in FORMATS if not item.keys.isdisjoint(map(str, data))), None)


def builtin(
    dimension: int, most: int = 64, driven: bool = True
) -> Callable[[Callable[P, AnyScenario]], Callable[P, AnyScenario]]:
    """Register a generator under its name, with its docstring's first line and its parameters."""

    def register(make: Callable[P, AnyScenario]) -> Callable[P, AnyScenario]:
        checked = validate_call(make)
        name, about = make.__name__.strip("_"), inspect.getdoc(make) or ""
        line = about.splitlines()[0].rstrip(".")
        ENTRIES[name] = Entry(name, checked, dimension, line, most, driven)
        return checked

    return register


def entry(name: str) -> Entry:
    """The built-in scenario with this name.

    Raises:
        ScenarioError: unknown name.
    """
    if name not in ENTRIES:
        remedy = f"{near(name, ENTRIES)} (a file ends in .yaml)"
        raise ScenarioError(name, [Problem("is no built-in scenario", remedy)])
    return ENTRIES[name]
