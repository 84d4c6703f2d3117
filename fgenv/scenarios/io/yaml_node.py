"""A value in a YAML file of another program, with its place; errors name file, line and key."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

from fgenv.scenarios.errors import Location, Problem, ScenarioError, path_text, short
from fgenv.scenarios.yaml_core import FastLoader
from fgenv.scenarios.yaml_io import Document, parse, read

Numbers = tuple[float, ...]
MOST, LONGEST = 1e6, 80  # of numbers, and of names


@dataclass(frozen=True)
class Node:
    """A value, and its location in the file."""

    path: Path
    document: Document
    value: Any
    place: Location = ()

    @classmethod
    def read(cls, path: str | Path) -> Node:
        """The top of a file.

        Raises:
            ScenarioError: not YAML.
            OSError: as opening it does.
        """
        document = read(Path(path), FastLoader)
        return cls(Path(path), document, document.data)

    @classmethod
    def parsed(cls, text: str, path: str | Path) -> Node:
        """The top of a text; `path` is for messages."""
        document = parse(text, Path(path), FastLoader)
        return cls(Path(path), document, document.data)

    def fail(self, text: str, remedy: str) -> NoReturn:
        """Raise a ScenarioError about this place."""
        line = self.document.line(self.place)
        raise ScenarioError(self.path, [Problem(text, remedy, path_text(self.place), line)])

    def find(self, *keys: str) -> Node | None:
        """The value under nested keys; None if it is missing or null."""
        node = self
        for key in keys:
            if not isinstance(node.value, dict):
                node.fail(f"is {short(node.value)}", f"expected a table with {key}")
            if node.value.get(key) is None:
                return None
            node = Node(node.path, node.document, node.value[key], (*node.place, key))
        return node

    def get(self, *keys: str) -> Node:
        """The value under nested keys, which must exist."""
        node = self
        for key in keys:
            found = node.find(key)
            if found is None:
                node.fail(f"has no {key}", "add it")
            node = found
        return node

    def items(self, *keys: str) -> Iterator[Node]:
        """The items of the list under nested keys; none if it is missing."""
        node = self.find(*keys)
        if node is None:
            return
        if not isinstance(node.value, list):
            node.fail(f"is {short(node.value)}", "expected a list")
        for i, value in enumerate(node.value):
            yield Node(node.path, node.document, value, (*node.place, i))

    def number(self) -> float:
        """A number; NaN is an error."""
        value = self.value
        real = isinstance(value, (int, float)) and not isinstance(value, bool)
        if not real or not abs(value) <= MOST:
            self.fail(f"is {short(value)}", f"expected a number up to {MOST:g}")
        return float(value)

    def numbers(self, keys: Sequence[str]) -> Numbers:
        """One number per key: from a list, or from a table with these keys."""
        if isinstance(self.value, dict):
            return tuple(self.get(key).number() for key in keys)
        found = tuple(item.number() for item in self.items())
        if len(found) != len(keys):
            self.fail(f"has {len(found)} numbers", f"expected {len(keys)}: {', '.join(keys)}")
        return found

    def text(self) -> str:
        """A name."""
        if not isinstance(self.value, str) or not 0 < len(self.value) <= LONGEST:
            self.fail(f"is {short(self.value)}", f"expected a name of up to {LONGEST} letters")
        return str(self.value)
