"""Exact collision detection between meshes by feature graphs.

    >>> from fgenv.collision import Shape, collide
    >>> a, b = Shape.load("base.stl"), Shape.load("link.stl", scale=0.001)
    >>> collide(a, Ta, b, Tb)          # poses (..., 4, 4), meters, broadcast

Method: Ma Li, Wang Qiang et al., "A collision detection method based on the feature graph of
objects" (feature points, feature graph, masks), made exact: see README, "How it works".
"""

from .feature_graph import FeatureGraph
from .queries import ContactPoint, NearestPoints, collide, contact_point, distance, nearest_points
from .shape import MeshWarning, Shape
from .world import BodyRecord, Clearances, MotionResult, RayHits, World

__all__ = [
    "BodyRecord",
    "Clearances",
    "ContactPoint",
    "FeatureGraph",
    "MeshWarning",
    "MotionResult",
    "NearestPoints",
    "RayHits",
    "Shape",
    "World",
    "collide",
    "contact_point",
    "distance",
    "nearest_points",
]


def __dir__() -> list[str]:
    return __all__
