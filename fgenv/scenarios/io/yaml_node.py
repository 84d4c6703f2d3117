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
            ScenarioError: not YAML, or repeated keys.
            OSError: as opening it does.
        """
        return cls.of(read(Path(path), FastLoader), Path(path))

    @classmethod
    def parsed(cls, text: str, path: str | Path) -> Node:
        """The top of a text; `path` is for messages."""
        return cls.of(parse(text, Path(path), FastLoader), Path(path))

    @classmethod
    def of(cls, document: Document, path: Path) -> Node:
        """The top of a document."""
        if document.problems:
            raise ScenarioError(path, document.problems)
        return cls(path, document, document.data)

    def child(self, step: str | int, value: Any) -> Node:
        """The value under a key or index."""
        return Node(self.path, self.document, value, (*self.place, step))

    def problem(self, text: str, remedy: str) -> Problem:
        """A problem of this place."""
        return Problem(text, remedy, path_text(self.place), self.document.line(self.place))

    def fail(self, text: str, remedy: str) -> NoReturn:
        """Raise a ScenarioError about this place."""
        raise ScenarioError(self.path, [self.problem(text, remedy)])

    def find(self, *keys: str) -> Node | None:
        """The value under nested keys; None if it is missing or null."""
        node = self
        for key in keys:
            if not isinstance(node.value, dict):
                node.fail(f"is {short(node.value)}", f"expected a table with {key}")
            if node.value.get(key) is None:
                return None
            node = node.child(key, node.value[key])
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
            yield node.child(i, value)

    def number(self) -> float:
        """A number; NaN is an error."""
        value = self.value
        real = isinstance(value, (int, float)) and not isinstance(value, bool)
        if not real or not abs(value) <= MOST:
            self.fail(f"is {short(value)}", f"expected a number up to {MOST:g}")
        return float(value)

    def numbers(self, keys: Sequence[str]) -> Numbers:
        """One number per key: from a list, or from a table with these keys; missing ones are 0."""
        if isinstance(self.value, dict):
            found = [self.find(key) for key in keys]
            return tuple(0.0 if node is None else node.number() for node in found)
        listed = tuple(item.number() for item in self.items())
        if len(listed) != len(keys):
            self.fail(f"has {len(listed)} numbers", f"expected {len(keys)}: {', '.join(keys)}")
        return listed

    def text(self) -> str:
        """A name."""
        if not isinstance(self.value, str) or not 0 < len(self.value) <= LONGEST:
            self.fail(f"is {short(self.value)}", f"expected a name of up to {LONGEST} letters")
        return str(self.value)

    def nonzero(self) -> bool:
        """Whether the value holds anything but zeros, empty text, false and null."""
        values = [self.value]
        while values:
            value = values.pop()
            if isinstance(value, (dict, list)):
                values += value.values() if isinstance(value, dict) else value
            elif value:
                return True
        return False
