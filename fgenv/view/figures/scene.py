"""Setting up a picture: bodies with their outlines, cameras that see what matters."""

from collections.abc import Mapping, Sequence

import numpy as np

from fgenv.arrays import Floats
from fgenv.collision import FeatureGraph, Shape
from fgenv.collision.world import BodyRecord
from fgenv.view.figures.camera import Camera
from fgenv.view.figures.palette import INK, STEEL, Color
from fgenv.view.figures.picture import Picture
from fgenv.view.figures.surfaces import Floor, Solid

OUTLINE = 0.5  # rad: edges that bend more are drawn as outlines


def placed(points: Floats, pose: Floats) -> Floats:
    """Points (..., 3) of a body's frame in the world."""
    return np.asarray(points @ pose[:3, :3].T + pose[:3, 3])


def outline(shape: Shape) -> Floats:
    """The sharp edges of a shape as segments (n, 2, 3) in its frame."""
    graph = FeatureGraph(shape.vertices, shape.faces, method="crease", angle=OUTLINE)
    return np.asarray(graph.points[graph.edges])


def stage(
    bodies: Sequence[BodyRecord],
    camera: Camera,
    colors: Mapping[str, Color],
    *,
    extra: Sequence[Solid] = (),
    grid: float = 1.0,
    samples: int = 3,
) -> Picture:
    """A picture of bodies where they stand, with outlines, in the colors of their names."""
    solids = [Solid(b.shape, b.pose, colors.get(b.name, STEEL)) for b in bodies]
    picture = Picture(camera, [*solids, *extra], floor=Floor(grid=grid), samples=samples)
    for body in bodies:
        edges = placed(outline(body.shape), body.pose)
        if len(edges):
            # Where edges are shorter than a few pixels, full ink would blacken the body.
            pixels, _ = camera.project(edges)
            typical = np.median(np.linalg.norm(pixels[:, 1] - pixels[:, 0], axis=1))
            picture.segments(edges, INK, width=0.7, opacity=min(1.0, float(typical) / 3))
    return picture


def portrait(body: BodyRecord, width: int, height: int, azimuth: float = -0.85) -> Camera:
    """A camera that sees the whole body from `azimuth` (rad about z), a little from above."""
    low, high = body.bounds
    points = placed(body.shape.vertices, body.pose)
    border, frame = 0.06 * height, np.array([width, height])
    for distance in float(np.linalg.norm(high - low)) * np.linspace(1.0, 4.0, 61):
        camera = _aimed((low + high) / 2, distance, azimuth, 0.42, 0.5, width, height)
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
    """A camera that sees a contact at a point (3,) from the side, with the least in between.

    `normal` (3,) points away from the second body, on whose outside the camera stays.
    """
    views = [(a, e) for e in (0.3, 0.6, 0.15) for a in np.linspace(-np.pi, np.pi, 24, False)]
    cameras = [_aimed(point, distance, a, e, 0.5, width, height) for a, e in views]
    lean = np.array([-camera.axes[2] @ normal for camera in cameras])
    sight = np.array([_sight(point, camera, solids) for camera in cameras])
    score = 10 * sight - np.abs(lean - 0.3) - 100 * (lean < 0)
    return cameras[int(np.argmax(score))]


def _sight(point: Floats, camera: Camera, solids: Sequence[Solid]) -> float:
    """How much of a small bundle of sight lines from the eye gets to the point, 0 to 1."""
    eye = np.array(camera.eye)
    length = float(np.linalg.norm(point - eye))
    around = np.array([(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1), (2, 0), (-2, 0), (0, 2), (0, -2)])
    toward = point + around @ camera.axes[:2] * (0.02 * length) - eye
    rays = toward / np.linalg.norm(toward, axis=1, keepdims=True)
    blocked = np.zeros(len(rays), dtype=bool)
    for solid in solids:
        blocked |= solid.hits(eye, rays)[0] < 0.95 * length
    return 1.0 - float(blocked.mean())


def _aimed(
    target: Floats,
    distance: float,
    azimuth: float,
    elevation: float,
    fov: float,
    width: int,
    height: int,
) -> Camera:
    flat = np.cos(elevation)
    away = np.array([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)])
    x, y, z = (target + distance * away).tolist()
    tx, ty, tz = target.tolist()
    return Camera((x, y, z), (tx, ty, tz), fov, width, height)
