"""Shapes of links from the geometry of SDF models."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NamedTuple

from fgenv.collision import Shape
from fgenv.collision.mesh_files.xml_tree import Element

from . import primitives
from .documents import fail
from .links_joints import LinkShape
from .mesh_shapes import MeshShapes
from .sdf_document import SdfDocument
from .sdf_frames import Frames, inverse

SIZES = {
    "box": ("size",),
    "capsule": ("radius", "length"),
    "cylinder": ("radius", "length"),
    "ellipsoid": ("radii",),
    "sphere": ("radius",),
}
GEOMETRIES = tuple(sorted([*SIZES, "mesh"]))
ALL_BITS = 0xFFFF  # collide_bitmask by default


class SdfShapes(NamedTuple):
    """Shapes of a link, and for each the bits with which it collides."""

    shapes: list[LinkShape]
    masks: list[int]


@dataclass
class SdfGeometry:
    """Geometry of a model.

    Attributes:
        collision: use <collision>; False: <visual>.
        error: meters, of round shapes.
        options: of Shape.
    """

    document: SdfDocument
    frames: Frames
    meshes: MeshShapes
    collision: bool
    error: float
    options: dict[str, Any]
    solids: dict[tuple[Any, ...], tuple[Shape, float]] = field(default_factory=dict)

    def of(self, link: Element) -> SdfShapes:
        """Shapes of a link.

        Raises:
            FileNotFoundError: a mesh file does not exist.
            ValueError: invalid geometry, with file and line.
        """
        name, found = self.document.named(link), SdfShapes([], [])
        to_link = inverse(self.frames.pose(name, link))
        for item in link.all("collision" if self.collision else "visual"):
            self.document.check(item)
            geometry = item.first("geometry")
            inside = [] if geometry is None else geometry.children
            mask = self._mask(item)
            if not mask or (len(inside) == 1 and inside[0].tag == "empty"):
                continue
            if len(inside) != 1 or inside[0].tag not in GEOMETRIES:
                got = ", ".join(f"<{child.tag}>" for child in inside) or "nothing"
                expected = f"one of {', '.join(GEOMETRIES)}"
                fail(self.document.path, item, f"geometry of {link}: got {got}", expected)
            shape, excess = self._shape(inside[0], f"{self.document.path}: link {name!r}")
            base, pose = self.frames.relative(item, name)
            if base != name:
                pose = to_link @ self.frames.placed(item, name)
            found.shapes.append(LinkShape(shape, pose, excess))
            found.masks.append(mask)
        return found

    def _mask(self, item: Element) -> int:
        """Bits with which a collision collides; all for a visual."""
        surface = item.first("surface")
        contact = None if surface is None else surface.first("contact")
        bits = None if contact is None else contact.first("collide_bitmask")
        if bits is None:
            return ALL_BITS
        try:
            return int(bits.text.strip(), 0) & ALL_BITS
        except ValueError:
            return fail(self.document.path, bits, f"got {bits.text[:20]!r}", "an integer")

    def _shape(self, form: Element, label: str) -> tuple[Shape, float]:
        if form.tag == "mesh":
            return self._mesh(form, label), 0.0
        sizes = tuple(x for tag in SIZES[form.tag] for x in self._lengths(form, tag))
        key = (form.tag, *sizes)
        if key not in self.solids:
            try:
                self.solids[key] = self._solid(form.tag, sizes)
            except ValueError as error:
                raise ValueError(f"{label}: line {form.line}: {error}") from None
        return self.solids[key]

    def _solid(self, kind: str, sizes: tuple[float, ...]) -> tuple[Shape, float]:
        if kind == "box":
            return primitives.box(sizes, **self.options), 0.0
        if kind == "ellipsoid":
            return primitives.ellipsoid(sizes, self.error, **self.options)
        if kind == "sphere":
            return primitives.sphere(sizes[0], self.error, **self.options)
        make = primitives.capsule if kind == "capsule" else primitives.cylinder
        return make(sizes[0], sizes[1], self.error, **self.options)

    def _lengths(self, form: Element, tag: str) -> list[float]:
        count = 1 if tag in ("radius", "length") else 3
        values = self.document.numbers(form, self.document.text(form, tag), (count,))
        return [self.meshes.scale * x for x in values]

    def _mesh(self, form: Element, label: str) -> Shape:
        self.document.check(form)
        if form.get("optimization"):
            self.document.note("Meshes are used as they are, without convex hulls.")
        scale = form.first("scale")
        factors = [1.0, 1.0, 1.0]
        if scale is not None:
            factors = self.document.numbers(scale, scale.text, (3,))
        uri = self.document.text(form, "uri")
        return self.meshes.shape(uri, (factors[0], factors[1], factors[2]), label)
