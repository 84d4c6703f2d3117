"""Reports: the content of a mesh file, and the shape made of it."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from fgenv.arrays import Faces, Ints32, Vertices

from .content import FileMesh, Unit

CHUNK = 1 << 18  # faces per step, which bounds the memory


@dataclass(frozen=True)
class FileSummary:
    """What a mesh file specifies, without the mesh.

    Attributes:
        format, unit, up, polygons, nonplanar, notes: see `FileMesh`.
        scale: factor that the caller applied after the unit.
        vertices, faces: numbers in the file, polygons as their triangles.
    """

    format: str
    unit: Unit | None
    up: str | None
    scale: float
    vertices: int
    faces: int
    polygons: int
    nonplanar: int
    notes: tuple[str, ...]

    @classmethod
    def of(cls, mesh: FileMesh, scale: float) -> FileSummary:
        """The summary of a mesh."""
        sizes = len(mesh.vertices), len(mesh.faces)
        counts = mesh.polygons, mesh.nonplanar
        return cls(mesh.format, mesh.unit, mesh.up, scale, *sizes, *counts, mesh.notes)


@dataclass(frozen=True)
class MeshReport:
    """The source of a shape, its repairs and its measures; `str(report)` is a table.

    Attributes:
        name: of the shape.
        file: what the file specifies; None for a shape made from arrays.
        vertices_in, faces_in: numbers before repairs.
        vertices, faces: numbers of the shape.
        repairs: number of each repair, as `Shape.repairs`.
        area: m^2.
        volume: m^3, signed: negative if the faces are wound inside out. Only watertight meshes
            have one: else None.
        extents: of the box along the axes, meters.
        watertight: whether every shell is closed.
        shells: number of parts connected by edges.
        feature_points, feature_edges: size of the feature graph.
        method: of the feature graph.
    """

    name: str
    file: FileSummary | None
    vertices_in: int
    faces_in: int
    vertices: int
    faces: int
    repairs: dict[str, int] = field(hash=False)
    area: float
    volume: float | None
    extents: tuple[float, float, float]
    watertight: bool
    shells: int
    feature_points: int
    feature_edges: int
    method: str

    def as_dict(self) -> dict[str, Any]:
        """All fields as plain data, for JSON; those of the file under `file`."""
        return asdict(self)

    def rows(self) -> list[tuple[str, str]]:
        """Labels and values, in the order of `str`."""
        x, y, z = self.extents
        rows = [] if self.file is None else _file_rows(self.file)
        rows += [
            ("vertices", f"{self.vertices_in:,} -> {self.vertices:,}"),
            ("faces", f"{self.faces_in:,} -> {self.faces:,}"),
            ("repairs", _counts(self.repairs) or "none"),
            ("extents", f"{x:.6g} x {y:.6g} x {z:.6g} m"),
            ("area", f"{self.area:.6g} m^2"),
            ("volume", "none" if self.volume is None else f"{self.volume:.6g} m^3"),
            ("watertight", "yes" if self.watertight else "no"),
            ("shells", f"{self.shells:,}"),
            ("features", f"{self.feature_points:,} points, {self.feature_edges:,} edges"),
            ("method", self.method),
        ]
        rows += [("note", note) for note in self.notes]
        return rows

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences on what the file has and the mesh does not, and on the mesh."""
        notes = () if self.file is None else self.file.notes
        inside_out = self.volume is not None and self.volume < 0
        return (*notes, "The faces are wound inside out.") if inside_out else notes

    def __str__(self) -> str:
        rows = self.rows()
        width = max(len(label) for label, _ in rows)
        lines = [f"{label:<{width}}  {value}" for label, value in rows]
        return "\n".join([self.name, *lines] if self.name else lines)


def _file_rows(file: FileSummary) -> list[tuple[str, str]]:
    unit = "meter (the format has none)"
    if file.unit is not None:
        unit = f"{file.unit.name} ({file.unit.meters:g} m)"
    up = f"{file.up} (axes are not converted)" if file.up else "not stated"
    polygons = f"{file.polygons:,} cut into triangles"
    if file.nonplanar:
        polygons += f", {file.nonplanar:,} of them not planar"
    return [
        ("format", file.format),
        ("unit", unit),
        ("scale", f"{file.scale:g}"),
        ("up axis", up),
        ("polygons", polygons if file.polygons else "none"),
    ]


def _counts(repairs: dict[str, int]) -> str:
    return ", ".join(f"{n:,} {name.replace('_', ' ')}" for name, n in repairs.items() if n)


def area_and_volume(vertices: Vertices, faces: Faces | Ints32) -> tuple[float, float]:
    """Area in m^2 and signed volume in m^3 of triangles, the latter about their center."""
    center = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
    area = volume = 0.0
    for begin in range(0, len(faces), CHUNK):
        a, b, c = (vertices[faces[begin : begin + CHUNK, k]] - center for k in range(3))
        area += 0.5 * float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())
        volume += float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6
    return area, volume
