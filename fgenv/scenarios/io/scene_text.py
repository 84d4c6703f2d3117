"""Text files of planning scenes (.scene), as MoveIt and RViz save them, in both versions.

The name, then for each object `* ID`, its pose (newer files), the number of its shapes, each with
its sizes, pose and color, and the number of its subframes with their poses (newer files); a last
line with a dot.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fgenv.arrays import Floats
from fgenv.scenarios.errors import Location, Problem, ScenarioError, cut, near
from fgenv.scenarios.shapes.bodies import AnyForm
from fgenv.scenarios.yaml_io import Document

from .collision_objects import CollisionObject, Parts
from .grids import read_lines
from .planning_scene import PlanningScene
from .ros import rotation_of
from .solids import BOX, CONE, CYLINDER, SPHERE, formed, plane_of, solid
from .yaml_node import Node

SIZES = {SPHERE: 1, BOX: 3, CYLINDER: 2, CONE: 2, "plane": 4}  # numbers of each kind
MAX_COUNT = 10_000_000  # shapes, vertices, triangles


@dataclass(frozen=True)
class TextLine(Document):
    """A line of a text file in place of a YAML document."""

    number: int = 1

    def line(self, location: Location | object) -> int | None:
        return self.number


class Tokens:
    """The words of a file with their lines, read from the start to the end."""

    def __init__(self, path: Path, lines: list[str]) -> None:
        self.path, self.lines = path, lines
        self.row, self.words = 0, list[str]()

    @property
    def place(self) -> Node:
        """The current line, for messages."""
        return Node(self.path, TextLine(None, number=max(self.row, 1)), None)

    def rest(self) -> str:
        """The rest of the line."""
        text, self.words = " ".join(self.words), []
        return text

    def word(self) -> str:
        """The next word."""
        while not self.words:
            if self.row >= len(self.lines):
                text = "ends within an object"
                raise ScenarioError(self.path, [Problem(text, "expected a last line with a dot")])
            self.words = self.lines[self.row].split()
            self.row += 1
        return self.words.pop(0)

    def number(self) -> float:
        """The next word as a number."""
        word = self.word()
        try:
            return Node(self.path, self.place.document, float(word)).number()
        except ValueError as error:
            if isinstance(error, ScenarioError):
                raise
            self.place.fail(f"got {cut(word, 40)!r}", "expected a number")

    def numbers(self, count: int) -> tuple[float, ...]:
        """The next numbers."""
        return tuple(self.number() for _ in range(count))

    def count(self) -> int:
        """The next word as a count."""
        word = self.word()
        if not (word.isascii() and word.isdigit() and len(word) < 9 and int(word) <= MAX_COUNT):
            self.place.fail(f"got {cut(word, 40)!r}", f"expected a count up to {MAX_COUNT}")
        return int(word)

    def pose(self) -> Floats:
        """The next pose: x, y, z, then a quaternion x, y, z, w, (4, 4)."""
        pose = np.eye(4)
        pose[:3, 3] = self.numbers(3)
        pose[:3, :3] = rotation_of(self.place, self.numbers(4))
        return pose


def read_scene_text(path: Path) -> PlanningScene:
    """The scene in a file.

    Raises:
        ScenarioError: the problem with its line.
        FileNotFoundError: no such file.
    """
    lines = read_lines(path)
    tokens = Tokens(path, lines)
    tokens.row = 1  # the name
    starts = [i for i, line in enumerate(lines) if i and line.startswith("*")]
    newer = bool(starts) and len(lines) > starts[0] + 1 and " " in lines[starts[0] + 1].strip()
    objects: dict[str, CollisionObject] = {}
    while (marker := tokens.word()) != ".":
        if marker != "*":
            tokens.place.fail(f"got {cut(marker, 40)!r}", "expected * and an id, or a last dot")
        place = tokens.place
        name = tokens.rest()
        if not name or name in objects:
            place.fail(f"{cut(name, 60)!r} names two objects or none", "rename one")
        pose = tokens.pose() if newer else np.eye(4)
        parts = [part for _ in range(tokens.count()) for part in _part(tokens)]
        frames = {tokens.word(): tokens.pose() for _ in range(tokens.count())} if newer else {}
        if parts:
            objects[name] = CollisionObject(pose, parts, frames, place)
    if tokens.words or any(line.strip() for line in lines[tokens.row :]):
        tokens.place.fail("goes on after the last dot", "expected the end of the file")
    return PlanningScene((lines[0].strip() or path.stem)[:100], objects)


def _part(tokens: Tokens) -> Parts:
    """The next shape with its pose; the color has no effect."""
    kind, inside = tokens.word(), np.eye(4)
    place = tokens.place
    form: AnyForm
    if kind == "mesh":
        count, triangles = tokens.count(), tokens.count()
        vertices = tuple(tokens.numbers(3) for _ in range(count))
        faces = tuple(tuple(tokens.count() for _ in range(3)) for _ in range(triangles))
        if any(not k < count for face in faces for k in face):
            place.fail("has a triangle of a vertex that does not exist", f"expected up to {count}")
        form = formed(place, kind="triangles", vertices=vertices, faces=faces)
    elif kind in SIZES:
        sizes = tokens.numbers(SIZES[kind])
        if kind == "plane":
            form, inside = plane_of(place, sizes)
        else:  # cylinders and cones have the radius first
            form = solid(place, kind, sizes if kind in (BOX, SPHERE) else sizes[::-1])
    else:
        place.fail(f"has a shape of kind {cut(kind, 40)!r}", near(kind, [*SIZES, "mesh"]))
    pose = tokens.pose()
    tokens.numbers(4)
    return [(form, pose @ inside)]
