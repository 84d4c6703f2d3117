# Types that stubgen cannot know: the bindings take and give arrays as plain objects. A query gives
# one value for one pair of poses and an array for many: Any, as is usual in such a case.

fgenv._core.__prefix__:
    \from typing import Any
    \from numpy import bool_, float64, int32, uint8
    \from numpy.typing import ArrayLike, NDArray

fgenv._core.(FeatureGraph|Shape).__init__$:
    def __init__(self, vertices: ArrayLike, faces: ArrayLike, method: str, valley: float, ridge: float, tolerance: float) -> None: ...

fgenv._core.(FeatureGraph.|Shape.)(points|vertices|bounds|flat_faces)$:
    @property
    def \2(self) -> NDArray[float64]: ...

fgenv._core.(FeatureGraph.|Shape.)(edges|faces)$:
    @property
    def \2(self) -> NDArray[int32]: ...

fgenv._core.FeatureGraph.(kind_codes|adjacency)$:
    @property
    def \1(self) -> NDArray[uint8]: ...

fgenv._core.Shape.repairs$:
    @property
    def repairs(self) -> dict[str, int]: ...

fgenv._core.collide$:
    def collide(a: Shape, Ta: ArrayLike, b: Shape, Tb: ArrayLike, margin: float = 0.0, threads: int | None = None) -> Any:
        \doc

fgenv._core.distance$:
    def distance(a: Shape, Ta: ArrayLike, b: Shape, Tb: ArrayLike, threads: int | None = None) -> Any:
        \doc

fgenv._core.nearest$:
    def nearest(a: Shape, Ta: ArrayLike, b: Shape, Tb: ArrayLike, threads: int | None = None) -> tuple[NDArray[float64], NDArray[float64], NDArray[float64], NDArray[float64]]:
        \doc

fgenv._core.contact$:
    def contact(a: Shape, Ta: ArrayLike, b: Shape, Tb: ArrayLike) -> Any:
        \doc

fgenv._core.contains$:
    def contains(shape: Shape, points: ArrayLike, T: ArrayLike, threads: int | None = None) -> NDArray[bool_]:
        \doc

fgenv._core.raycast$:
    def raycast(shape: Shape, origins: ArrayLike, directions: ArrayLike, T: ArrayLike, max_distance: float, threads: int | None = None) -> tuple[NDArray[float64], NDArray[int32]]:
        \doc
