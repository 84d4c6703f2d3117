"""Nodes of glTF: the scene, transforms, instances and skins."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from fgenv.arrays import Floats

from .affine import compose, quaternion_rotation, scaling, translation
from .gltf_document import GltfDocument, Item
from .gltf_meshes import LENGTH_ERROR, MeshReader, skinned
from .scene_parts import SceneParts

INSTANCING = "EXT_mesh_gpu_instancing"


def scene_roots(document: GltfDocument, parts: SceneParts) -> list[int]:
    """Root nodes of the default scene; of the first scene, or of the file, if it states none."""
    _check_forest(document)
    scenes = document.items("scenes")
    if not scenes:
        children = {i for node in _nodes(document) for i in node.get("children", ())}
        return [i for i in range(len(document.items("nodes"))) if i not in children]
    chosen = document.content.get("scene", 0)
    scene = document.item("scenes", chosen, "the file")
    document.extensions(scene, f"scenes[{chosen}]")
    if len(scenes) > 1:
        parts.note(f"The file has {len(scenes)} scenes; scene {chosen} is read.")
    roots = document.array(scene, "nodes", f"scenes[{chosen}]")
    _check_roots(document, roots)
    return roots


def place_nodes(document: GltfDocument, roots: list[Any], parts: SceneParts) -> None:
    """Add the meshes of all nodes below the roots."""
    poses = _world_poses(document)
    reader = MeshReader(document, parts)
    left = roots[::-1]
    while left:
        index = left.pop()
        parts.visit()
        node = document.item("nodes", index, "a scene")
        if "mesh" in node:
            _place_mesh(reader, node, index, poses)
        left.extend(node.get("children", [])[::-1])
    if document.items("meshes") and not document.used["meshes"]:
        document.source.fail("no mesh in the scene", "nodes with meshes; export the scene again")


def _nodes(document: GltfDocument) -> list[Item]:
    return [document.item("nodes", i, "the file") for i in range(len(document.items("nodes")))]


def _check_forest(document: GltfDocument) -> None:
    """Check that each node has at most one parent, and that there is no cycle."""
    parents: dict[int, int] = {}
    nodes = _nodes(document)
    for i, node in enumerate(nodes):
        for child in document.array(node, "children", f"nodes[{i}]"):
            document.item("nodes", child, f"nodes[{i}]")
            if child in parents:
                both = f"nodes {parents[child]} and {i}"
                document.fail(f"nodes[{child}]", f"two parents ({both})", "one; repeat the node")
            parents[child] = i
    reached = [i for i in range(len(nodes)) if i not in parents]
    for i in reached:  # grows
        reached.extend(nodes[i].get("children", []))
    if len(reached) < len(nodes):
        cycle = min(set(range(len(nodes))) - set(reached))
        document.fail(f"nodes[{cycle}]", "a cycle", "a tree of nodes")


def _check_roots(document: GltfDocument, roots: list[Any]) -> None:
    children = {child for node in _nodes(document) for child in node.get("children", [])}
    for root in roots:
        document.item("nodes", root, "the scene")
        if root in children:
            document.fail("the scene", f"the child nodes[{root}]", "root nodes; it has a parent")
    if len(set(roots)) < len(roots):
        document.fail("the scene", "a node twice", "each root node once")


def _world_poses(document: GltfDocument) -> list[Floats]:
    """The matrix (4, 4) of each node in its scene."""
    nodes = _nodes(document)
    poses = [_local_pose(document, node, f"nodes[{i}]") for i, node in enumerate(nodes)]
    children = {child for node in nodes for child in node.get("children", [])}
    order = [i for i in range(len(nodes)) if i not in children]
    for i in order:  # grows
        for child in nodes[i].get("children", []):
            poses[child] = compose(poses[i], poses[child])
            order.append(child)
    return poses


def _local_pose(document: GltfDocument, node: Item, place: str) -> Floats:
    """The matrix (4, 4) of a node relative to its parent."""
    matrix = document.numbers(node, "matrix", place, 16)
    t, r, s = (
        document.numbers(node, key, place, count)
        for key, count in (("translation", 3), ("rotation", 4), ("scale", 3))
    )
    if matrix is None:
        return _trs(document, t, r, s, place)
    if not all(part is None for part in (t, r, s)):
        document.fail(place, "a matrix and a translation, rotation or scale", "one of both")
    pose = matrix.reshape(4, 4).T
    if not np.array_equal(pose[3], (0, 0, 0, 1)):
        document.fail(f"{place}: matrix", f"the last row {pose[3].tolist()}", "0, 0, 0, 1")
    return pose


def _trs(
    document: GltfDocument, t: Floats | None, r: Floats | None, s: Floats | None, place: str
) -> Floats:
    pose = np.eye(4) if t is None else translation(t)
    if r is not None:
        length = math.hypot(*r.tolist())
        if not abs(length - 1) <= LENGTH_ERROR:
            document.fail(
                f"{place}: rotation", f"a quaternion of length {length:g}", "the length 1"
            )
        pose = compose(pose, quaternion_rotation(r))
    return pose if s is None else compose(pose, scaling(s))


def _place_mesh(reader: MeshReader, node: Item, index: int, poses: list[Floats]) -> None:
    """Add the mesh of a node, once per instance."""
    document, place = reader.document, f"nodes[{index}]"
    extensions = document.extensions(node, place, (INSTANCING,))
    primitives = reader.primitives(node["mesh"], place)
    counts = {len(primitive.targets) for primitive in primitives}
    if len(counts) > 1:
        document.fail(f"meshes[{node['mesh']}]", "unequal numbers of morph targets", "equal ones")
    weights = reader.weights(node, place, counts.pop()) if counts else np.empty(0)
    morphed = [reader.morphed(primitive, weights) for primitive in primitives]
    if "skin" in node:
        if INSTANCING in extensions:
            document.fail(place, "instances of a skinned mesh", "a mesh without skin")
        joints = _joints(reader, node, place, poses)
        for primitive, vertices in zip(primitives, morphed, strict=True):
            reader.parts.add(*skinned(reader, primitive, vertices, joints), np.eye(4), place)
        return
    for pose in _instances(reader, extensions, place, poses[index]):
        for primitive, vertices in zip(primitives, morphed, strict=True):
            reader.parts.add(vertices, primitive.faces, pose, place)


def _instances(
    reader: MeshReader, extensions: Item, place: str, parent: Floats
) -> Iterator[Floats]:
    """Matrices (4, 4) of EXT_mesh_gpu_instancing; that of the node without it."""
    if INSTANCING not in extensions:
        yield parent
        return
    document, name = reader.document, f"{place}.{INSTANCING}"
    extension = document.object(extensions, INSTANCING, place)
    attributes = document.object(extension, "attributes", name)
    columns = {
        key: reader.accessors.floats(attributes[key], kind, name)
        for key, kind in (("TRANSLATION", "VEC3"), ("ROTATION", "VEC4"), ("SCALE", "VEC3"))
        if key in attributes
    }
    counts = {len(column) for column in columns.values()}
    if len(counts) != 1:
        document.fail(name, f"attributes of {len(counts)} lengths", "one length for all")
    for i in range(counts.pop()):
        row = {key: column[i] for key, column in columns.items()}
        t, r, s = (row.get(key) for key in ("TRANSLATION", "ROTATION", "SCALE"))
        reader.parts.visit()
        yield compose(parent, _trs(document, t, r, s, f"{name} instance {i}"))


def _joints(reader: MeshReader, node: Item, place: str, poses: list[Floats]) -> list[Floats]:
    """Matrices (4, 4) from a skinned mesh to the scene, one per joint."""
    document = reader.document
    skin = document.item("skins", node["skin"], place)
    name = f"skins[{node['skin']}]"
    joints = document.array(skin, "joints", name)
    for joint in joints:
        document.item("nodes", joint, name)
    inverse = np.broadcast_to(np.eye(4), (len(joints), 4, 4))
    if "inverseBindMatrices" in skin:
        columns = reader.accessors.floats(skin["inverseBindMatrices"], "MAT4", name)
        if len(columns) < len(joints):
            document.fail(name, f"{len(columns)} inverse bind matrices", f"{len(joints)}")
        inverse = columns.reshape(-1, 4, 4).transpose(0, 2, 1)
    return [compose(poses[joint], inverse[i]) for i, joint in enumerate(joints)]
