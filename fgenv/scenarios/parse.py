"""From values to a scenario: what pydantic finds, told with line and remedy, all at once."""

from __future__ import annotations

import copy
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from pydantic import ValidationError

from fgenv.scenarios.io.yaml_text import Document

from .errors import Problem, near, path_text
from .schema import Scenario

ROUNDS = 5  # of leaving out what is wrong, to go on with the rest
ITEMS = ("robots", "bodies", "models", "shapes", "allowed")
BLANK = {"version": 1, "name": "unnamed"}
Location = tuple[str | int, ...]


@dataclass
class Reading:
    """What could be understood of a file.

    Attributes:
        scenario: without what is wrong; None where nothing is left.
        problems: what the schema finds wrong.
        gone: names that were left out.
        kept: for robots, bodies and allowed: which places in the file are left.
    """

    document: Document
    scenario: Scenario | None = None
    problems: list[Problem] = field(default_factory=list)
    gone: set[str] = field(default_factory=set)
    kept: dict[str, list[int]] = field(default_factory=dict)

    def place(self, location: Location) -> Location:
        """Where in the file something is that has this place in `scenario`."""
        top, i = (*location, None, None)[:2]
        if isinstance(i, int) and top in self.kept:
            return (top, self.kept[str(top)][i], *location[2:])
        return location

    def located(self, location: Location, text: str, remedy: str) -> Problem:
        """A problem in `scenario`, told of the file."""
        place = self.place(location)
        return Problem(text, remedy, path_text(place), self.document.line(place))


def understood(document: Document) -> Reading:
    """The scenario, and all that the schema finds wrong: what is wrong is left out, bit by bit."""
    reading = Reading(document, problems=list(document.problems))
    data = document.data
    if not isinstance(data, dict):
        came = "nothing" if data is None else type(data).__name__
        told = Problem(f"holds {came}, expected a scenario", "begin with version: 1", line=1)
        reading.problems.append(told)
        return reading
    lists = ((top, data.get(top)) for top in ITEMS)
    reading.kept = {top: list(range(len(v))) for top, v in lists if isinstance(v, list)}
    for _ in range(ROUNDS):
        try:
            reading.scenario = Scenario.model_validate(data)
            return reading
        except ValidationError as error:
            found = error.errors(include_url=False)
        except RecursionError:
            reading.problems.append(Problem("holds itself, by an anchor", "write it out", line=1))
            return reading
        reading.problems += [problem(e, reading) for e in found]
        unknown = [e["loc"] for e in found if e["type"] == "extra_forbidden"]
        data = without_keys(data, unknown)
        data = without(data, [e["loc"] for e in found if e["loc"] not in unknown], reading)
    return reading


def problem(error: Any, reading: Reading) -> Problem:
    """What pydantic found, in our words."""
    text, remedy = said(error)
    location, data = reading.place(error["loc"]), reading.document.data
    where = path_text(places(data, location)) or path_text(location)
    return Problem(text, remedy, where, reading.document.line(location))


def places(data: Any, location: Location) -> list[str | int]:
    """The steps of a location that are in the data, and the last: others are tags of the schema."""
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


def said(error: Any) -> tuple[str, str]:
    """What is wrong, and the remedy."""
    kind, location, context = error["type"], error["loc"], error.get("ctx", {})
    about = described(location)
    if kind == "missing":
        return "is missing", f"add it: {about}" if about else "add it"
    if kind == "extra_forbidden":
        return "is no known key", near(location[-1], keys(location[:-1]))
    if kind == "union_tag_not_found":
        return "has no kind", "add kind:"
    if kind == "union_tag_invalid":
        tags = [tag.strip(" '") for tag in context["expected_tags"].split(",")]
        return f"kind {context['tag']!r} is unknown", near(context["tag"], tags)
    if kind == "literal_error":
        expected = [w.strip(" '") for w in context["expected"].replace(" or ", ",").split(",")]
        return f"is {short(error['input'])}", near(error["input"], expected)
    if kind == "value_error":
        return str(context["error"]), about
    expected = error["msg"].replace("Input should", "should")
    return f"is {short(error['input'])}, {expected[:1].lower()}{expected[1:]}", about


def short(value: Any) -> str:
    """A value that came, cut."""
    try:
        text = repr(value)
    except RecursionError:
        text = type(value).__name__
    return text if len(text) <= 60 else text[:57] + "..."


def without_keys(data: Any, locations: list[Location]) -> Any:
    """A copy of the data without some keys."""
    data = copy.deepcopy(data)
    for location in locations:
        *steps, last = places(data, location)
        around = data
        for step in steps:
            around = around[step]
        if isinstance(around, dict):
            around.pop(last, None)
    return data


def without(data: Any, locations: list[Location], reading: Reading) -> Any:
    """A copy of the data without what is wrong in it: items of lists and tables, or fields."""
    data, items = dict(data), dict[str, set[str | int]]()
    for location in locations:
        top = str(location[0]) if location else ""
        if top in ITEMS and len(location) > 1 and isinstance(data.get(top), (dict, list)):
            items.setdefault(top, set()).add(location[1])
        else:
            data.pop(top, None)
    for top, bad in items.items():
        data[top] = kept(data[top], bad, top, reading)
    for name, value in BLANK.items():
        data.setdefault(name, value)
    return data


def kept(value: Any, bad: set[str | int], top: str, reading: Reading) -> Any:
    """A list or table without some items, whose names are then gone."""
    pairs = list(value.items() if isinstance(value, dict) else enumerate(value))
    reading.gone |= {name_of(top, key, item) for key, item in pairs if key in bad}
    left = [(key, item) for key, item in pairs if key not in bad]
    if isinstance(value, dict):
        return dict(left)
    reading.kept[top] = [reading.kept[top][key] for key, _ in left]
    return [item for _, item in left]


def name_of(top: str, key: object, item: Any) -> str:
    """What others call an item by."""
    if top in ("models", "shapes"):
        return str(key)
    return str(item.get("name", "")) if isinstance(item, dict) else ""


@cache
def schema() -> dict[str, Any]:
    """The JSON Schema of `Scenario`."""
    draft = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    return {**draft, **Scenario.model_json_schema()}


def described(location: Location) -> str:
    """What the schema says of a place."""
    return str(at(location).get("description", "")).split("\n")[0]


def keys(location: Location) -> list[str]:
    """Keys that the schema knows at a place."""
    return list(resolved(at(location)).get("properties", {}))


def at(location: Location) -> dict[str, Any]:
    """The part of the JSON Schema for a location of pydantic's."""
    node = schema()
    for step in location:
        node = resolved(node)
        tags = node.get("discriminator", {}).get("mapping", {})
        if step in tags:
            node = {"$ref": tags[step]}
        elif isinstance(step, int):
            node = node.get("items") or (node.get("prefixItems") or [{}])[-1]
        else:
            more = node.get("additionalProperties")
            known = node.get("properties", {})
            node = known.get(step) or (more if isinstance(more, dict) else {})
        if not isinstance(node, dict):
            return {}
    return node


def resolved(node: dict[str, Any]) -> dict[str, Any]:
    """The node that a reference, or an option beside null, stands for."""
    while "$ref" in node or "anyOf" in node:
        if "$ref" in node:
            node = schema()["$defs"][node["$ref"].rpartition("/")[2]]
        else:
            node = next((n for n in node["anyOf"] if n.get("type") != "null"), {})
    return node
