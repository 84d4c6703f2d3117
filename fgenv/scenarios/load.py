"""Loading of scenarios: from a file, or a built-in scenario by name, with overrides."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Collection, Iterable
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from . import registry
from .errors import Problem, ScenarioError, near
from .parse import Parsed, parse, problem_of
from .schema import ScenarioSpec
from .validation import Fault, all_faults, file_faults, reference_faults
from .yaml_io import Document, read

PLAIN_FIELDS = ("seed", "time_step", "horizon", "on_collision", "at_goal", "description")
SUFFIXES = (".yaml", ".yml")
AnyScenario = TypeVar("AnyScenario", bound=ScenarioSpec)
Check = Callable[[ScenarioSpec, Collection[str]], list[Fault]]


def load(kind: type[AnyScenario], source: str | Path, overrides: dict[str, Any]) -> AnyScenario:
    """See `Scenario.load`."""
    if is_file_name(source):
        return _overridden(_from_file(kind, Path(source)), overrides, ())
    entry = registry.entry(str(source))
    parameters = inspect.signature(entry.make).parameters
    _check_names(entry.name, overrides, parameters)
    try:
        scenario = entry.make(**{k: v for k, v in overrides.items() if k in parameters})
    except ValidationError as error:
        raise ScenarioError(entry.name, _argument_problems(error)) from None
    assert isinstance(scenario, kind)
    rest = {k: v for k, v in overrides.items() if k not in parameters}
    return _overridden(scenario, rest, parameters)


def is_file_name(source: str | Path) -> bool:
    """Whether the source is a file rather than the name of a built-in scenario."""
    path = Path(source)
    return isinstance(source, Path) or path.suffix in SUFFIXES or len(path.parts) > 1


def validate(path: str | Path) -> list[Problem]:
    """List all problems of a file, sorted by line; empty for a valid file.

    Raises:
        OSError: the file cannot be read.
    """
    try:
        return _checked(ScenarioSpec, Path(path), all_faults)[1]
    except ScenarioError as error:  # not YAML
        return list(error.problems)


def _from_file(kind: type[AnyScenario], path: Path) -> AnyScenario:
    """The scenario in a file. Schema, names and files are checked; contacts are not."""

    def check(scenario: ScenarioSpec, dropped: Collection[str]) -> list[Fault]:
        return [*reference_faults(scenario, dropped), *file_faults(scenario)]

    scenario, problems = _checked(kind, path, check)
    if problems or scenario is None:
        raise ScenarioError(path, problems)
    return scenario


def _checked(
    kind: type[AnyScenario], path: Path, check: Check
) -> tuple[AnyScenario | None, list[Problem]]:
    """The scenario in a file, and the problems that the schema and `check` report, by line."""
    parsed = parse(kind, read(path))
    problems = list(parsed.problems)
    if parsed.scenario is not None:
        parsed.scenario = parsed.scenario.at(path.parent)
        problems += [parsed.located(*fault) for fault in check(parsed.scenario, parsed.dropped)]
    return parsed.scenario, sorted(problems, key=lambda p: p.line or 0)


def _overridden(
    scenario: AnyScenario, fields: dict[str, Any], parameters: Iterable[str]
) -> AnyScenario:
    """The scenario with other values of plain fields."""
    _check_names(scenario.name, fields, parameters)
    try:
        return scenario.replace(**fields) if fields else scenario
    except ValidationError as error:
        raise ScenarioError(scenario.name, _argument_problems(error)) from None


def _check_names(source: str, overrides: Iterable[str], parameters: Iterable[str]) -> None:
    """Raise a ScenarioError for overrides that are neither parameters nor plain fields."""
    known = dict.fromkeys((*parameters, *PLAIN_FIELDS))
    unknown = [name for name in overrides if name not in known]
    if unknown:
        problems = [Problem("is no known override", near(name, known), name) for name in unknown]
        raise ScenarioError(source, problems)


def _argument_problems(error: ValidationError) -> list[Problem]:
    """The problems of arguments, which have no lines."""
    parsed: Parsed[ScenarioSpec] = Parsed(Document({}))
    return [problem_of(e, parsed) for e in error.errors(include_url=False)]
