"""Loading of scenarios: from a file, or a built-in scenario by name, with overrides."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from . import registry
from .errors import Problem, ScenarioError, UnknownOverrideError, near
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
        path = Path(source)
        found = file_format_of(path)
        if isinstance(found, Document):
            return _overridden(_from_file(kind, path, found), overrides, ())
        make, parameters = partial(found.make, path), found.parameters
    else:
        entry = registry.entry(str(source))
        make, parameters = partial(entry.make), entry.parameters
    _check_names(str(source), overrides, parameters)
    try:
        scenario = make(**{k: v for k, v in overrides.items() if k in parameters})
    except ValidationError as error:
        raise ScenarioError(source, _argument_problems(error)) from None
    assert isinstance(scenario, kind)
    rest = {k: v for k, v in overrides.items() if k not in parameters}
    return _overridden(scenario, rest, parameters)


def file_format_of(path: Path) -> registry.FileFormat | Document:
    """The format of a file of another program; the document of one that holds a scenario."""
    if (found := registry.format_of_suffix(path)) is not None:
        return found
    document = read(path)
    return registry.format_of_keys(document.data) or document


def is_file_name(source: str | Path) -> bool:
    """Whether the source is a file rather than the name of a built-in scenario."""
    path = Path(source)
    suffix = path.suffix in SUFFIXES or registry.format_of_suffix(path) is not None
    named = bool(path.suffix) and path.is_file()  # e.g. record.npz: its kind is named
    return isinstance(source, Path) or suffix or named or len(path.parts) > 1


def validate(path: str | Path) -> list[Problem]:
    """List all problems of a file, sorted by line; empty for a valid file.

    Raises:
        OSError: the file cannot be read.
    """
    try:
        found = file_format_of(Path(path))
        if isinstance(found, Document):
            return _checked(ScenarioSpec, Path(path), found, all_faults)[1]
        return [fault.problem for fault in all_faults(found.make(Path(path)))]
    except ScenarioError as error:  # not YAML, or of another program
        return list(error.problems)


def _from_file(kind: type[AnyScenario], path: Path, document: Document) -> AnyScenario:
    """The scenario in a file. Schema, names and files are checked; contacts are not."""

    def check(scenario: ScenarioSpec, dropped: Collection[str]) -> list[Fault]:
        return [*reference_faults(scenario, dropped), *file_faults(scenario)]

    scenario, problems = _checked(kind, path, document, check)
    if problems or scenario is None:
        raise ScenarioError(path, problems)
    return scenario


def _checked(
    kind: type[AnyScenario], path: Path, document: Document, check: Check
) -> tuple[AnyScenario | None, list[Problem]]:
    """The scenario in a file, and the problems that the schema and `check` report, by line."""
    parsed = parse(kind, document)
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
    """Raise an UnknownOverrideError for overrides that are neither parameters nor plain fields."""
    known = dict.fromkeys((*parameters, *PLAIN_FIELDS))
    unknown = [name for name in overrides if name not in known]
    if unknown:
        problems = [Problem("is no known override", near(name, known), name) for name in unknown]
        raise UnknownOverrideError(source, problems)


def _argument_problems(error: ValidationError) -> list[Problem]:
    """The problems of arguments, which have no lines."""
    parsed: Parsed[ScenarioSpec] = Parsed(Document({}))
    return [problem_of(e, parsed) for e in error.errors(include_url=False)]
