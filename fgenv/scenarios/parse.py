"""Plain values to a scenario: reports all that violates the schema, with lines and remedies."""

from __future__ import annotations

import copy
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

from pydantic import ValidationError

from .errors import Location, Problem, near, path_text, short
from .json_schema import description_at, keys_at
from .schema import ScenarioSpec
from .yaml_io import Document

ROUNDS = 5  # of dropping invalid values to validate the rest
ITEMS = ("robots", "bodies", "models", "shapes", "allowed")
BLANK = {"version": 1, "name": "unnamed"}
AnyScenario = TypeVar("AnyScenario", bound=ScenarioSpec)


@dataclass
class Parsed(Generic[AnyScenario]):
    """The valid part of a file, and its problems.

    Attributes:
        scenario: without the invalid values; None if nothing valid is left.
        problems: violations of the schema.
        dropped: names of the items that were dropped.
        kept: for robots, bodies and allowed: indices in the file of the items that are left.
    """

    document: Document
    scenario: AnyScenario | None = None
    problems: list[Problem] = field(default_factory=list)
    dropped: set[str] = field(default_factory=set)
    kept: dict[str, list[int]] = field(default_factory=dict)

    def place(self, location: Location) -> Location:
        """The location in the file for a location in `scenario`."""
        top, i = (*location, None, None)[:2]
        if isinstance(i, int) and top in self.kept:
            return (top, self.kept[str(top)][i], *location[2:])
        return location

    def located(self, location: Location, text: str, remedy: str) -> Problem:
        """A problem at a location in `scenario`, with its place and line in the file."""
        place = self.place(location)
        return Problem(text, remedy, path_text(place), self.document.line(place))


def parse(kind: type[AnyScenario], document: Document) -> Parsed[AnyScenario]:
    """Validate a document; invalid values are dropped step by step, so that all are reported."""
    parsed: Parsed[AnyScenario] = Parsed(document, problems=list(document.problems))
    data = document.data
    if not isinstance(data, dict):
        got = "nothing" if data is None else type(data).__name__
        problem = Problem(f"holds {got}, expected a scenario", "begin with version: 1", line=1)
        parsed.problems.append(problem)
        return parsed
    lists = ((top, data.get(top)) for top in ITEMS)
    parsed.kept = {top: list(range(len(v))) for top, v in lists if isinstance(v, list)}
    for _ in range(ROUNDS):
        try:
            parsed.scenario = kind.model_validate(data)
            return parsed
        except ValidationError as error:
            errors = error.errors(include_url=False)
        except RecursionError:
            parsed.problems.append(Problem("holds itself, by an anchor", "write it out", line=1))
            return parsed
        parsed.problems += [problem_of(e, parsed) for e in errors]
        unknown = [e["loc"] for e in errors if e["type"] == "extra_forbidden"]
        data = _without_keys(data, unknown)
        data = _without(data, [e["loc"] for e in errors if e["loc"] not in unknown], parsed)
    return parsed


def problem_of(error: Any, parsed: Parsed[Any]) -> Problem:
    """The problem for an error of pydantic."""
    text, remedy = _message(error)
    location, data = parsed.place(error["loc"]), parsed.document.data
    where = path_text(_steps(data, location)) or path_text(location)
    return Problem(text, remedy, where, parsed.document.line(location))


def _steps(data: Any, location: Location) -> list[str | int]:
    """The steps of a location that exist in the data, and the last; others are schema tags."""
    steps: list[str | int] = []
    for i, step in enumerate(location):
        inside = isinstance(data, dict) and step in data
        inside = inside or (isinstance(data, list) and isinstance(step, int) and step < len(data))
        if inside:
            data = data[step]
            steps.append(step)
        elif i == len(location) - 1 and isinstance(data, dict):
            steps.append(step)
    return steps


def _message(error: Any) -> tuple[str, str]:
    """Text and remedy for an error of pydantic."""
    kind, location, context = error["type"], error["loc"], error.get("ctx", {})
    about = description_at(location)
    if kind == "missing":
        return "is missing", f"add it: {about}" if about else "add it"
    if kind == "extra_forbidden":
        return "is no known key", near(location[-1], keys_at(location[:-1]))
    if kind == "union_tag_not_found":
        return "has no kind", "add kind:"
    if kind == "union_tag_invalid":
        tags = [tag.strip(" '") for tag in context["expected_tags"].split(",")]
        return f"kind {context['tag']!r} is unknown", near(context["tag"], tags)
    if kind == "literal_error":
        choices = [w.strip(" '") for w in context["expected"].replace(" or ", ",").split(",")]
        return f"is {short(error['input'])}", near(error["input"], choices)
    if kind == "value_error":
        return str(context["error"]), about
    expected = error["msg"].replace("Input should", "should")
    return f"is {short(error['input'])}, {expected[:1].lower()}{expected[1:]}", about


def _without_keys(data: Any, locations: list[Location]) -> Any:
    """A copy of the data without some keys."""
    data = copy.deepcopy(data)
    for location in locations:
        *steps, last = _steps(data, location)
        parent = data
        for step in steps:
            parent = parent[step]
        if isinstance(parent, dict):
            parent.pop(last, None)
    return data


def _without(data: Any, locations: list[Location], parsed: Parsed[Any]) -> Any:
    """A copy of the data without invalid list items, table entries and fields."""
    data, items = dict(data), dict[str, set[str | int]]()
    for location in locations:
        top = str(location[0]) if location else ""
        if top in ITEMS and len(location) > 1 and isinstance(data.get(top), (dict, list)):
            items.setdefault(top, set()).add(location[1])
        else:
            data.pop(top, None)
    for top, invalid in items.items():
        data[top] = _without_items(data[top], invalid, top, parsed)
    for name, value in BLANK.items():
        data.setdefault(name, value)
    return data


def _without_items(value: Any, invalid: set[str | int], top: str, parsed: Parsed[Any]) -> Any:
    """A list or table without the invalid items; their names are added to `dropped`."""
    pairs = list(value.items() if isinstance(value, dict) else enumerate(value))
    parsed.dropped |= {_item_name(top, key, item) for key, item in pairs if key in invalid}
    valid = [(key, item) for key, item in pairs if key not in invalid]
    if isinstance(value, dict):
        return dict(valid)
    parsed.kept[top] = [parsed.kept[top][key] for key, _ in valid]
    return [item for _, item in valid]


def _item_name(top: str, key: object, item: Any) -> str:
    """The name by which other parts of the file refer to an item."""
    if top in ("models", "shapes"):
        return str(key)
    return str(item.get("name", "")) if isinstance(item, dict) else ""
