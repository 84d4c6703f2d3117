"""Fuzz target: bytes as two small meshes and their poses, through every query.

    PYTHONPATH=tests python -m fuzz.queries -max_total_time=3600 CORPUS  # an hour; keeps new inputs
    PYTHONPATH=tests python -m fuzz.queries crash-1234                   # runs one input again

The meshes are open, folded, doubled, crossing, sliver-thin or sound; the poses rigid or not. A
query gives its documented result or a one-line error; results obey the laws of `laws.py`.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

from fuzz.driver import instrument, one_line, run

if __name__ == "__main__":
    instrument("fgenv.collision", "fuzz.decode", "fuzz.laws")

from fgenv.collision import FeatureGraph, Shape, collide, contact_point, distance, nearest_points
from fuzz import laws
from fuzz.decode import BAD, Reader

NAMES = (
    *("vertices", "faces", "method", "tolerance", "angle", "Ta", "Tb", "T", "margin", "threads"),
    *("points", "contains", "origins", "directions", "max_distance"),
)
METHODS: list[dict[str, Any]] = [
    {},
    {"method": "crease"},
    {"method": "crease", "angle": 1.2},
    {"method": "loop"},
    {"tolerance": 1e-3},
    {"tolerance": 0.5},
]


def ask(data: bytes) -> None:
    """The first byte chooses an exact world, a rounded one, or invalid arguments."""
    reader = Reader(data)
    kind = reader.byte() % 8
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        if kind == 7:
            ask_nonsense(reader)
        else:
            keep_laws(reader, exact=kind < 3)


def keep_laws(reader: Reader, exact: bool) -> None:
    """Two shapes, every law."""
    first, second = made(reader, exact), made(reader, exact)
    if first is None or second is None:
        return
    a, b = (first, reader.pose(exact)), (second, reader.pose(exact))
    laws.of_collide(a, b, exact)
    laws.of_contact(a, b, exact)
    laws.of_distance(a, b, exact)
    laws.of_margin(a, b, [abs(reader.number(False)) for _ in range(4)], exact)
    laws.of_many(a, b, reader.pose(False))
    points = np.reshape(reader.numbers(6, exact), (2, 3))
    for shape, pose in (a, b):
        laws.of_graph(shape)
        laws.of_reading_again(shape)
        laws.of_contains((shape, pose), points)
        laws.of_rays((shape, pose), points, shape.vertices[:2] - points + [0, 0, 1e-3], 2.0)


def made(reader: Reader, exact: bool) -> Shape | None:
    """A shape; None for a mesh without area, which raises an error."""
    chosen = reader.choice(METHODS)
    vertices, faces = reader.mesh(exact)
    try:
        return Shape(vertices, faces, **chosen)
    except ValueError as error:
        one_line(error, "area")
        return None


def ask_nonsense(reader: Reader) -> None:
    """Each call returns a result or raises a one-line error."""
    vertices, faces = reader.mesh(False)
    what = reader.byte() % 6
    if what == 0:
        vertices[reader.byte() % len(vertices), reader.byte() % 3] = reader.choice(BAD)
    elif what == 1:
        faces[reader.byte() % len(faces), reader.byte() % 3] = reader.byte() - 128
    elif what == 2:
        faces = faces[: reader.byte() % 2]
    chosen: dict[str, Any] = {
        "method": reader.choice(["exact", "crease", "loop", "tolerance", "none"]),
        "tolerance": reader.choice([None, None, None, reader.double()]),
        "angle": reader.choice([None, None, reader.double(), (reader.double(), reader.double())]),
    }
    explains(lambda: FeatureGraph(vertices, faces, **chosen))
    shape = explains(lambda: Shape(vertices, faces, **chosen))
    if shape is None:
        return
    pose, other = reader.bad_pose(), reader.choice([np.eye(4), reader.bad_pose()])
    margin = reader.choice([0.0, reader.double()])
    threads: Any = reader.choice([1, 2, None, 0, -1, 1.5])
    explains(lambda: collide(shape, pose, shape, other, margin=margin, threads=threads))
    explains(lambda: distance(shape, other, shape, pose, threads=threads))
    explains(lambda: nearest_points(shape, pose, shape, other))
    explains(lambda: contact_point(shape, pose, shape, other))
    points = [reader.double() for _ in range(3)]
    explains(lambda: shape.contains(points, pose))
    explains(lambda: shape.raycast(points, vertices, pose, margin))


def explains(call: Callable[[], Any]) -> Any:
    """Result of the call; None if it raised a one-line error about its arguments."""
    try:
        return call()
    except (ValueError, TypeError) as error:
        one_line(error, *NAMES)
        return None


def seeds() -> list[bytes]:
    """Each kind of question, with bytes that repeat nothing."""
    rng = np.random.default_rng(0)
    return [bytes([kind]) + rng.bytes(size) for kind in range(8) for size in (30, 90, 200)]


if __name__ == "__main__":
    run(ask, seeds())
