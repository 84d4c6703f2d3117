"""Bytes to meshes, poses and numbers: every input decodes to something, short ones to zeros."""

from __future__ import annotations

import itertools
import struct
from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Floats
from fgenv.bench.common.solids import angle_iron, ball, box, together

Mesh = tuple[Floats, NDArray[np.int64]]
T = TypeVar("T")

TETRAHEDRON = (2.0 * np.eye(4, 3, -1), np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]))
SOLIDS: list[Mesh] = [
    box(2.0),
    box(0.5),
    box(1.0, 2.0, 3.0),
    TETRAHEDRON,
    angle_iron(2.0, 0.5, 2.0),
    ball(1.0, 0),
    together(box(4.0), (box(2.0)[0], box(2.0)[1][:, ::-1])),
]
# Meters. Squares and products of larger numbers overflow: see test_edge_cases.py.
LEAST, MOST = 1e-60, 1e9
ODD = [0.0, -0.0, LEAST, 1e-30, 1e-9, 1.0 + 2**-52, 1e6, 1e8, MOST, -MOST]
BAD = [np.nan, np.inf, -np.inf, 1e300, 2e15]


def cube_rotations() -> list[Floats]:
    """The 24 rotations of a cube: integers, hence without rounding."""
    found = []
    for order in itertools.permutations(range(3)):
        for signs in itertools.product((1.0, -1.0), repeat=3):
            matrix = np.zeros((3, 3))
            matrix[range(3), order] = signs
            if np.linalg.det(matrix) > 0:
                found.append(matrix)
    return found


ROTATIONS = cube_rotations()


class Reader:
    """Reads values from the front of the bytes."""

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.at = 0

    def byte(self) -> int:
        self.at += 1
        return self.data[self.at - 1] if self.at <= len(self.data) else 0

    def choice(self, options: Sequence[T]) -> T:
        return options[self.byte() % len(options)]

    def double(self) -> float:
        return float(struct.unpack("<d", bytes(self.byte() for _ in range(8)))[0])

    def whole(self) -> float:
        """-4 to 4, in halves."""
        return (self.byte() % 17 - 8) / 2

    def number(self, exact: bool) -> float:
        """A coordinate; if `exact`, one with sums and products without rounding."""
        if exact:
            return self.whole()
        kind = self.byte() % 8
        if kind < 3:
            return self.whole()
        if kind < 6:
            return (self.byte() * 256 + self.byte() - 32768) / 10007
        if kind == 6:
            return self.choice(ODD)
        value = self.double()
        return value if LEAST <= abs(value) <= MOST else 1.0

    def numbers(self, count: int, exact: bool) -> list[float]:
        return [self.number(exact) for _ in range(count)]

    def mesh(self, exact: bool) -> Mesh:
        """Up to a dozen faces of any form, or a solid with a few changes."""
        if self.byte() % 2:
            n = 3 + self.byte() % 6
            vertices = np.reshape(self.numbers(3 * n, exact), (n, 3))
            count = 3 * (1 + self.byte() % 12)
            return vertices, np.reshape([self.byte() % n for _ in range(count)], (-1, 3))
        solid = self.choice(SOLIDS)
        vertices, faces = solid[0].copy(), solid[1].copy()
        for _ in range(self.byte() % 4):
            vertices, faces = self._changed(vertices, faces, exact)
        return vertices, faces

    def _changed(self, vertices: Floats, faces: NDArray[np.int64], exact: bool) -> Mesh:
        what, face, vertex = self.byte() % 8, self.byte() % len(faces), self.byte() % len(vertices)
        if what == 0 and len(faces) > 1:  # opened
            faces = np.delete(faces, face, axis=0)
        elif what == 1:  # wound the other way
            faces[face] = faces[face, ::-1]
        elif what == 2:  # twice
            faces = np.vstack([faces, faces[face]])
        elif what == 3:  # a vertex moved
            vertices[vertex] = self.numbers(3, exact)
        elif what == 4:  # a vertex on another: slivers, folds, faces without area
            vertices[vertex] = vertices[self.byte() % len(vertices)]
        elif what == 5:  # on a side, within rounding: slivers, T-junctions
            ends = vertices[faces[face, :2]]
            vertices[vertex] = ends[0] + (0.5 if exact else self.byte() / 255) * (ends[1] - ends[0])
        elif what == 6:  # a fin: an edge with three faces
            faces = np.vstack([faces, [*faces[face, :2], vertex]])
        elif exact:  # turned inside out
            faces = faces[:, ::-1].copy()
        else:  # tiny or huge
            vertices = np.clip(vertices * 10.0 ** (self.byte() % 9 - 5), -MOST, MOST)
        return vertices, faces

    def pose(self, exact: bool) -> Floats:
        pose = np.eye(4)
        kind = self.byte() % 4
        if kind == 1:
            pose[:3, :3] = self.choice(ROTATIONS)
        elif kind > 1 and not exact:
            w, x, y, z = (self.byte() - 127.5 for _ in range(4))
            q = np.array([[w, x, y, z]])
            pose[:3, :3] = _rotation(*(q / np.linalg.norm(q))[0])
        if kind:
            pose[:3, 3] = np.clip(self.numbers(3, exact), -MOST, MOST)
        return pose

    def bad_pose(self) -> Any:
        """A matrix that is not a rigid motion, or an array of another shape."""
        pose: Any = self.pose(False)
        kind = self.byte() % 7
        if kind == 0:
            pose[self.byte() % 4, self.byte() % 4] = self.choice(BAD[:4])
        elif kind == 1:
            pose[:3, :3] *= 1 + self.byte() / 16
        elif kind == 2:
            pose[self.byte() % 4, self.byte() % 4] += 1 + self.byte()
        elif kind == 3:
            pose = np.reshape([self.double() for _ in range(16)], (4, 4))
        elif kind == 4:
            pose = pose[: self.byte() % 4, : self.byte() % 5]
        elif kind == 5:
            pose = np.tile(pose, (self.byte() % 3, self.byte() % 4, 1, 1))
        else:
            pose = self.choice([None, "here", 1j * pose, pose > 0, pose.tolist(), [pose, [1.0]]])
        return pose


def _rotation(w: float, x: float, y: float, z: float) -> Floats:
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
