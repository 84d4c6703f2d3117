"""A union of boxes as one shape: cells of maps, voxels of points, leaves of octrees."""

from __future__ import annotations

import warnings
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from fgenv.collision import MeshWarning, Shape

from .base import LONGEST, Solid, quantity

MAX_BOXES = 1_000_000
CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=bool)
FACES = np.array([
    [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
    [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
])  # fmt: skip
Edge = Annotated[float, quantity("m", "Coordinate", ge=-LONGEST, le=LONGEST)]


class Boxes(Solid):
    """Boxes along the axes, as one shape; they may touch and overlap."""

    kind: Literal["boxes"]
    boxes: tuple[tuple[Edge, Edge, Edge, Edge, Edge, Edge], ...] = Field(
        min_length=1,
        max_length=MAX_BOXES,
        description="Lower x, y, z and upper x, y, z of each (m)",
    )

    def mesh(self) -> Any:
        boxes = np.array(self.boxes)
        low, high = boxes[:, None, :3], boxes[:, None, 3:]
        if not (low < high).all():
            i = int(np.argmin((low < high).all(axis=(1, 2))))
            raise ValueError(f"boxes: got {boxes[i].tolist()} at {i}, expected lower below upper")
        vertices = np.where(CORNERS, high, low).reshape(-1, 3)
        faces = (FACES + 8 * np.arange(len(boxes))[:, None, None]).reshape(-1, 3)
        with warnings.catch_warnings():  # adjoining boxes share corners and faces, which are merged
            warnings.simplefilter("ignore", MeshWarning)
            return Shape(vertices, faces, name=self.kind)


def merged_boxes(boxes: NDArray[np.int64]) -> NDArray[np.int64]:
    """Boxes with the same union, joined along x, then y, then z where their other sides agree.

    Args:
        boxes: (n, 2 d), lower then upper corners on an integer grid; disjoint.

    Returns:
        (m, 2 d), disjoint, in a fixed order.
    """
    dimension = boxes.shape[1] // 2
    if len(boxes) == 0:
        return boxes
    for axis in range(dimension):
        others = [k for k in range(2 * dimension) if k % dimension != axis]
        order = np.lexsort([boxes[:, axis], *(boxes[:, k] for k in others)])
        boxes = boxes[order]
        same = (boxes[1:, others] == boxes[:-1, others]).all(axis=1)
        same &= boxes[1:, axis] == boxes[:-1, axis + dimension]
        first = np.flatnonzero(np.concatenate([[True], ~same]))
        last = np.append(first[1:], len(boxes)) - 1
        upper = boxes[last, axis + dimension]
        boxes = boxes[first]
        boxes[:, axis + dimension] = upper
    return boxes


def boxes_of_cells(cells: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Boxes whose union is the set of true cells of an array of d dimensions, (m, 2 d)."""
    low = np.argwhere(cells).astype(np.int64)
    return merged_boxes(np.concatenate([low, low + 1], axis=1))
