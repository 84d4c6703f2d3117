"""Nodes of COLLADA: the scene, transforms and instances."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from fgenv.arrays import Floats

from .affine import axis_rotation, compose, scaling, translation
from .collada_document import ColladaDocument
from .collada_geometry import GeometryReader
from .scene_parts import SceneParts
from .xml_tree import Element

INSTANCES = ("instance_geometry", "instance_controller", "instance_node", "node")
SURFACE_TAGS = frozenset(INSTANCES[:3])
REMEDIES = {
    "instance_controller": "a mesh; apply its armature or shape keys, and export it again",
    "skew": "matrix, translate, rotate, scale or lookat; apply the transform and export it again",
}


class _Placer:
    """Walks the nodes of a scene."""

    def __init__(self, document: ColladaDocument, parts: SceneParts) -> None:
        self.document = document
        self.parts = parts
        self.reader = GeometryReader(document, parts)
        self.used: set[int] = set()
        self.path: set[int] = set()  # ids of the nodes that contain the current one
        self._holds_surface: dict[int, bool] = {}

    def place(self, node: Element, parent: Floats) -> None:
        """Add the geometry of a node and of the nodes below it."""
        if not self._has_surface(node):  # e.g. cameras, with a transform of any kind
            return
        self.parts.visit()
        if id(node) in self.path:
            self.document.fail(node, f"{node} inside itself", "a tree of nodes")
        if len(self.path) > 256:
            self.document.fail(node, "instances nested over 256 deep", "a flat scene")
        self.path.add(id(node))
        pose = parent
        for element in node.children:
            if element.tag in TRANSFORMS or element.tag == "skew":
                pose = compose(pose, _transform(self.document, element))
        for element in node.all(*INSTANCES):
            self._instance(element, pose)
        self.path.remove(id(node))

    def _instance(self, element: Element, pose: Floats) -> None:
        if element.tag == "node":
            self.place(element, pose)
        elif element.tag == "instance_node":
            self.place(self.document.target(element, "node"), pose)
        elif element.tag == "instance_geometry":
            geometry = self.document.target(element, "geometry")
            self.used.add(id(geometry))
            for surface in self.reader.surfaces(geometry):
                self.parts.add(*surface, pose, str(geometry))
        else:
            self.document.fail(
                element, f"<{element.tag}> (a skin or a morph)", REMEDIES[element.tag]
            )

    def _has_surface(self, node: Element) -> bool:
        if id(node) not in self._holds_surface:
            found = any(element.tag in SURFACE_TAGS for element in node.below())
            self._holds_surface[id(node)] = found
        return self._holds_surface[id(node)]


def place_scene(document: ColladaDocument, parts: SceneParts) -> None:
    """Add the geometry of the file's scene."""
    placer = _Placer(document, parts)
    scene = _scene(document, parts)
    for node in scene.all("node"):
        placer.place(node, np.eye(4))
    geometries = [
        geometry
        for library in document.root.all("library_geometries")
        for geometry in library.all("geometry")
    ]
    unused = sum(id(geometry) not in placer.used for geometry in geometries)
    if geometries and unused == len(geometries):
        document.fail(scene, "a scene without geometry", "nodes with <instance_geometry>")
    if unused:
        parts.note(f"{unused} geometries are not in the scene, and are skipped.")


def _scene(document: ColladaDocument, parts: SceneParts) -> Element:
    """The visual scene that the file instances; its only one if it states none."""
    scenes = [
        scene
        for library in document.root.all("library_visual_scenes")
        for scene in library.all("visual_scene")
    ]
    stated = document.root.first("scene")
    if stated is not None and stated.all("instance_physics_scene"):
        parts.note("The physics scene is not read.")
    instance = stated.first("instance_visual_scene") if stated else None
    if instance is None and len(scenes) != 1:
        document.fail(
            document.root, f"no <scene>, and {len(scenes)} visual scenes", "<instance_visual_scene>"
        )
    scene = scenes[0] if instance is None else document.target(instance, "visual_scene")
    if len(scenes) > 1:
        parts.note(f"The file has {len(scenes)} visual scenes; {scene.get('id')[:60]!r} is read.")
    return scene


def _transform(document: ColladaDocument, element: Element) -> Floats:
    """The matrix (4, 4) of a transform element."""
    if element.tag == "skew":
        document.fail(element, "<skew>", REMEDIES["skew"])
    count, matrix = TRANSFORMS[element.tag]
    values: Floats = document.numbers(element, count=count)
    if not np.isfinite(values).all():
        document.fail(element, f"NaN or infinity in <{element.tag}>", "finite numbers")
    pose = matrix(values)
    if pose is None:
        document.fail(element, f"<{element.tag}> {values.tolist()}", DEFINED[element.tag])
    return pose


def _matrix(values: Floats) -> Floats | None:
    pose = values.reshape(4, 4)
    return pose if np.array_equal(pose[3], (0, 0, 0, 1)) else None


def _rotate(values: Floats) -> Floats | None:
    angle = float(values[3])
    if not values[:3].any():  # several exporters write an axis of zeros for no rotation
        return np.eye(4) if angle == 0 else None
    return axis_rotation(values[:3] / np.abs(values[:3]).max(), angle)


def _lookat(values: Floats) -> Floats | None:
    """The pose of a camera at the eye that sees the point of interest along its -z axis."""
    eye, interest, up = values.reshape(3, 3)
    back = eye - interest
    right = np.cross(up, back)
    lengths = [float(np.sqrt((axis * axis).sum())) for axis in (back, right)]
    if not min(lengths) > 0:
        return None
    back, right = back / lengths[0], right / lengths[1]
    pose = translation(eye)
    pose[:3, :3] = np.stack([right, np.cross(back, right), back], axis=1)
    return pose


Matrix = Callable[[Floats], Floats | None]
TRANSFORMS: Mapping[str, tuple[int, Matrix]] = {
    "matrix": (16, _matrix),
    "translate": (3, translation),
    "rotate": (4, _rotate),
    "scale": (3, scaling),
    "lookat": (9, _lookat),
}
DEFINED = {
    "matrix": "an affine matrix, with 0, 0, 0, 1 as its last row",
    "rotate": "an axis that is not zero",
    "lookat": "three different directions",
}
