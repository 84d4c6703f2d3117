"""`Scenario.load`: a file, or a built-in scenario by its name; and overrides."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Collection, Iterable
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from fgenv.scenarios.io.yaml_text import Document, read

from . import library
from .errors import Problem, ScenarioError, near
from .parse import Reading, problem, understood
from .schema import Scenario
from .validation import Found, everything, files, references

PLAIN = ("seed", "time_step", "horizon", "on_collision", "at_goal", "description")


def load(source: str | Path, overrides: dict[str, Any]) -> Scenario:
    """See `Scenario.load`."""
    path = Path(source)
    if is_file_name(source):
        return overridden(from_file(path), overrides, ())
    entry = library.entry(str(source))
    own = inspect.signature(entry.make).parameters
    unknown = [name for name in overrides if name not in own and name not in PLAIN]
    if unknown:
        told = [
            Problem("is no known override", near(n, dict.fromkeys((*own, *PLAIN))), n)
            for n in unknown
        ]
        raise ScenarioError(entry.name, told)
    try:
        scenario = entry.make(**{k: v for k, v in overrides.items() if k in own})
    except ValidationError as error:
        raise ScenarioError(entry.name, told_by(error)) from None
    return overridden(scenario, {k: v for k, v in overrides.items() if k not in own}, own)


def is_file_name(source: str | Path) -> bool:
    """Whether it names a file rather than a built-in scenario."""
    path = Path(source)
    return isinstance(source, Path) or path.suffix in Scenario.suffixes or len(path.parts) > 1


def from_file(path: Path) -> Scenario:
    """The scenario in a file: schema, names and files are checked, places are not."""
    scenario, problems = checked(path, lambda s, gone: [*references(s, gone), *files(s)])
    if problems or scenario is None:
        raise ScenarioError(path, problems)
    return scenario


def validate(path: str | Path) -> list[Problem]:
    """All that is wrong with a file, by line; empty for a sound one.

    Raises:
        OSError: it cannot be read.
    """
    try:
        return checked(Path(path), everything)[1]
    except ScenarioError as error:  # not YAML
        return list(error.problems)


def checked(
    path: Path, check: Callable[[Scenario, Collection[str]], list[Found]]
) -> tuple[Scenario | None, list[Problem]]:
    """What is in a file, and what the schema and `check` find wrong with it, by line."""
    reading = understood(read(path))
    found: list[Found] = []
    if reading.scenario is not None:
        reading.scenario = reading.scenario.at(path.parent)
        found = check(reading.scenario, reading.gone)
    problems = [*reading.problems, *(reading.located(*f) for f in found)]
    return reading.scenario, sorted(problems, key=lambda p: p.line or 0)


def overridden(scenario: Scenario, fields: dict[str, Any], own: Iterable[str]) -> Scenario:
    """The scenario with other plain fields."""
    unknown = [name for name in fields if name not in PLAIN]
    if unknown:
        told = [
            Problem("is no known override", near(n, dict.fromkeys((*own, *PLAIN))), n)
            for n in unknown
        ]
        raise ScenarioError(scenario.name, told)
    try:
        return scenario.replace(**fields) if fields else scenario
    except ValidationError as error:
        raise ScenarioError(scenario.name, told_by(error)) from None


def told_by(error: ValidationError) -> list[Problem]:
    """What is wrong with arguments."""
    return [problem(e, Reading(Document({}))) for e in error.errors(include_url=False)]
