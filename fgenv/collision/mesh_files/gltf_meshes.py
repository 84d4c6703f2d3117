"""Meshes of glTF: triangles of all primitive modes, morph targets, and skins."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fgenv.arrays import Faces, Floats, Ints, Vertices

from .affine import mirrors, transformed
from .gltf_accessors import AccessorReader
from .gltf_document import GltfDocument, Item
from .polygons import fan_faces, strip_faces
from .scene_parts import SceneParts

TRIANGLES, STRIP, FAN = 4, 5, 6
NOT_SURFACES = {0: "points", 1: "lines", 2: "lines", 3: "lines"}
LENGTH_ERROR = 0.02  # of the sum of weights and of quaternions: 8 bits per component


@dataclass(frozen=True)
class Primitive:
    """Triangles of one primitive.

    Attributes:
        place: its name in messages.
        vertices: (n, 3).
        faces: (m, 3).
        used: (n,) which elements of the accessors the vertices are.
        attributes: accessors by name.
        targets: the same of each morph target.
    """

    place: str
    vertices: Vertices
    faces: Faces
    used: Ints
    attributes: Item
    targets: list[Any]


class MeshReader:
    """Reads the meshes of a document, each one once."""

    def __init__(self, document: GltfDocument, parts: SceneParts) -> None:
        self.document = document
        self.accessors = AccessorReader(document)
        self.parts = parts
        self._meshes: dict[int, list[Primitive]] = {}
        self._corners = 0

    def primitives(self, index: Any, place: str) -> list[Primitive]:
        """The primitives of a mesh that are surfaces; lines and points are noted."""
        mesh = self.document.item("meshes", index, place)
        if index not in self._meshes:
            name = f"meshes[{index}]"
            self.document.extensions(mesh, name)
            items = self.document.array(mesh, "primitives", name)
            places = [f"{name}.primitives[{i}]" for i in range(len(items))]
            found = map(self._primitive, items, places)
            self._meshes[index] = [primitive for primitive in found if primitive is not None]
        return self._meshes[index]

    def weights(self, node: Item, place: str, count: int) -> Floats:
        """Weights of the morph targets of a node's mesh: of the node, else of the mesh, else 0."""
        mesh = self.document.item("meshes", node["mesh"], place)
        for item, name in ((node, place), (mesh, f"meshes[{node['mesh']}]")):
            weights = self.document.numbers(item, "weights", name)
            if weights is not None:
                if len(weights) != count:
                    self.document.fail(
                        f"{name}: weights", f"{len(weights)} numbers", f"{count}, one per target"
                    )
                return weights
        return np.zeros(count)

    def _primitive(self, item: Any, place: str) -> Primitive | None:
        document = self.document
        if not isinstance(item, dict):
            document.fail(place, "no object", "a primitive")
        mode = document.whole(item, "mode", place, TRIANGLES)
        if mode in NOT_SURFACES:
            self.parts.note(f"{NOT_SURFACES[mode].capitalize()} are skipped: they have no surface.")
            return None
        attributes = document.object(item, "attributes", place)
        self._check_compression(item, attributes, place)
        if "POSITION" not in attributes:
            document.fail(place, "no POSITION attribute", "vertices")
        positions = self.accessors.floats(attributes["POSITION"], "VEC3", place)
        corners = np.arange(len(positions))
        if "indices" in item:
            corners = self.accessors.indices(item["indices"], "SCALAR", place)[:, 0]
        if len(corners) and corners.max() >= len(positions):
            document.fail(
                place, f"the index {corners.max()}", f"indices of its {len(positions)} vertices"
            )
        self._corners += len(corners)
        self.parts.check_size(self._corners)
        used = np.arange(len(positions))
        if len(corners) < len(positions):  # primitives can share an accessor of all vertices
            used, corners = np.unique(corners, return_inverse=True)
        faces = self._faces(mode, corners, place)
        targets = document.array(item, "targets", place)
        return Primitive(place, positions[used], faces, used, attributes, targets)

    def morphed(self, primitive: Primitive, weights: Floats) -> Vertices:
        """Vertices (n, 3) of a primitive with its morph targets at their weights."""
        vertices = primitive.vertices
        for i, (weight, target) in enumerate(zip(weights, primitive.targets, strict=True)):
            place = f"{primitive.place}.targets[{i}]"
            if not isinstance(target, dict):
                self.document.fail(place, "no object", "a morph target")
            if weight and "POSITION" in target:
                offsets = self.accessors.floats(target["POSITION"], "VEC3", place)
                if len(offsets) <= primitive.used.max(initial=-1):
                    self.document.fail(place, f"{len(offsets)} offsets", "one per vertex")
                with np.errstate(over="ignore", invalid="ignore"):  # the caller reports infinity
                    vertices = vertices + weight * offsets[primitive.used]
        return vertices

    def _check_compression(self, item: Item, attributes: Item, place: str) -> None:
        """Refuse compressed data, unless the file has the same data uncompressed."""
        document = self.document
        extensions = document.extensions(item, place, ("KHR_materials_variants",))
        for index in (attributes.get("POSITION"), item.get("indices")):
            if index is not None:
                accessor = document.item("accessors", index, place)
                if "bufferView" not in accessor and "sparse" not in accessor:
                    document.refuse_compression(extensions, place)

    def _faces(self, mode: int, corners: Ints, place: str) -> Faces:
        if mode not in (TRIANGLES, STRIP, FAN):
            self.document.fail(place, f"the mode {mode}", "a mode of 0 to 6")
        n = len(corners)
        if n == 0:
            return np.empty((0, 3), dtype=np.int64)
        if n < 3 or (mode == TRIANGLES and n % 3):
            expected = "a multiple of 3, for triangles" if mode == TRIANGLES else "at least 3"
            self.document.fail(place, f"{n} corners", expected)
        if mode == TRIANGLES:
            return corners.reshape(-1, 3).astype(np.int64)
        return strip_faces(corners) if mode == STRIP else fan_faces(corners)


