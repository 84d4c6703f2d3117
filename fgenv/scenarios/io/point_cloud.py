"""Point clouds as a body: the voxels that a ball around some point touches."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from fgenv.scenarios.registry import Meters, file_format
from fgenv.scenarios.scenario import Scenario
from fgenv.scenarios.shapes.base import LONGEST
from fgenv.scenarios.shapes.boxes import merged_boxes

from .grids import fail, scenario_of_boxes
from .point_files import Points, read_points

MAX_VOXELS = 20_000_000
Radius = Annotated[float, Field(ge=0, le=1000, strict=True, allow_inf_nan=False)]
Factor = Annotated[float, Field(gt=0, le=1e6, strict=True, allow_inf_nan=False)]


@file_format("point cloud", ".pcd", ".ply")
def point_cloud(
    path: Path, voxel: Meters = 0.05, radius: Radius = 0.0, scale: Factor = 1.0
) -> Scenario:
    """The voxels of a point cloud, as one body that encloses a cube around each point.

    Points without a return (NaN) are left out. Space without points is free, also where the sensor
    did not see it. The viewpoint of a PCD file is not applied.

    Args:
        voxel: edge of the voxels, whose grid begins at the origin (m).
        radius: half the edge of the cube around each point, which holds the ball of that radius
            (m); at least half the distance of neighboring points closes the surface.
        scale: factor of the file to meters.

    Raises:
        ScenarioError: another format, a truncated file, or too many voxels.
    """
    points = read_points(path) * scale
    if len(points) and float(np.abs(points).max()) + radius + voxel > LONGEST:
        fail(path, f"has points farther than {LONGEST:g} m", "give scale=, or crop the cloud")
    cells = voxels_of(path, points, voxel, radius)
    boxes = merged_boxes(np.concatenate([cells, cells + 1], axis=1)) * voxel
    about = f"{len(points)} points in {len(cells)} voxels of {voxel:g} m."
    return scenario_of_boxes(path, boxes, "points", description=about)


def voxels_of(path: Path, points: Points, voxel: float, radius: float) -> NDArray[np.int64]:
    """Indices (m, 3) of the voxels that meet a cube of half an edge `radius` around a point."""
    # The rounding of i * voxel may not leave a point outside.
    room = radius + 1e-12 * (float(np.abs(points).max()) if len(points) else 0.0)
    low = np.floor((points - room) / voxel).astype(np.int64)
    high = np.floor((points + room) / voxel).astype(np.int64)
    if len(low) == 0:
        return low
    spans = high - low + 1
    if int(spans.prod(axis=1).sum()) > MAX_VOXELS:
        fail(path, f"makes over {MAX_VOXELS} voxels", "use a larger voxel, or a smaller radius")
    found = []
    for offset in np.ndindex(*spans.max(axis=0)):
        cells = low + np.array(offset)
        found.append(unique_cells(cells[(cells <= high).all(axis=1)]))
    return unique_cells(np.concatenate(found))


def unique_cells(cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """The different rows of indices (n, 3), sorted."""
    if len(cells) == 0:
        return cells
    cells = cells[np.lexsort(cells.T[::-1])]
    first = np.concatenate([[True], (cells[1:] != cells[:-1]).any(axis=1)])
    return np.asarray(cells[first])
