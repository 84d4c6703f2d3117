"""The picture of a mesh: its surface with the outlines of its sharp edges."""

from __future__ import annotations

import warnings

from PIL import Image

from fgenv.collision import MeshWarning, Shape, World
from fgenv.view.figures.quantize import quantize
from fgenv.view.figures.scene import outlined_picture, portrait

GRID = 0.25  # distance of the floor's lines, in largest extents of the mesh


def draw_mesh(shape: Shape, width: int = 640, height: int = 480) -> Image.Image:
    """Return the picture of a shape on a floor, z up.

    It is drawn with a largest extent of 1, so that the picture does not depend on the unit.
    """
    low, high = shape.bounds
    size = float((high - low).max()) or 1.0
    middle = [*(low + high)[:2] / 2, low[2]]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MeshWarning)  # reported when the shape was made
        drawn = Shape((shape.vertices - middle) / size, shape.faces)
    world = World()
    body = world.record(world.add(drawn))
    picture = outlined_picture([body], portrait(body, width, height), {}, grid=GRID)
    return quantize(picture.image())