def skinned(
    reader: MeshReader, primitive: Primitive, vertices: Vertices, joints: list[Floats]
) -> tuple[Vertices, Faces]:
    """Vertices (n, 3) of a skinned primitive in the scene, and its faces.

    Args:
        vertices: (n, 3), morphed.
        joints: matrices (4, 4) of the skin's joints, from the mesh to the scene.
    """
    influences, weights = _influences(reader, primitive, len(joints))
    moved = np.zeros_like(vertices)
    linear = np.zeros((len(vertices), 3, 3))
    for j, pose in enumerate(joints):
        share = np.where(influences == j, weights, 0.0).sum(axis=1)
        used = np.flatnonzero(share)
        moved[used] += share[used, None] * transformed(vertices[used], pose)
        linear[used] += share[used, None, None] * pose[:3, :3]
    faces = primitive.faces.copy()
    mirrored = mirrors(linear)[faces[:, 0]]
    faces[mirrored] = faces[mirrored, ::-1]
    return moved, faces


def _influences(reader: MeshReader, primitive: Primitive, joints: int) -> tuple[Ints, Floats]:
    """Joints (n, 4 k) of the vertices of a skinned primitive, and their weights."""
    document, place = reader.document, primitive.place
    sets = sum(name.startswith("JOINTS_") for name in primitive.attributes)
    indices, weights = [], []
    for i in range(sets):
        for name in (f"JOINTS_{i}", f"WEIGHTS_{i}"):
            if name not in primitive.attributes:
                document.fail(place, f"no {name} attribute", f"{sets} sets of joints and weights")
        joint_accessor, weight_accessor = (
            primitive.attributes[f"{kind}_{i}"] for kind in ("JOINTS", "WEIGHTS")
        )
        indices.append(reader.accessors.indices(joint_accessor, "VEC4", place))
        weights.append(reader.accessors.floats(weight_accessor, "VEC4", place))
    last = primitive.used.max(initial=-1)
    if not sets or any(len(array) <= last for array in (*indices, *weights)):
        document.fail(place, "a skin without joints for each vertex", "JOINTS_0 and WEIGHTS_0")
    influences = np.hstack([array[primitive.used] for array in indices])
    shares = np.hstack([array[primitive.used] for array in weights])
    if influences[shares != 0].max(initial=0) >= joints:
        document.fail(place, f"the joint {influences.max()}", f"the {joints} joints of its skin")
    totals = shares.sum(axis=1, keepdims=True)
    if not (np.abs(totals - 1) <= LENGTH_ERROR).all():
        document.fail(place, "weights of a vertex that do not add up to 1", "normalized weights")
    return influences, shares / totals
