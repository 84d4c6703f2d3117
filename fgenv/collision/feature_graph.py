"""Feature points and feature graph of a mesh."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fgenv import _core

KINDS = np.array(["valley", "ridge", "border", "patch", "chord"])
METHODS = ("exact", "crease", "loop")
DENSE_LIMIT = 20_000  # feature points; a larger dense matrix exceeds 400 MB


class Settings(NamedTuple):
    """A method with its thresholds: radians and meters."""

    method: str
    valley: float
    ridge: float
    tolerance: float


def settings(
    method: str = "exact",
    *,
    tolerance: float | None = None,
    angle: float | tuple[float, float] | None = None,
) -> Settings:
    """Validate a choice of method.

    Args:
        method: `exact`, `crease` or `loop`; omit it if `tolerance` is given.
        tolerance: meters; 0 is `exact`, more keeps the borders of patches up to this thick.
        angle: radians, for `crease` and `loop`: smallest bend of a feature edge
            (default 30 degrees), or the published pair (alpha_valley, alpha_ridge): an edge is
            a feature if its dihedral angle is below the first or above the second.
    """
    if method == "tolerance" and tolerance is None:
        raise ValueError("tolerance: missing, expected meters with method='tolerance'")
    if method not in (*METHODS, "tolerance"):
        raise ValueError(f"method: {method!r} is unknown, expected one of {', '.join(METHODS)}")
    if tolerance is not None:
        if method not in ("exact", "tolerance"):
            raise ValueError(f"tolerance: not used by method {method!r}, leave one of them out")
        if not (is_number(tolerance) and tolerance >= 0 and math.isfinite(tolerance)):
            raise ValueError(f"tolerance: got {tolerance!r}, expected meters, 0 or more")
        method = "tolerance" if tolerance > 0 else "exact"
    if angle is not None and method not in ("crease", "loop"):
        raise ValueError(f"angle: not used by method {method!r}, expected with 'crease' or 'loop'")
    valley, ridge = _thresholds(math.pi / 6 if angle is None else angle)
    return Settings(method, valley, ridge, float(tolerance or 0.0))


def is_number(value: object) -> bool:
    return isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)


def _thresholds(angle: Any) -> tuple[float, float]:
    if is_number(angle):
        bend = float(angle)
        valley, ridge = math.pi - bend, math.pi + bend
    else:
        try:
            valley, ridge = (float(x) for x in angle)
        except (TypeError, ValueError):
            raise ValueError(
                f"angle: got {angle!r}, expected radians or a pair (alpha_valley, alpha_ridge)"
            ) from None
    if not (0 <= valley <= math.pi <= ridge <= 2 * math.pi):
        raise ValueError(
            f"angle: got {angle!r}, expected a bend from 0 to pi,"
            " or alpha_valley in [0, pi] and alpha_ridge in [pi, 2 pi]"
        )
    return valley, ridge


class FeatureGraph:
    """Feature points of a mesh and the edges between them.

    `loop` is the published head-to-tail cycle: unsound, for comparison. `crease` keeps edges
    by dihedral angle, `exact` all edges that are not flat, a tolerance the borders of patches.

    Args:
        vertices: (n, 3) meters.
        faces: (m, 3) vertex indices.
        method, tolerance, angle: see `settings`.

    Attributes:
        points: (n, 3) float64, feature points, in the mesh's frame.
        edges: (m, 2) int32, pairs of points.
        kinds: (m,) str: valley, ridge, border, patch or chord.
        adjacency: packed as published, one triangle only: uint8, `np.packbits` of the strict upper
            triangle of the symmetric n x n 0/1 matrix, row by row.
        tolerance: meters; a contact that the graph misses is no deeper than this (the sum over both
            shapes); 0 for `exact`, infinite if `crease` has no bound, None for `loop`.
    """

    def __init__(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        method: str = "exact",
        *,
        tolerance: float | None = None,
        angle: float | tuple[float, float] | None = None,
    ) -> None:
        chosen = settings(method, tolerance=tolerance, angle=angle)
        self._fill(_core.FeatureGraph(vertices, faces, **chosen._asdict()), chosen.method)

    @classmethod
    def _of(cls, native: _core.FeatureGraph, method: str) -> FeatureGraph:
        graph = cls.__new__(cls)
        graph._fill(native, method)
        return graph

    def _fill(self, native: _core.FeatureGraph, method: str) -> None:
        self._native = native
        self.method = method
        self.points: NDArray[np.float64] = native.points
        self.edges: NDArray[np.int32] = native.edges
        self.kinds: NDArray[np.str_] = KINDS[native.kind_codes]
        certificate = native.certificate
        self.tolerance: float | None = None if math.isnan(certificate) else certificate

    @property
    def adjacency(self) -> NDArray[np.uint8]:
        return self._native.adjacency

    def dense(self) -> NDArray[np.bool_]:
        """The (n, n) symmetric adjacency matrix; ValueError for more than 20,000 points."""
        n = len(self.points)
        if n > DENSE_LIMIT:
            raise ValueError(f"dense: {n} feature points, over {DENSE_LIMIT}; use edges")
        matrix = np.zeros((n, n), dtype=bool)
        matrix[self.edges[:, 0], self.edges[:, 1]] = True
        return matrix | matrix.T

    def __repr__(self) -> str:
        bound = "" if self.tolerance is None else f", tolerance={self.tolerance:g} m"
        size = f"{len(self.points)} points, {len(self.edges)} edges"
        return f"FeatureGraph({self.method}: {size}{bound})"
