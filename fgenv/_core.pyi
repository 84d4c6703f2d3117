"""
fgenv's native core. Use fgenv.collision, which documents what is here.
"""

from collections.abc import Iterable, Sequence
from typing import Any

from numpy import bool_, float64, int32, int64, uint8
from numpy.typing import ArrayLike, NDArray



def isa() -> str:
    """Name of the instruction set whose kernels are in use."""

class FeatureGraph:
    def __init__(self, vertices: ArrayLike, faces: ArrayLike, method: str, valley: float, ridge: float, tolerance: float) -> None: ...

    @property
    def points(self) -> NDArray[float64]: ...

    @property
    def edges(self) -> NDArray[int32]: ...

    @property
    def kind_codes(self) -> NDArray[uint8]: ...

    @property
    def adjacency(self) -> NDArray[uint8]: ...

    @property
    def certificate(self) -> float: ...

class Shape:
    def __init__(self, vertices: ArrayLike, faces: ArrayLike, method: str, valley: float, ridge: float, tolerance: float) -> None: ...

    @property
    def vertices(self) -> NDArray[float64]: ...

    @property
    def faces(self) -> NDArray[int32]: ...

    @property
    def flat_faces(self) -> NDArray[float64]: ...

    @property
    def bounds(self) -> NDArray[float64]: ...

    @property
    def watertight(self) -> bool: ...

    @property
    def radius(self) -> float: ...

    @property
    def repairs(self) -> dict[str, int]: ...

    @property
    def nbytes(self) -> int: ...

    @property
    def native_graph(self) -> FeatureGraph: ...

def collide(a: Shape, Ta: ArrayLike, b: Shape, Tb: ArrayLike, margin: float = 0.0, threads: int | None = None) -> Any:
    """
    Whether two posed shapes collide.

    Exact for shapes of method `exact`; touching counts, and so does being inside a watertight shape.
    Where either shape's method is `loop`, a's cycle is tested against b's faces, as published.

    Args:
        a, b: shapes.
        Ta, Tb: their poses (..., 4, 4), rigid, metres; leading dimensions broadcast.
        margin: metres; over 0, what is no farther apart than this collides. Distances are exact whatever
            the shapes' methods, and so is this verdict.
        threads: for arrays; None: FGENV_THREADS, else all cores. The result does not depend on it.

    Returns:
        bool for single poses, else a bool array of the broadcast shape.

    Raises:
        TypeError, ValueError: naming the argument, what came and what is wanted.
    """

def distance(a: Shape, Ta: ArrayLike, b: Shape, Tb: ArrayLike, threads: int | None = None) -> Any:
    """
    Distance of two posed shapes in metres; 0 where they collide, containment included.

    Exact whatever the shapes' methods.

    Args:
        a, b, Ta, Tb, threads: as for collide.

    Returns:
        float for single poses, else a float64 array of the broadcast shape.
    """

def nearest(a: Shape, Ta: ArrayLike, b: Shape, Tb: ArrayLike, threads: int | None = None) -> tuple[NDArray[float64], NDArray[float64], NDArray[float64], NDArray[float64]]:
    pass

def contact(a: Shape, Ta: ArrayLike, b: Shape, Tb: ArrayLike) -> Any:
    pass

def contains(shape: Shape, points: ArrayLike, T: ArrayLike, threads: int | None = None) -> NDArray[bool_]:
    pass

def raycast(shape: Shape, origins: ArrayLike, directions: ArrayLike, T: ArrayLike, max_distance: float, threads: int | None = None) -> tuple[NDArray[float64], NDArray[int32]]:
    pass

