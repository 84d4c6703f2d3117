"""A COLLADA document: elements by their references, and the numbers in their text."""

from __future__ import annotations

from typing import Any, NoReturn
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from .content import MeshSource
from .text import parse
from .xml_tree import Element


class ColladaDocument:
    """A COLLADA document.

    Attributes:
        source: the file.
        root: its root element.
        polygons, nonplanar: numbers of polygons that were triangulated, as in `FileMesh`.
    """

    def __init__(self, source: MeshSource, root: Element) -> None:
        self.source = source
        self.root = root
        self.polygons = 0
        self.nonplanar = 0
        self._targets: dict[tuple[str, str], list[Element]] = {}
        for element in root.below():
            if "id" in element.attributes:
                self._targets.setdefault((element.tag, element.get("id")), []).append(element)

    def target(self, element: Element, tag: str, attribute: str = "url") -> Element:
        """The element of a tag that an attribute refers to."""
        reference = element.attributes.get(attribute)
        if reference is None:
            self.fail(element, f"{element} without {attribute}", f"a reference to a <{tag}>")
        name = reference.removeprefix("#")
        if not reference.startswith("#"):
            self.fail(element, f"a reference to {name[:60]!r}", "an element of the same file")
        found = self._targets.get((tag, name)) or self._targets.get((tag, unquote(name)), [])
        if len(found) != 1:
            count = "none" if not found else f"{len(found)}"
            self.fail(
                element,
                f"{element} that refers to <{tag}> {name[:60]!r}",
                f"one such element; the file has {count}",
            )
        return found[0]

    def numbers(
        self, element: Element, dtype: Any = np.float64, count: int | None = None
    ) -> NDArray[Any]:
        """The numbers in the text of an element."""
        values = parse(element.text.encode(), dtype)
        if values is None:
            kind = "numbers" if dtype is np.float64 else "whole numbers"
            self.fail(element, f"other text in {element}", kind)
        if count is not None and len(values) != count:
            self.fail(element, f"{len(values)} numbers in {element}", f"{count}")
        return values

    def whole(self, element: Element, attribute: str, default: int | None = None) -> int:
        """A whole number, 0 or more, of an attribute."""
        text = element.attributes.get(attribute)
        if text is None and default is not None:
            return default
        try:
            value = int(text or "", 10)
        except ValueError:
            value = -1
        if not 0 <= value < 2**31:
            received = "none" if text is None else repr(text[:20])
            self.fail(element, f"{received} as {attribute} of {element}", "a whole number")
        return value

    def fail(self, element: Element, received: str, expected: str) -> NoReturn:
        """Raise the error of an element."""
        self.source.fail(received, expected, line=element.line)
