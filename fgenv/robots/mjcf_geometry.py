"""Shapes of links from the geoms of a compiled MJCF model, and pairs that never collide."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Floats
from fgenv.collision import Shape

from . import primitives
from .links_joints import LinkShape
from .urdf import rotation_of_quaternion

MAX_MASKS = 1000  # different ones
VISIBLE_GROUPS = 3  # MuJoCo's viewer shows groups 0 to 2 by default


@dataclass
class Geometry:
    """Geoms of a model as shapes.

    Attributes:
        model: MjModel.
        collision: use geoms that collide; False: geoms of the visible groups.
        scale: factor of all lengths.
        error: meters, of round shapes.
        options: of Shape.
    """

    model: Any
    collision: bool
    scale: float
    error: float
    options: dict[str, Any]
    cache: dict[tuple[Any, ...], tuple[Shape, float]] = field(default_factory=dict)

    def chosen(self) -> NDArray[np.bool_]:
        """Flags of the geoms that are used."""
        model = self.model
        if not self.collision:
            return np.asarray(np.asarray(model.geom_group) < VISIBLE_GROUPS)
        masks = np.asarray(model.geom_contype) | np.asarray(model.geom_conaffinity)
        flags = np.asarray(masks != 0)
        flags[explicit_geoms(model).ravel()] = True
        return flags

    def shapes(self, body: int, chosen: NDArray[np.bool_]) -> list[LinkShape]:
        """Shapes of a body.

        Raises:
            ValueError: a geom that is no solid, or an invalid size; names the geom.
        """
        first, count = int(self.model.body_geomadr[body]), int(self.model.body_geomnum[body])
        return [self._placed(i) for i in range(first, first + count) if chosen[i]]

    def _placed(self, geom: int) -> LinkShape:
        model = self.model
        name = model.geom(geom).name
        label = f"geom {name!r}" if name else f"geom {geom} (from 0)"
        try:
            shape, excess = self._shape(geom)
        except ValueError as error:
            body = model.body(int(model.geom_bodyid[geom])).name
            raise ValueError(f"{label} of body {body!r}: {error}") from None
        origin = pose(model.geom_pos[geom] * self.scale, model.geom_quat[geom])
        return LinkShape(shape, origin, excess)

    def _shape(self, geom: int) -> tuple[Shape, float]:
        kind = geom_kind(self.model, geom)
        size = tuple((self.scale * np.asarray(self.model.geom_size[geom])).tolist())
        key = (kind, int(self.model.geom_dataid[geom]) if kind == "mesh" else size)
        if key not in self.cache:
            self.cache[key] = self._built(kind, size, int(self.model.geom_dataid[geom]))
        return self.cache[key]

    def _built(self, kind: str, size: Sequence[float], data: int) -> tuple[Shape, float]:
        x, y, z = size
        if kind == "box":
            return primitives.box([2 * x, 2 * y, 2 * z], **self.options), 0.0
        if kind == "sphere":
            return primitives.sphere(x, self.error, **self.options)
        if kind == "capsule":
            return primitives.capsule(x, 2 * y, self.error, **self.options)
        if kind == "cylinder":
            return primitives.cylinder(x, 2 * y, self.error, **self.options)
        if kind == "ellipsoid":
            return primitives.ellipsoid(size, self.error, **self.options)
        if kind == "mesh":
            return self._mesh(data), 0.0
        raise ValueError(f"got type {kind}, expected a solid; replace it by a box or a mesh")

    def _mesh(self, mesh: int) -> Shape:
        """The shape of a mesh, in the frame that MuJoCo gives it."""
        model = self.model
        first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
        vertices = np.asarray(model.mesh_vert[first : first + count], dtype=np.float64)
        first, count = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
        faces = np.asarray(model.mesh_face[first : first + count])
        name = model.mesh(mesh).name or "mesh"
        return Shape(self.scale * vertices, faces, name=name, **self.options)


def geom_kind(model: Any, geom: int) -> str:
    """Name of a geom's type, as in a file."""
    import mujoco

    name: str = mujoco.mjtGeom(int(model.geom_type[geom])).name
    return name.removeprefix("mjGEOM_").lower()


def pose(position: Iterable[float], wxyz: Iterable[float]) -> Floats:
    """A pose (4, 4) from a position and a quaternion of MuJoCo."""
    w, x, y, z = (float(c) for c in wxyz)
    length = float(np.sqrt(w * w + x * x + y * y + z * z))
    matrix = np.eye(4)
    matrix[:3, :3] = rotation_of_quaternion(x / length, y / length, z / length, w / length)
    matrix[:3, 3] = list(position)
    return matrix


def explicit_geoms(model: Any) -> NDArray[np.int64]:
    """Geoms of each <pair>, (n, 2); they collide whatever their masks are."""
    return np.column_stack([model.pair_geom1, model.pair_geom2]).astype(np.int64)


def excluded_bodies(model: Any) -> set[tuple[int, int]]:
    """Pairs of bodies of <exclude>, in rising order."""
    signatures = [int(s) for s in model.exclude_signature]
    return {(min(s >> 16, s & 0xFFFF), max(s >> 16, s & 0xFFFF)) for s in signatures}


def unmatched_bodies(
    model: Any, chosen: NDArray[np.bool_], bodies: Iterable[int]
) -> set[tuple[int, int]]:
    """Pairs of bodies, in rising order, with chosen geoms that cannot touch by their masks."""
    kinds: dict[int, set[tuple[int, int]]] = {body: set() for body in bodies}
    for geom in np.flatnonzero(chosen):
        if (body := int(model.geom_bodyid[geom])) in kinds:
            kinds[body].add((int(model.geom_contype[geom]), int(model.geom_conaffinity[geom])))
    masks = {body: frozenset(kind) for body, kind in sorted(kinds.items()) if kind}
    if sum(map(len, set(masks.values()))) > MAX_MASKS:
        raise ValueError(
            f"contype, conaffinity: got over {MAX_MASKS} sets of masks, expected fewer"
        )
    unmatched = {
        (a, b)
        for a, b in itertools.product(set(masks.values()), repeat=2)
        if not any(s & v or t & u for (s, u), (t, v) in itertools.product(a, b))
    }
    pairs = {
        (a, b) for a, b in itertools.combinations(masks, 2) if (masks[a], masks[b]) in unmatched
    }
    of = np.asarray(model.geom_bodyid)
    explicit = of[explicit_geoms(model)].reshape(-1, 2)
    return pairs - {(min(a, b), max(a, b)) for a, b in explicit.tolist()}
