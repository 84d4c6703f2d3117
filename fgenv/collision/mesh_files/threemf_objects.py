"""Objects of 3MF: meshes, and components that place other objects."""

from __future__ import annotations

import numpy as np

from fgenv.arrays import Faces, Floats, Vertices

from .affine import compose
from .scene_parts import SceneParts
from .text import parse
from .threemf_package import ModelObject, ModelPart, ThreemfPackage
from .xml_tree import Element

SURFACES = ("model", "surface")
SKIPPED = ("support", "solidsupport", "other")
READ_IN_OBJECT = {"mesh", "components", "metadatagroup"}
READ_IN_MESH = {"vertices", "triangles", "trianglesets"}
MAX_DEPTH = 256


def place_object(
    package: ThreemfPackage,
    found: ModelObject,
    pose: Floats,
    parts: SceneParts,
    path: frozenset[int] = frozenset(),
) -> None:
    """Add an object with its components at a pose (4, 4).

    Args:
        path: ids of the elements of the objects that contain it.
    """
    parts.visit()
    if id(found.element) in path:
        found.fail(f"{found} inside itself", "a tree of components")
    if len(path) > MAX_DEPTH:
        found.fail(f"components nested over {MAX_DEPTH} deep", "a flat build")
    kind = found.element.get("type", "model")
    if kind in SKIPPED:
        parts.note(f"Objects of type {kind} are skipped.")
        return
    if id(found.element) not in package.checked:
        package.checked[id(found.element)] = _content(found, kind)
    if (mesh := package.checked[id(found.element)]) is not None:
        parts.add(*mesh, pose, str(found))
    components = found.element.first("components")
    for component in components.all("component") if components else ():
        target = package.target(found.part, component)
        if id(component) not in package.poses:
            package.poses[id(component)] = pose_of(found.part, component)
        below = compose(pose, package.poses[id(component)])
        place_object(package, target, below, parts, path | {id(found.element)})


def pose_of(part: ModelPart, element: Element) -> Floats:
    """The matrix (4, 4) of the transform of an <item> or a <component>."""
    text = element.attributes.get("transform")
    if text is None:
        return np.eye(4)
    values = parse(text.encode(), np.float64)
    if values is None or len(values) != 12 or not np.isfinite(values).all():
        part.fail(element, f"the transform {text[:60]!r}", "12 finite numbers")
    pose = np.eye(4)
    pose[:3] = values.reshape(4, 3).T  # the format multiplies row vectors
    return pose


def _content(found: ModelObject, kind: str) -> tuple[Vertices, Faces] | None:
    """The mesh of an object, None for one of components; refuse what would change its triangles."""
    if kind not in SURFACES:
        found.fail(f"the type {kind[:20]!r} of {found}", f"one of {(*SURFACES, *SKIPPED)}")
    element = found.element
    mesh = element.first("mesh")
    for parent, read in ((element, READ_IN_OBJECT), (mesh, READ_IN_MESH)):
        for child in parent.children if parent else ():
            if child.tag not in read:
                found.fail(f"<{child.tag[:40]}> in {found}", "triangles; export it as a mesh")
    if any(name.rpartition(" ")[2] == "slicestackid" for name in element.attributes):
        found.fail(f"slices in {found}", "triangles; export it without slices")
    if (mesh is None) == (element.first("components") is None):
        found.fail(f"{found} with no content, or with both", "a mesh or components")
    return None if mesh is None else _mesh(found, mesh)


def _mesh(found: ModelObject, mesh: Element) -> tuple[Vertices, Faces]:
    tables = []
    for outer, inner in (("vertices", "vertex"), ("triangles", "triangle")):
        parent = mesh.first(outer)
        rows = parent.rows.get(inner) if parent else None
        tables.append(np.empty((0, 3)) if rows is None else np.frombuffer(rows).reshape(-1, 3))
    vertices, corners = tables
    with np.errstate(invalid="ignore"):
        faces = corners.astype(np.int64)
    wrong = (faces != corners) | (faces < 0) | (faces >= len(vertices))
    if wrong.any():
        value = corners[wrong][0]
        found.fail(f"the vertex {value:g} of a triangle of {found}", f"one of {len(vertices)}")
    return vertices, faces
