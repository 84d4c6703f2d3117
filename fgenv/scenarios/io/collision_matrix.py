"""Allowed collision matrix of a planning scene: pairs of links and objects that may touch."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterable
from dataclasses import dataclass, field

from fgenv.scenarios.errors import near, short

from .yaml_node import Node

OCTOMAP = "<octomap>"  # the name that MoveIt gives to the octomap


@dataclass(frozen=True)
class CollisionMatrix:
    """Decisions on pairs of names.

    Attributes:
        place: of the matrix in the file, for messages.
        pairs: whether a pair, in alphabetical order, may touch.
        defaults: whether a name may touch all names that it has no decision with.
    """

    place: Node
    pairs: dict[tuple[str, str], bool] = field(default_factory=dict)
    defaults: dict[str, bool] = field(default_factory=dict)

    def __call__(self, a: str, b: str) -> bool:
        """Whether two names may touch. A default of false has precedence over one of true."""
        decision = self.pairs.get((min(a, b), max(a, b)))
        if decision is None:
            defaults = [self.defaults[name] for name in (a, b) if name in self.defaults]
            return bool(defaults) and all(defaults)
        return decision

    def allowed(self, names: Iterable[str]) -> list[tuple[str, str]]:
        """All pairs of these names that may touch."""
        return [pair for pair in itertools.combinations(names, 2) if self(*pair)]

    def check_names(self, known: Collection[str]) -> None:
        """Raise a ScenarioError for an entry that is none of the known links and objects."""
        names = {*itertools.chain.from_iterable(self.pairs), *self.defaults}
        for name in sorted(names - {*known, OCTOMAP}):
            self.place.fail(f"{short(name)} is no link or object", near(name, known))


def matrix_of(scene: Node) -> CollisionMatrix | None:
    """The matrix of a scene; None if it has no entries, which keeps the pairs of the SRDF.

    Raises:
        ScenarioError: rows or values of another number than names, or an asymmetric matrix.
    """
    place = scene.find("allowed_collision_matrix")
    if place is None:
        return None
    names = [name.text() for name in place.items("entry_names")]
    rows = [_row(row, len(names)) for row in place.items("entry_values")]
    if len(rows) != len(names):
        place.fail(f"has {len(names)} entry_names, {len(rows)} entry_values", "expected a row each")
    pairs = {}
    for i, j in itertools.combinations(range(len(names)), 2):
        if rows[i][j] != rows[j][i]:
            text = f"differs between {short(names[i])} and {short(names[j])}"
            place.fail(text, "expected a symmetric matrix")
        pairs[min(names[i], names[j]), max(names[i], names[j])] = rows[i][j]
    labels = [name.text() for name in place.items("default_entry_names")]
    values = [value.value is True for value in place.items("default_entry_values")]
    if len(labels) != len(values):
        place.fail(
            f"has {len(labels)} default_entry_names, {len(values)} default_entry_values",
            "expected one for each",
        )
    defaults = dict(zip(labels, values, strict=True))
    return CollisionMatrix(place, pairs, defaults) if pairs or defaults else None


def _row(row: Node, length: int) -> list[bool]:
    items = list(row.items("enabled") if isinstance(row.value, dict) else row.items())
    if len(items) != length:
        row.fail(f"has {len(items)} values", f"expected {length}, one for each entry_names")
    for item in items:
        if not isinstance(item.value, bool):
            item.fail(f"got {short(item.value)}", "expected true or false")
    return [item.value is True for item in items]
