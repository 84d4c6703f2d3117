"""The JSON of a glTF file, with checked access."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NoReturn

import numpy as np

from fgenv.arrays import Floats

from .content import MeshSource

COMPRESSIONS = {
    "KHR_draco_mesh_compression": "Draco",
    "EXT_meshopt_compression": "meshopt",
    "KHR_meshopt_compression": "meshopt",
}
Item = Mapping[str, Any]


@dataclass
class GltfDocument:
    """A glTF document.

    Attributes:
        source: the file.
        content: the JSON object.
        binary: whether the file is a GLB.
        chunk: the binary chunk of a GLB; None if there is none.
        used: indices of the items of each kind that were read.
        skipped_extensions: names of optional extensions of the items that were read.
    """

    source: MeshSource
    content: Item
    binary: bool = False
    chunk: memoryview | None = None
    used: dict[str, set[int]] = field(default_factory=lambda: defaultdict(set))
    skipped_extensions: set[str] = field(default_factory=set)

    def items(self, kind: str) -> list[Any]:
        """All items of a kind, e.g. `meshes`."""
        return self.array(self.content, kind, "the file")

    def item(self, kind: str, index: object, place: str) -> Item:
        """An item by its index, which the place refers to."""
        items = self.items(kind)
        name = f"{kind}[{shown(index)}]"
        if isinstance(index, bool) or not isinstance(index, int) or not 0 <= index < len(items):
            self.fail(place, f"a reference to {name}", f"an index of the {len(items)} {kind}")
        if not isinstance(items[index], dict):
            self.fail(name, shown(items[index]), "an object")
        self.used[kind].add(index)
        item: Item = items[index]
        return item

    def array(self, item: Item, key: str, place: str) -> list[Any]:
        """An array of an item; empty if it is missing."""
        value = item.get(key, [])
        if not isinstance(value, list):
            self.fail(f"{place}: {key}", shown(value), "an array")
        return value

    def object(self, item: Item, key: str, place: str) -> Item:
        """An object of an item; empty if it is missing."""
        value = item.get(key, {})
        if not isinstance(value, dict):
            self.fail(f"{place}: {key}", shown(value), "an object")
        return value

    def whole(self, item: Item, key: str, place: str, default: int | None = None) -> int:
        """A whole number of an item, 0 or more."""
        value = item.get(key, default)
        if isinstance(value, float) and value.is_integer():
            value = int(value)  # 3.0 is the integer 3 in JSON
        if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 2**53:
            self.fail(f"{place}: {key}", shown(value), "a whole number, 0 or more")
        return value

    def numbers(self, item: Item, key: str, place: str, count: int | None = None) -> Floats | None:
        """Finite numbers of an item; None if they are missing."""
        if key not in item:
            return None
        values = self.array(item, key, place)
        if not all(_is_finite(x) for x in values) or count not in (None, len(values)):
            size = "" if count is None else f"{count} "
            self.fail(f"{place}: {key}", shown(values), f"{size}finite numbers")
        return np.array(values, dtype=np.float64)

    def names(self, key: str) -> list[str]:
        """A list of names of the document."""
        names = self.array(self.content, key, "the file")
        if not all(isinstance(name, str) for name in names):
            self.fail(key, shown(names), "names")
        return names

    def extensions(self, item: Item, place: str, read: tuple[str, ...] = ()) -> Item:
        """The extensions of an item; those that are not read are noted."""
        extensions = self.object(item, "extensions", place)
        self.skipped_extensions.update(
            name[:60] for name in extensions if name not in read and name not in COMPRESSIONS
        )
        return extensions

    def refuse_compression(self, extensions: Item, place: str) -> None:
        """Raise the error of compressed geometry if one of the extensions compresses."""
        for name in extensions:
            if name in COMPRESSIONS:
                method = COMPRESSIONS[name]
                self.fail(
                    place,
                    f"data compressed by {method} ({name})",
                    f"uncompressed data; export without {method} compression",
                )

    def fail(self, place: str, received: str, expected: str) -> NoReturn:
        """Raise the error of an item."""
        self.source.fail(f"{received} in {place}", expected)


def _is_finite(value: object) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:  # an integer over 1e308
        return False


def shown(value: object) -> str:
    """A value of a file for a message."""
    if isinstance(value, dict):
        return "an object"
    if isinstance(value, list) and len(value) > 16:
        return f"an array of {len(value)}"
    try:
        text = repr(value)
    except ValueError:  # an integer of over 4,300 digits
        return "a long number"
    return text if len(text) <= 60 else text[:60] + "..."
