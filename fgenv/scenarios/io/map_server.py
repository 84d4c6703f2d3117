"""Maps of ROS map_server and nav2: a YAML file and an image, as walls."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from fgenv import _core
from fgenv.scenarios.errors import Problem, ScenarioError, near, short
from fgenv.scenarios.registry import Meters, file_format
from fgenv.scenarios.scenario import Scenario
from fgenv.scenarios.shapes.boxes import boxes_of_cells

from .grids import MAX_CELLS, fail, read_bytes, scenario_of_boxes
from .yaml_node import Node

REQUIRED = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh")
FORMATS = ("PPM", "PNG", "BMP", "GIF", "JPEG")  # PPM includes PGM; others may run programs
MODES = ("trinary", "scale", "raw")
FREE, OCCUPIED, UNKNOWN = 0, 1, 2


@file_format("map_server map", keys=("image", "resolution", "occupied_thresh", "free_thresh"))
def map_server(
    path: Path, height: Meters = 1.0, unknown: Literal["occupied", "free"] = "occupied"
) -> Scenario:
    """Walls of a map: the occupied cells, and the unknown ones unless `unknown` is free.

    A cell is occupied above occupied_thresh, free below free_thresh, and otherwise unknown, as are
    cells of transparent pixels and cells of `raw` maps above 100. Space outside the map is free.
    The walls stand on z = 0; the origin's yaw turns the map about its lower left corner.

    Args:
        height: of the walls (m).
        unknown: whether unknown cells are walls.

    Raises:
        ScenarioError: unknown or missing keys, invalid values, or an image that cannot be read.
    """
    top = Node.read(path)
    check_keys(top)
    resolution = positive(top.get("resolution"), 1e4)
    x, y, yaw = top.get("origin").numbers(("x", "y", "yaw"))
    cells = states(top)[::-1].T  # by x, then y: the first row of the image is the top
    walls = (cells == OCCUPIED) | ((cells == UNKNOWN) & (unknown == "occupied"))
    flat = boxes_of_cells(walls).astype(np.float64) * resolution
    zeros = np.zeros(len(flat))
    boxes = np.column_stack([flat[:, :2], zeros, flat[:, 2:], zeros + height])
    size = resolution * cells.shape[0], resolution * cells.shape[1]
    (sine, cosine) = (float(v) for v in _core.sin_cos(yaw))
    corners = np.array([[u * cosine - v * sine + x, u * sine + v * cosine + y]
                        for u in (0.0, size[0]) for v in (0.0, size[1])])  # fmt: skip
    return scenario_of_boxes(
        path,
        boxes,
        "walls",
        description=f"Map of {cells.shape[0]} x {cells.shape[1]} cells of {resolution:g} m.",
        workspace=(corners.min(axis=0).tolist(), corners.max(axis=0).tolist()),
        position=(x, y, 0.0),
        rpy=(0.0, 0.0, yaw),
    )


def check_keys(top: Node) -> None:
    """Raise a ScenarioError for unknown and missing keys."""
    if not isinstance(top.value, dict):
        top.fail(f"is {short(top.value)}", f"expected a table with {', '.join(REQUIRED)}")
    known = (*REQUIRED, "mode")
    problems = [
        top.child(key, value).problem("is no known key", near(key, known))
        for key, value in top.value.items()
        if key not in known
    ]
    problems += [
        Problem("is missing", "add it", key, 1) for key in REQUIRED if top.find(key) is None
    ]
    if problems:
        raise ScenarioError(top.path, problems)


def positive(node: Node, most: float) -> float:
    """A number over 0."""
    value = node.number()
    if not 0.0 < value <= most:
        node.fail(f"is {value:g}", f"expected a number over 0, up to {most:g}")
    return value


def states(top: Node) -> NDArray[np.int8]:
    """FREE, OCCUPIED or UNKNOWN for each pixel, (rows, columns) from the top."""
    free, occupied = (top.get(key).number() for key in ("free_thresh", "occupied_thresh"))
    if not 0.0 <= free <= occupied <= 1.0:
        text = f"is {free:g}, with occupied_thresh {occupied:g}"
        top.get("free_thresh").fail(text, "expected 0 <= free_thresh <= occupied_thresh <= 1")
    negate = top.get("negate")
    if negate.value not in (0, 1):
        negate.fail(f"is {short(negate.value)}", "expected 0 or 1")
    place = top.find("mode")
    mode = "trinary" if place is None else place.value
    if place is not None and mode not in MODES:
        place.fail(f"is {short(mode)}", near(mode, MODES))
    color, opaque = pixels(top)
    if mode == "raw":
        shade = (1.0 - color if negate.value else color) * 255.0
        share = np.rint(shade) / 100.0
        opaque = opaque & (share <= 1.0)
    else:
        share = color if negate.value else 1.0 - color
    result = np.full(color.shape, UNKNOWN, dtype=np.int8)
    result[share < free] = FREE
    result[share > occupied] = OCCUPIED
    result[~opaque] = UNKNOWN
    return result


def pixels(top: Node) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Mean of the color channels of each pixel, 0 to 1, and whether it is opaque."""
    from PIL import Image, UnidentifiedImageError

    place = top.get("image")
    file = Path(top.path).parent / place.text()
    if not file.is_file():
        place.fail(f"{short(place.value)} does not exist", "put it beside the YAML file")
    try:
        with Image.open(io.BytesIO(read_bytes(file)), formats=FORMATS) as image:
            if image.width * image.height > MAX_CELLS:
                fail(file, f"has {image.width} x {image.height} cells", f"at most {MAX_CELLS}")
            return channels(image, place)
    except ScenarioError:
        raise
    except UnidentifiedImageError:
        place.fail(f"{short(place.value)} is no image", f"expected one of {', '.join(FORMATS)}")
    except Exception as error:  # Pillow raises any exception for a damaged file
        text = f"{short(place.value)} cannot be read: {short(str(error))}"
        place.fail(text, "expected a complete file")


def channels(image: object, place: Node) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """See `pixels`."""
    from PIL import Image

    assert isinstance(image, Image.Image)
    if image.mode in ("P", "PA") or "transparency" in image.info:
        image = image.convert("RGBA")
    bands = image.getbands()
    deep = image.mode.startswith("I")
    if not deep and image.mode not in ("1", "L", "LA", "RGB", "RGBA"):
        place.fail(f"has pixels of mode {image.mode}", "expected gray or RGB pixels")
    data = np.asarray(image, dtype=np.float64)
    if image.mode != "1":
        data = data / (65535.0 if deep else 255.0)
    data = data.reshape(image.height, image.width, -1)
    opaque = data[:, :, -1] >= 1.0 if bands[-1] == "A" else np.ones(data.shape[:2], dtype=bool)
    colors = data[:, :, :-1] if bands[-1] == "A" else data
    return np.asarray(np.clip(colors.sum(axis=2) / colors.shape[2], 0.0, 1.0)), opaque
