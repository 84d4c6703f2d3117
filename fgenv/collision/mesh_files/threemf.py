"""3MF packages: the items of the build, in the unit of the model."""

from __future__ import annotations

from .content import FileMesh, MeshSource, Unit
from .scene_parts import SceneParts
from .threemf_objects import place_object, pose_of
from .threemf_package import ModelPart, ThreemfPackage

UNITS = {
    "micron": 1e-6,
    "millimeter": 1e-3,
    "centimeter": 1e-2,
    "inch": 0.0254,
    "foot": 0.3048,
    "meter": 1.0,
}


def read_threemf(source: MeshSource) -> FileMesh:
    """Read the build of a 3MF file: triangles, placed by items and components.

    Objects for support and unused objects are noted. The production extension is read.

    Raises:
        ValueError: damaged content, a cycle of components, a required extension that changes
            the geometry (beam lattices, slices, volumes, booleans), or encrypted content.
    """
    with ThreemfPackage(source) as package:
        root = package.root()
        unit = _unit(root)
        parts = SceneParts(source)
        build = root.element.first("build")
        items = build.all("item") if build else []
        if not items:
            root.fail(root.element, "a build without items", "objects to build; export it again")
        for item in items:
            place_object(package, package.target(root, item), pose_of(root, item), parts)
        unused = package.unused_objects()
        if package.has_slicer_settings():
            parts.note("Settings of a slicer are not read: its modifiers count as solid parts.")
    if unused:
        parts.note(f"{unused} objects are not in the build, and are skipped.")
    vertices, faces = parts.joined()
    return FileMesh("3MF", vertices, faces, unit, notes=tuple(parts.notes))


def _unit(root: ModelPart) -> Unit:
    name = root.element.get("unit", "millimeter")
    if name not in UNITS:
        expected = f"one of {', '.join(UNITS)}"
        root.fail(root.element, f"the unit {name[:20]!r}", expected)
    return Unit(name, UNITS[name])
