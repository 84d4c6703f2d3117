"""Shapes of ROS messages: shape_msgs/SolidPrimitive, Mesh and Plane as forms of the schema."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from fgenv.arrays import Floats
from fgenv.scenarios.shapes.bodies import AnyForm

from .yaml_node import Node, Numbers

BOX, SPHERE, CYLINDER, CONE, PRISM = "box", "sphere", "cylinder", "cone", "prism"
NUMBERED = {1: BOX, 2: SPHERE, 3: CYLINDER, 4: CONE, 5: PRISM}  # of shape_msgs/SolidPrimitive
SIZES = {  # the order of `dimensions`
    BOX: ("x", "y", "z"),
    SPHERE: ("radius",),
    CYLINDER: ("height", "radius"),
    CONE: ("height", "radius"),
}
PLANE_EXTENT = 2000.0  # m, edge of the square that stands for an infinite plane
PLANE_THICKNESS = 0.001  # m
FORMS: TypeAdapter[AnyForm] = TypeAdapter(AnyForm)


def primitive(part: Node) -> AnyForm:
    """The form of a shape_msgs/SolidPrimitive."""
    value = part.get("type").value
    kind = NUMBERED.get(value, value) if type(value) is int else str(value).lower()
    if kind == PRISM:
        part.get("type").fail("is a prism, which is not supported", "make a mesh of it")
    if kind not in SIZES:
        part.get("type").fail(f"is {kind!r}", f"expected one of: {', '.join(SIZES)}")
    sizes = part.get("dimensions").numbers(SIZES[kind])
    return solid(part.get("dimensions"), kind, sizes)


def solid(place: Node, kind: str, sizes: Numbers) -> AnyForm:
    """The form of a primitive; sizes are in the order of SIZES."""
    if kind == BOX:
        return formed(place, kind=kind, size=sizes)
    named = dict(zip(SIZES[kind], sizes, strict=True))
    if kind == CYLINDER:
        named["length"] = named.pop("height")
    return formed(place, kind=kind, **named)


def mesh(part: Node) -> AnyForm:
    """The form of a shape_msgs/Mesh."""
    vertices = tuple(v.numbers("xyz") for v in part.get("vertices").items())
    faces = []
    for triangle in part.get("triangles").items():
        inside = triangle.find("vertex_indices") if isinstance(triangle.value, dict) else triangle
        corners = (inside or triangle.get("vertex_indices")).numbers("abc")
        if not all(k == int(k) and 0 <= k < len(vertices) for k in corners):
            triangle.fail(f"is {corners}", f"expected places in {len(vertices)} vertices, from 0")
        faces.append(tuple(map(int, corners)))
    return formed(part, kind="triangles", vertices=vertices, faces=tuple(faces))


def plane(part: Node) -> tuple[AnyForm, Floats]:
    """The form of a shape_msgs/Plane, and its pose (4, 4) in the frame of the plane."""
    return plane_of(part, part.get("coef").numbers("abcd"))


def plane_of(place: Node, coefficients: Numbers) -> tuple[AnyForm, Floats]:
    """A thin box for the plane a x + b y + c z + d = 0, centered where it is nearest to the origin.

    It encloses the plane within PLANE_EXTENT / 2 of that point along both of the box's edges.
    """
    normal, d = np.array(coefficients[:3]), coefficients[3]
    length = float(np.sqrt(normal @ normal))
    if length < 1e-9:
        place.fail("has a normal of length 0", "expected a, b, c, d of a x + b y + c z + d = 0")
    z = normal / length
    helper = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = np.array([helper[1] * z[2] - helper[2] * z[1], helper[2] * z[0] - helper[0] * z[2],
                  helper[0] * z[1] - helper[1] * z[0]])  # fmt: skip
    x /= math.sqrt(float(x @ x))
    y = np.array([z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]])
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1], pose[:3, 2], pose[:3, 3] = x, y, z, -d / length * z
    size = (PLANE_EXTENT, PLANE_EXTENT, PLANE_THICKNESS)
    return formed(place, kind=BOX, size=size), pose


def formed(part: Node, **sizes: Any) -> AnyForm:
    """A form of the schema; sizes that make no sense are errors of the file."""
    try:
        return FORMS.validate_python(sizes)
    except ValidationError as error:
        part.fail(f"cannot be a {sizes['kind']}", error.errors()[0]["msg"])
