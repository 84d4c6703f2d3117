"""The JSON Schema of scenario files, and look-ups in it for error messages."""

from __future__ import annotations

from functools import cache
from typing import Any

from .errors import Location
from .schema import ScenarioSpec


@cache
def json_schema() -> dict[str, Any]:
    """The JSON Schema of a scenario file."""
    draft = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    return {**draft, **ScenarioSpec.model_json_schema()}


def description_at(location: Location) -> str:
    """The first line of the schema's description of a location."""
    return str(_node(location).get("description", "")).split("\n")[0]


def keys_at(location: Location) -> list[str]:
    """The keys that the schema allows at a location."""
    return list(_resolved(_node(location)).get("properties", {}))


def _node(location: Location) -> dict[str, Any]:
    """The part of the schema for a location as pydantic reports it."""
    node = json_schema()
    for step in location:
        node = _resolved(node)
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


def _resolved(node: dict[str, Any]) -> dict[str, Any]:
    """Follow a reference, or the option beside null."""
    while "$ref" in node or "anyOf" in node:
        if "$ref" in node:
            node = json_schema()["$defs"][node["$ref"].rpartition("/")[2]]
        else:
            node = next((n for n in node["anyOf"] if n.get("type") != "null"), {})
    return node
