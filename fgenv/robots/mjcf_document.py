"""Checks of MJCF documents before MuJoCo reads them: files, cycles, and the size of the model.

MuJoCo expands includes, replicas and attached models, and opens every file that it finds. A small
document can thus name a device, include itself, or expand to billions of bodies.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from fgenv.collision.mesh_files.xml_tree import Element
from fgenv.regular_file import check_regular

from .documents import MAX_BYTES, fail, read_document

MAX_FILE_BYTES = 1 << 30  # of an asset
MAX_ELEMENTS = 200_000  # with replicas
MAX_ITEMS = 10_000_000  # rows times columns of a height field, and the like
MAX_DEPTH = 16  # of files
MAX_FOLDERS = 64
DEFORMABLE = ("deformable", "flex", "flexcomp")
FOLDERS = ("assetdir", "meshdir", "texturedir")
# Attributes by element; their product is the number of items that MuJoCo allocates.
COUNTS = {
    "composite": ("count",),
    "hfield": ("nrow", "ncol"),
    "mesh": ("params",),
    "texture": ("width", "height"),
}
SOLVER_SIZES = ("memory", "njmax", "nconmax", "nstack")  # replaced: they matter in a simulation


class Place(NamedTuple):
    """An element, its file after those that include or attach it, and the number of replicas."""

    element: Element
    files: tuple[Path, ...]
    copies: int


@dataclass
class DocumentCheck:
    """Check of a document, and of the documents that it includes or attaches.

    Attributes:
        path: the main file.
        elements: number of elements, with replicas.
        folders: of assets, in any of the documents.
    """

    path: Path
    elements: int = 0
    folders: dict[str, None] = field(default_factory=lambda: {"": None})
    documents: dict[Path, Element] = field(default_factory=dict)
    models: dict[str, list[str]] = field(default_factory=dict)  # files of <model>, by name

    def run(self) -> None:
        """Raise FileNotFoundError or ValueError for an unfit document."""
        root = self._document(self.path)
        if root.tag != "mujoco":
            remedy = "; give the file that includes it" if root.tag == "mujocoinclude" else ""
            raise ValueError(
                f"path: {self.path}: got <{root.tag}>, expected MJCF: <mujoco>{remedy}"
            )
        left = [Place(root, (self.path,), 1)]
        while left:
            left += self._check(left.pop())
        for file, document in self.documents.items():
            for element in document.below():
                self._check_files(element, file)

    def mesh_files(self) -> dict[str, str]:
        """Files of the meshes by name, as the documents have them."""
        meshes = (e for root in self.documents.values() for e in root.below() if e.tag == "mesh")
        files = ((mesh.get("name"), mesh.get("file")) for mesh in meshes)
        return {name or Path(file).stem: file for name, file in files if file}

    def _document(self, path: Path) -> Element:
        """The root element of a document; its models and folders are stored."""
        if path not in self.documents:
            self.documents[path] = read_document(path, "an MJCF file")
            for element in self.documents[path].below():
                self.folders.update(dict.fromkeys(map(element.get, FOLDERS)))
                if len(self.folders) > MAX_FOLDERS:
                    fail(path, element, f"got over {MAX_FOLDERS} folders of assets", "fewer")
                if element.tag == "model":
                    name = element.get("name") or Path(element.get("file")).stem
                    self.models.setdefault(name, []).append(element.get("file"))
        return self.documents[path]

    def _check(self, place: Place) -> Iterator[Place]:
        """Check an element; yield its children, and the documents that it includes or attaches."""
        element, file = place.element, place.files[-1]
        self.elements += place.copies
        if self.elements > MAX_ELEMENTS:
            fail(file, element, f"got over {MAX_ELEMENTS:,} elements with replicas", "fewer")
        self._check_attributes(element, file)
        replicas = _product(element, ("count",), file) if element.tag == "replicate" else 1
        for child in element.children:
            yield Place(child, place.files, place.copies * replicas)
        if element.tag == "include":
            yield from self._entered(place, element.get("file"))
        if element.tag == "attach":
            for name in self.models.get(element.get("model"), ()):
                yield from self._entered(place, name)

    def _entered(self, place: Place, name: str) -> Iterator[Place]:
        """The document that an element includes or attaches, if it exists."""
        for path in self._locations(name, place.files[-1]):
            _check_named(path, "an MJCF file", MAX_BYTES, place.files[-1], place.element)
            if path in place.files or len(place.files) > MAX_DEPTH:
                cycle = "got a file that includes or attaches itself"
                fail(place.files[-1], place.element, cycle, "a tree of files")
            yield Place(self._document(path), (*place.files, path), place.copies)
            return

    def _check_attributes(self, element: Element, file: Path) -> None:
        if element.tag in DEFORMABLE:
            fail(file, element, "got a deformable body", "rigid bodies; delete it")
        for key, value in element.attributes.items():
            if key != "name" and "nan" in value.lower().replace("+", "-").replace("-", " ").split():
                fail(file, element, f"{key}: got NaN", "numbers")
        if _product(element, COUNTS.get(element.tag, ()), file) > MAX_ITEMS:
            fail(file, element, f"got over {MAX_ITEMS:,} items", "fewer")
        if element.tag == "size":
            for key in set(element.attributes).difference(SOLVER_SIZES):
                if _product(element, (key,), file) > MAX_ELEMENTS:
                    fail(file, element, f"{key}: got over {MAX_ELEMENTS:,}", "fewer")

    def _check_files(self, element: Element, file: Path) -> None:
        """Check that the files an element names are regular, where they exist."""
        for key, name in element.attributes.items():
            if key.startswith("file"):
                for path in self._locations(name, file):
                    _check_named(path, "an asset", MAX_FILE_BYTES, file, element)

    def _locations(self, name: str, file: Path) -> Iterator[Path]:
        """Files that MuJoCo may open for a name in a file."""
        for base in dict.fromkeys((self.path.parent, file.parent)):
            for folder in self.folders:
                for last in dict.fromkeys((name, Path(name).name)):
                    path = Path(os.path.normpath(base / folder / last))
                    try:
                        if last and path.exists():
                            yield path
                    except (OSError, ValueError):  # too long, or a null character
                        continue


def _check_named(path: Path, expected: str, size: int, file: Path, element: Element) -> None:
    """Raise ValueError, with the element that names a path, if the path is no regular file."""
    try:
        check_regular(path, expected, size)
    except (FileNotFoundError, ValueError) as error:
        raise ValueError(f"{file}: line {element.line}: {element}: {error}") from None


def _product(element: Element, keys: tuple[str, ...], file: Path) -> int:
    """Product of the numbers over 1 in some attributes; 1 without one."""
    try:
        words = [float(word) for key in keys for word in element.get(key).split()]
        return int(math.prod(min(max(1.0, word), 1e12) for word in words))
    except ValueError:
        return fail(file, element, f"{', '.join(keys)}: got no number", "a number")
