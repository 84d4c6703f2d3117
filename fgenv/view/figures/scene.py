"""Pictures of bodies with their outlines, and cameras for them."""

from collections.abc import Mapping, Sequence

import numpy as np

from fgenv.arrays import Floats
from fgenv.collision import FeatureGraph, Shape
from fgenv.collision.world import BodyRecord
from fgenv.view.figures.camera import FOV, Camera, look_at
from fgenv.view.figures.palette import INK, STEEL, Color
from fgenv.view.figures.picture import Picture
from fgenv.view.figures.surfaces import Floor, Solid

OUTLINE = 0.5  # rad: edges that bend more are drawn as outlines


def transform(points: Floats, pose: Floats) -> Floats:
    """Return points (..., 3) of a body's frame in the world frame."""
    return np.asarray(points @ pose[:3, :3].T + pose[:3, 3])


def sharp_edges(shape: Shape) -> Floats:
    """Return the sharp edges of a shape as segments (n, 2, 3) in its frame."""
    graph = FeatureGraph(shape.vertices, shape.faces, method="crease", angle=OUTLINE)
    return np.asarray(graph.points[graph.edges])


def outlined_picture(
    bodies: Sequence[BodyRecord],
    camera: Camera,
    colors: Mapping[str, Color],
    *,
    extra: Sequence[Solid] = (),
    grid: float = 1.0,
    samples: int = 3,
) -> Picture:
    """Return a picture of bodies at their poses, with outlines.

    Args:
        colors: color by the name of a body; others are steel gray.
        extra: solids without outlines.
        grid: distance of the floor's lines (m).
    """
    solids = [Solid(b.shape, b.pose, colors.get(b.name, STEEL)) for b in bodies]
    picture = Picture(camera, [*solids, *extra], floor=Floor(grid=grid), samples=samples)
    for body in bodies:
        edges = transform(sharp_edges(body.shape), body.pose)
        if len(edges):
            # Edges shorter than a few pixels are drawn paler: they would blacken the body.
            pixels, _ = camera.project(edges)
            typical = np.median(np.linalg.norm(pixels[:, 1] - pixels[:, 0], axis=1))
            picture.segments(edges, INK, width=0.7, opacity=min(1.0, float(typical) / 3))
    return picture


def portrait(body: BodyRecord, width: int, height: int, azimuth: float = -0.85) -> Camera:
    """Return a camera that sees the whole body from `azimuth` (rad) and slightly from above."""
    low, high = body.bounds
    points = transform(body.shape.vertices, body.pose)
    border, frame = 0.06 * height, np.array([width, height])
    for distance in float(np.linalg.norm(high - low)) * np.linspace(1.0, 4.0, 61):
        camera = look_at((low + high) / 2, distance, azimuth, 0.42, FOV, width, height)
        pixels, depth = camera.project(points)
        if (depth > 0).all() and (pixels > border).all() and (pixels < frame - border).all():
            break
    return camera


def close_up(
    point: Floats,
    normal: Floats,
    solids: Sequence[Solid],
    distance: float,
    width: int,
    height: int,
) -> Camera:
    """Return a camera that sees a contact at a point (3,) from the side, hidden least.

    `normal` (3,) points away from the second body; the camera stays on that side.
    """
    views = [(a, e) for e in (0.3, 0.6, 0.15) for a in np.linspace(-np.pi, np.pi, 24, False)]
    cameras = [look_at(point, distance, a, e, FOV, width, height) for a, e in views]
    lean = np.array([-camera.axes[2] @ normal for camera in cameras])
    visible = np.array([_visible_share(point, camera, solids) for camera in cameras])
    score = 10 * visible - np.abs(lean - 0.3) - 100 * (lean < 0)
    return cameras[int(np.argmax(score))]


def _visible_share(point: Floats, camera: Camera, solids: Sequence[Solid]) -> float:
    """Return the share (0 to 1) of a small bundle of rays from the eye that reach the point."""
    eye = np.array(camera.eye)
    length = float(np.linalg.norm(point - eye))
    around = np.array([(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1), (2, 0), (-2, 0), (0, 2), (0, -2)])
    toward = point + around @ camera.axes[:2] * (0.02 * length) - eye
    rays = toward / np.linalg.norm(toward, axis=1, keepdims=True)
    blocked = np.zeros(len(rays), dtype=bool)
    for solid in solids:
        blocked |= solid.shape.raycast(eye, rays, solid.pose)[0] < 0.95 * length
    return 1.0 - float(blocked.mean())
