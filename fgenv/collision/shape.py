"""A shape: an immutable mesh with its feature graph and its tree."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fgenv import _core

from .feature_graph import FeatureGraph, settings
from .mesh_files import FileSummary, MeshReport, read_mesh_file, unit_warning
from .mesh_files.report import area_and_volume

IDENTITY = np.eye(4)


class MeshWarning(UserWarning):
    """Repairs of a mesh, or a mesh without an inside; issued once per shape."""


class Shape(_core.Shape):
    """A mesh prepared for queries; bodies of the same form share it.

    Merges vertices at equal positions, drops faces of zero area and repeated faces, and turns faces
    wound against their neighbors. `repairs` lists the repairs; a `MeshWarning` reports them once.
    Closed shells are solid: points with a winding number other than 0 are inside, and collide.
    The rest of a mesh that is not watertight is a surface.

    Args:
        vertices: (n, 3) finite, meters.
        faces: (m, 3) whole numbers, vertex indices.
        method: `exact` (default), `crease`, or `loop` (published, unsound, for comparison).
        tolerance: meters; replaces `method`: keep the borders of patches this thick. A missed
            contact is no deeper than the sum of both shapes' tolerances.
        angle: radians, for `crease` and `loop`; see `FeatureGraph`.
        name: used in messages.
        progress: called with the share of the work that is done, from 0 to 1; what it raises ends
            the construction, as Ctrl-C does.

    Raises:
        ValueError, TypeError: invalid argument, with its name, its value and the expected value.
    """

    def __init__(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        method: str = "exact",
        *,
        tolerance: float | None = None,
        angle: float | tuple[float, float] | None = None,
        name: str = "",
        progress: Callable[[float], None] | None = None,
    ) -> None:
        self.settings = settings(method, tolerance=tolerance, angle=angle)
        self.name = name
        self._file: FileSummary | None = None
        super().__init__(vertices, faces, progress=progress, **self.settings._asdict())
        self._warn()

    @classmethod
    def load(
        cls,
        path: str | Path,
        *,
        scale: float = 1.0,
        method: str = "exact",
        tolerance: float | None = None,
        angle: float | tuple[float, float] | None = None,
        name: str | None = None,
        progress: Callable[[str, float], None] | None = None,
    ) -> Shape:
        """Read a mesh file (STL, OBJ, PLY, OFF, GLB, glTF, DAE, 3MF, also packed by gzip or zip).

        `report` lists the content. Lengths become meters by the unit that the file states or its
        format implies, then are multiplied by `scale`. A `MeshWarning` reports a size that is
        implausible in meters, for a format without unit. Axes are not converted.

        Args:
            path: the file; the meshes of a scene are placed and joined into one.
            scale: factor, e.g. 0.001 for a file in millimeters of a format without unit.
            name: default: the file's name without its suffixes.
            progress: called with the stage, "reading" or "building", and the share that is done.

        Raises:
            FileNotFoundError, ValueError: with the file's name and the remedy.
        """
        path = Path(path)
        call = progress or (lambda stage, share: None)
        mesh = read_mesh_file(path, scale, partial(call, "reading"))
        options: dict[str, Any] = {"tolerance": tolerance, "angle": angle}
        options["progress"] = progress and partial(progress, "building")
        packed = path.suffix.lower() == ".gz"
        options["name"] = (
            name if name is not None else Path(path.stem).stem if packed else path.stem
        )
        if problem := unit_warning(mesh, scale):
            warnings.warn(f"mesh {options['name']!r} {problem}", MeshWarning, stacklevel=2)
        try:
            shape = cls(mesh.vertices, mesh.faces, method, **options)
        except ValueError as error:
            if str(error).startswith(("vertices", "faces")):
                raise ValueError(f"path: {path}: {error}") from None
            raise
        shape._file = FileSummary.of(mesh, scale)
        return shape

    @property
    def method(self) -> str:
        """exact, crease, loop or tolerance."""
        return self.settings.method

    @cached_property
    def graph(self) -> FeatureGraph:
        """The feature graph, in the shape's frame."""
        return FeatureGraph._of(self.native_graph, self.method)

    @cached_property
    def report(self) -> MeshReport:
        """What the shape was read from, the repairs, and its measures."""
        vertices, repairs = self.vertices, self.repairs
        area, volume = area_and_volume(vertices, self.faces)
        low, high = self.bounds.tolist()
        points, edges = self.feature_counts
        faces = len(self.faces)
        return MeshReport(
            name=self.name,
            file=self._file,
            vertices_in=len(vertices) + repairs["merged_vertices"] + repairs["unused_vertices"],
            faces_in=faces + repairs["degenerate_faces"] + repairs["duplicate_faces"],
            vertices=len(vertices),
            faces=faces,
            repairs=repairs,
            area=area,
            volume=volume if self.watertight else None,
            extents=(high[0] - low[0], high[1] - low[1], high[2] - low[2]),
            watertight=self.watertight,
            shells=self.shells,
            feature_points=points,
            feature_edges=edges,
            method=self.method,
        )

    def contains(
        self, points: ArrayLike, T: ArrayLike | None = None, *, threads: int | None = None
    ) -> NDArray[np.bool_]:
        """Whether points (..., 3) are inside the solid at pose T (..., 4, 4) or on its surface.

        Inside means that the winding number is not 0. ValueError unless the mesh is watertight.
        """
        return _core.contains(self, points, IDENTITY if T is None else T, threads=threads)

    def raycast(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        T: ArrayLike | None = None,
        max_distance: float = np.inf,
        *,
        threads: int | None = None,
    ) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
        """First hits of rays on the surface, from either side.

        Faces are closed and decided exactly: a ray that touches only a vertex or an edge hits it,
        and no ray passes between neighboring faces. A ray that starts on a face has distance 0.
        A face whose plane holds the ray is not hit itself, but its neighbors are, at their edges.

        Args:
            origins, directions: (..., 3), world frame; directions have any length above 0.
            T: pose of the shape (..., 4, 4); default: identity.
            max_distance: meters.

        Returns:
            Distances in meters (inf: no hit) and face indices (-1: no hit), broadcast.
        """
        pose = IDENTITY if T is None else T
        return _core.raycast(
            self, origins, directions, pose, max_distance=max_distance, threads=threads
        )

    def __repr__(self) -> str:
        label = f"{self.name!r}: " if self.name else ""
        kind = "solid" if self.watertight else "surface"
        return f"Shape({label}{len(self.faces)} faces, {kind}, {self.method})"

    def __reduce__(self) -> tuple[Any, ...]:
        # Includes the dropped flat faces: a shell that they close would otherwise be open.
        flat = self.flat_faces.reshape(-1, 3)
        more = np.arange(len(flat), dtype=np.int32).reshape(-1, 3) + len(self.vertices)
        mesh = np.vstack([self.vertices, flat]), np.vstack([self.faces, more])
        return _rebuild, (type(self), *mesh, tuple(self.settings), self.name, self._file)

    def _warn(self) -> None:
        label = f"mesh {self.name!r}" if self.name else "mesh"
        done = {what: n for what, n in self.repairs.items() if n}
        if not done.keys() <= {"merged_vertices"}:  # expected: an STL file repeats every vertex
            counts = ", ".join(f"{n} {what.replace('_', ' ')}" for what, n in done.items())
            warnings.warn(f"{label} repaired: {counts}", MeshWarning, stacklevel=4)
        if not self.watertight:
            warnings.warn(
                f"{label} is not watertight: its closed shells are solid, the rest is a surface",
                MeshWarning,
                stacklevel=4,
            )


def _rebuild(
    cls: type[Shape],
    vertices: NDArray[np.float64],
    faces: NDArray[np.int32],
    chosen: tuple[str, float, float, float],
    name: str,
    file: FileSummary | None = None,
) -> Shape:
    """Unpickle: the mesh is already repaired and reported."""
    method, valley, ridge, tolerance = chosen
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MeshWarning)
        shape = cls(
            vertices,
            faces,
            method,
            tolerance=tolerance if method == "tolerance" else None,
            angle=(valley, ridge) if method in ("crease", "loop") else None,
            name=name,
        )
    shape._file = file
    return shape
