"""Pairs of real meshes for the tests, chosen by seed from packages that pip installs."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from fgenv.bench.common.meshes import Mesh, folder
from fgenv.bench.pairs.catalog import Source

# pybullet carries meshes as well, but has no wheel for newer Pythons.
PACKAGES = ("example-robot-data", "gymnasium-robotics", "rtb-data")
CLASSES = (100, 300, 1000, 3000, 10_000, 30_000)  # bounds of the classes of size, triangles


@dataclass(frozen=True)
class MeshPair:
    """Two meshes of similar size; the unit of `b` is scaled by a power of ten if necessary."""

    a: Source
    b: Source

    @property
    def name(self) -> str:
        """Label for the name of a test."""
        return f"{Path(self.a.path).stem}-{Path(self.b.path).stem}"

    def load(self) -> tuple[Mesh, Mesh]:
        """Both meshes, with sizes within a factor of about three."""
        a, b = self.a.load(), self.b.load()
        unit = 10.0 ** round(np.log10(a.size / b.size))
        return a, Mesh(b.name, b.vertices * unit, b.faces)


def triangles(path: Path) -> int:
    """Number of triangles in an STL file from its header; 0 for a text STL."""
    with path.open("rb") as file:
        head = file.read(84)
    count = int(struct.unpack("<I", head[80:84])[0]) if len(head) == 84 else 0
    return count if path.stat().st_size == 84 + 50 * count else 0


@cache
def sources() -> tuple[tuple[Source, ...], ...]:
    """Every STL file of the packages by class of size, in a fixed order."""
    classes: list[list[Source]] = [[] for _ in CLASSES[1:]]
    for package in PACKAGES:
        root = folder(package)
        found = (path for path in root.rglob("*") if path.suffix.lower() == ".stl")
        for path in sorted(found, key=str):
            place = int(np.searchsorted(CLASSES, triangles(path), side="right")) - 1
            if 0 <= place < len(classes):
                classes[place].append(Source(package, str(path.relative_to(root))))
    return tuple(map(tuple, classes))


def pairs(count: int, largest: int = CLASSES[-1], seed: int = 0) -> list[MeshPair]:
    """`count` different pairs with at most `largest` triangles per mesh, classes equally likely."""
    rng = np.random.default_rng(seed)
    allowed = [some for some, top in zip(sources(), CLASSES[1:], strict=True) if top <= largest]
    chosen: dict[MeshPair, None] = {}
    while len(chosen) < count:
        a, b = (
            allowed[i][rng.integers(len(allowed[i]))] for i in rng.integers(len(allowed), size=2)
        )
        if a != b:
            chosen[MeshPair(a, b)] = None
    return list(chosen)