class World:
    def __init__(self, masks: str) -> None: ...

    def copy_from(self, arg: World, /) -> None: ...

    def add_body(self, shape: Shape, pose: ArrayLike, name: str, groups: str | Iterable[str], id: int) -> int: ...

    def add_robot(self, robot: Robot, q: ArrayLike, parts: list[tuple[str, int, Shape, ArrayLike]], allowed: Sequence[tuple[int, int]], name: str, like: str, groups: str | Iterable[str]) -> int: ...

    def remove(self, body: int | str) -> int: ...

    def set_configuration(self, robot: int | str, q: ArrayLike) -> None: ...

    def configuration(self, robot: int | str) -> NDArray[float64]: ...

    def parts(self, robot: int | str) -> NDArray[int32]: ...

    def set_pose(self, ids: Any, poses: ArrayLike) -> None: ...

    def poses(self, ids: Any) -> NDArray[float64]: ...

    def attach(self, body: int | str, carrier: int | str) -> None: ...

    def detach(self, body: int | str) -> None: ...

    def allow(self, a: int | str, b: int | str, allowed: bool) -> None: ...

    def allow_groups(self, a: str, b: str, allowed: bool) -> None: ...

    def set_trajectory(self, body: int | str, times: ArrayLike | None, poses: ArrayLike | None) -> None: ...

    def set_path(self, robot: int | str, poses: ArrayLike) -> NDArray[int32]: ...

    def clear_path(self, robot: int | str) -> None: ...

    def candidates(self, robot: int | str) -> NDArray[int32]: ...

    def motion_boxes(self, robot: int | str) -> NDArray[float64]: ...

    def mask(self, body: int | str) -> int: ...

    def own_bit(self, robot: int | str) -> int: ...

    def masks(self) -> str: ...

    def tests(self) -> int: ...

    def nbytes(self) -> int: ...

    def __len__(self) -> int: ...

    def collides(self, robot: int | str, poses: ArrayLike, times: ArrayLike | None, margin: float, threads: int | None) -> Any: ...

    def clearance(self, robot: int | str, poses: ArrayLike, times: ArrayLike | None, threads: int | None) -> tuple[NDArray[float64], NDArray[int32]]: ...

    def check_motion(self, robot: int | str, T0: ArrayLike, T1: ArrayLike, margin: float, tolerance: float, mode: str, resolution: float | None, first: bool, t0: float | None, t1: float | None, threads: int | None) -> tuple[Any, Any, Any, Any, Any, Any]: ...

    def check_motions(self, robots: Any, T0: ArrayLike, T1: ArrayLike, margin: float, tolerance: float, t0: float | None, t1: float | None) -> tuple[NDArray[bool_], NDArray[float64], NDArray[float64], NDArray[int32], NDArray[int32], NDArray[int64]]: ...

    def advance(self, robots: Any, to: ArrayLike, margin: float, tolerance: float, t0: float | None, t1: float | None) -> tuple[NDArray[bool_], NDArray[float64], NDArray[float64], NDArray[int32], NDArray[int32], NDArray[int64]]: ...

    def contacts(self, margin: float, threads: int | None) -> NDArray[int32]: ...

    def raycast(self, origins: ArrayLike, directions: ArrayLike, max_distance: float, ignore: Any, threads: int | None) -> tuple[NDArray[float64], NDArray[int32]]: ...

    def state(self) -> dict[str, Any]: ...

    def restore(self, state: dict[str, Any], robots: dict[int, Robot]) -> None: ...

    def record(self, body: int | str) -> dict[str, Any]: ...

    def ids(self) -> NDArray[int32]: ...

    def names(self) -> list[str]: ...

class Robot:
    def __init__(self, kinds: Sequence[int], parents: Sequence[int], origins: ArrayLike, axes: ArrayLike, firsts: Sequence[int], multipliers: Sequence[float], offsets: Sequence[float], names: Sequence[str]) -> None: ...

    def forward(self, q: ArrayLike, threads: int | None) -> NDArray[float64]: ...

    def interpolate(self, q0: ArrayLike, q1: ArrayLike, t: ArrayLike, threads: int | None) -> NDArray[float64]: ...

    def distance(self, q0: ArrayLike, q1: ArrayLike, weights: ArrayLike) -> Any: ...

    def link_motion(self, link: int, q0: ArrayLike, q1: ArrayLike, t: ArrayLike, offset: ArrayLike | None, begin: float, rate: float, threads: int | None) -> tuple[NDArray[float64], NDArray[float64], NDArray[float64], NDArray[float64], NDArray[float64], NDArray[float64]]: ...

def sin_cos(angles: ArrayLike) -> tuple[NDArray[float64], NDArray[float64]]:
    """Sine and cosine, the same bits on every machine."""

def arc_tangent(y: float, x: float) -> float:
    """Angle of the point (x, y), the same bits on every machine."""

class Painter:
    def __init__(self, shapes: Sequence[Shape], maps: Sequence[ArrayLike | None], which: Sequence[int], colors: ArrayLike, sun: ArrayLike, strength: float, ambient: ArrayLike, sky: ArrayLike) -> None: ...

    def paint(self, poses: ArrayLike, eye: ArrayLike, axes: ArrayLike, pixels_per_slope: float, width: int, height: int, floor: ArrayLike | None, marks: ArrayLike, samples: int, contrast: float, threads: int | None) -> NDArray[uint8]: ...
