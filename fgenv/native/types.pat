# Types that stubgen cannot know: the bindings take and give arrays as plain objects. A query gives
# one value for one pair of poses and an array for many: Any, as is usual in such a case.

fgenv._core.__prefix__:
    \from collections.abc import Callable, Iterable, Sequence
    \from typing import Any
    \from numpy import bool_, float32, float64, int32, int64, uint8
    \from numpy.typing import ArrayLike, NDArray

fgenv._core.FeatureGraph.__init__$:
    def __init__(self, vertices: ArrayLike, faces: ArrayLike, method: str, *, valley: float, ridge: float, tolerance: float) -> None: ...

fgenv._core.Shape.__init__$:
    def __init__(self, vertices: ArrayLike, faces: ArrayLike, method: str, *, valley: float, ridge: float, tolerance: float, progress: Callable[[float], None] | None = None) -> None: ...

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

fgenv._core.Shape.feature_counts$:
    @property
    def feature_counts(self) -> tuple[int, int]: ...

fgenv._core.collide$:
    def collide(a: Shape, Ta: ArrayLike, b: Shape, Tb: ArrayLike, *, margin: float = 0.0, threads: int | None = None) -> Any:
        \doc

fgenv._core.distance$:
    def distance(a: Shape, Ta: ArrayLike, b: Shape, Tb: ArrayLike, *, threads: int | None = None) -> Any:
        \doc

fgenv._core.nearest_points$:
    def nearest_points(a: Shape, Ta: ArrayLike, b: Shape, Tb: ArrayLike, *, threads: int | None = None) -> tuple[NDArray[float64], NDArray[float64], NDArray[float64], NDArray[float64]]:
        \doc

fgenv._core.contact_point$:
    def contact_point(a: Shape, Ta: ArrayLike, b: Shape, Tb: ArrayLike) -> Any:
        \doc

fgenv._core.contains$:
    def contains(shape: Shape, points: ArrayLike, T: ArrayLike, *, threads: int | None = None) -> NDArray[bool_]:
        \doc

fgenv._core.raycast$:
    def raycast(shape: Shape, origins: ArrayLike, directions: ArrayLike, T: ArrayLike, *, max_distance: float, threads: int | None = None) -> tuple[NDArray[float64], NDArray[int32]]:
        \doc

fgenv._core.World.add_body$:
    def add_body(self, shape: Shape, pose: ArrayLike, name: str, *, groups: str | Iterable[str], id: int) -> int: ...

fgenv._core.World.remove$:
    def remove(self, body: int | str) -> int: ...

fgenv._core.World.set_pose$:
    def set_pose(self, ids: Any, poses: ArrayLike) -> None: ...

fgenv._core.World.poses$:
    def poses(self, ids: Any) -> NDArray[float64]: ...

fgenv._core.World.attach$:
    def attach(self, body: int | str, carrier: int | str) -> None: ...

fgenv._core.World.detach$:
    def detach(self, body: int | str) -> None: ...

fgenv._core.World.allow$:
    def allow(self, a: int | str, b: int | str, allowed: bool) -> None: ...

fgenv._core.World.state$:
    def state(self) -> dict[str, Any]: ...

fgenv._core.World.restore$:
    def restore(self, state: dict[str, Any], robots: dict[int, Robot]) -> None: ...

fgenv._core.World.add_robot$:
    def add_robot(self, robot: Robot, q: ArrayLike, parts: list[tuple[str, int, Shape, ArrayLike]], *, allowed: Sequence[tuple[int, int]], name: str, default_name: str, groups: str | Iterable[str]) -> int: ...

fgenv._core.World.set_configuration$:
    def set_configuration(self, robot: int | str, q: ArrayLike) -> None: ...

fgenv._core.World.configuration$:
    def configuration(self, robot: int | str) -> NDArray[float64]: ...

fgenv._core.World.parts$:
    def parts(self, robot: int | str) -> NDArray[int32]: ...

fgenv._core.World.labels$:
    def labels(self, ids: Sequence[int]) -> list[tuple[str | None, int, int]]: ...

fgenv._core.World.names$:
    def names(self) -> list[str]: ...

fgenv._core.World.set_trajectory$:
    def set_trajectory(self, body: int | str, times: ArrayLike | None, poses: ArrayLike | None) -> None: ...

fgenv._core.World.set_path$:
    def set_path(self, robot: int | str, poses: ArrayLike) -> NDArray[int32]: ...

fgenv._core.World.clear_path$:
    def clear_path(self, robot: int | str) -> None: ...

fgenv._core.World.candidates$:
    def candidates(self, robot: int | str) -> NDArray[int32]: ...

fgenv._core.World.motion_boxes$:
    def motion_boxes(self, robot: int | str) -> NDArray[float64]: ...

fgenv._core.World.mask$:
    def mask(self, body: int | str) -> int: ...

fgenv._core.World.own_bit$:
    def own_bit(self, robot: int | str) -> int: ...

fgenv._core.World.collides$:
    def collides(self, robot: int | str, poses: ArrayLike, times: ArrayLike | None, *, margin: float, threads: int | None) -> Any: ...

fgenv._core.World.clearance$:
    def clearance(self, robot: int | str, poses: ArrayLike, times: ArrayLike | None, *, threads: int | None) -> tuple[NDArray[float64], NDArray[int32]]: ...

fgenv._core.World.check_motion$:
    def check_motion(self, robot: int | str, start: ArrayLike, end: ArrayLike, *, margin: float, tolerance: float, mode: str, resolution: float | None, first_contact: bool, start_time: float | None, end_time: float | None, threads: int | None) -> tuple[Any, Any, Any, Any, Any, Any]: ...

fgenv._core.World.check_motions$:
    def check_motions(self, robots: Any, start: ArrayLike, end: ArrayLike, *, margin: float, tolerance: float, start_time: float | None, end_time: float | None) -> tuple[NDArray[bool_], NDArray[float64], NDArray[float64], NDArray[int32], NDArray[int32], NDArray[int64]]: ...

fgenv._core.World.advance$:
    def advance(self, robots: Any, end: ArrayLike, *, margin: float, tolerance: float, start_time: float | None, end_time: float | None) -> tuple[NDArray[bool_], NDArray[float64], NDArray[float64], NDArray[int32], NDArray[int32], NDArray[int64]]: ...

fgenv._core.World.contact_pairs$:
    def contact_pairs(self, margin: float, threads: int | None) -> NDArray[int32]: ...

fgenv._core.World.raycast$:
    def raycast(self, origins: ArrayLike, directions: ArrayLike, max_distance: float, *, ignore: Any, threads: int | None) -> tuple[NDArray[float64], NDArray[int32]]: ...

fgenv._core.World.record$:
    def record(self, body: int | str) -> dict[str, Any]: ...

fgenv._core.World.ids$:
    def ids(self) -> NDArray[int32]: ...

fgenv._core.Robot.__init__$:
    def __init__(self, kinds: Sequence[int], parents: Sequence[int], origins: ArrayLike, *, axes: ArrayLike, firsts: Sequence[int], multipliers: Sequence[float], offsets: Sequence[float], names: Sequence[str]) -> None: ...

fgenv._core.Drive.__init__$:
    def __init__(self, kind: str, parameters: Sequence[float], limits: ArrayLike, *, lower: Sequence[float], upper: Sequence[float]) -> None: ...

fgenv._core.Drive.limit$:
    def limit(self, command: ArrayLike, before: ArrayLike, dt: float) -> NDArray[float64]: ...

fgenv._core.Drive.forward$:
    def forward(self, robot: Robot, action: ArrayLike, q: ArrayLike, dt: float) -> NDArray[float64]: ...

fgenv._core.Robot.forward$:
    def forward(self, q: ArrayLike, threads: int | None) -> NDArray[float64]: ...

fgenv._core.Robot.interpolate$:
    def interpolate(self, q0: ArrayLike, q1: ArrayLike, t: ArrayLike, *, threads: int | None) -> NDArray[float64]: ...

fgenv._core.Robot.displacement_bound$:
    def displacement_bound(self, q0: ArrayLike, q1: ArrayLike, weights: ArrayLike) -> Any: ...

fgenv._core.Robot.link_motion$:
    def link_motion(self, link: int, q0: ArrayLike, q1: ArrayLike, *, t: ArrayLike, offset: ArrayLike | None, begin: float, rate: float, threads: int | None) -> tuple[NDArray[float64], NDArray[float64], NDArray[float64], NDArray[float64], NDArray[float64], NDArray[float64]]: ...

fgenv._core.sin_cos$:
    def sin_cos(angles: ArrayLike) -> tuple[NDArray[float64], NDArray[float64]]:
        \doc

fgenv._core.RobotSpec.__init__$:
    def __init__(self, world: World, id: int, drive: Drive, *, starts: ArrayLike, goals: ArrayLike, tolerance: tuple[float, float], radius: float, range: float, position: ArrayLike, directions: ArrayLike) -> None: ...

fgenv._core.Footprint.__init__$:
    def __init__(self, *, disc_centers: ArrayLike, disc_radius: float, extra: float, width: float, turns: bool, workspace: ArrayLike, model: int) -> None: ...

fgenv._core.Simulator.__init__$:
    def __init__(self, world: World, robots: Sequence[RobotSpec], *, settings: dict[str, Any], worlds: int, bodies: Sequence[int], poses: ArrayLike | None, footprints: Sequence[Footprint]) -> None: ...

fgenv._core.Simulator.slices$:
    def slices(self, robot: int) -> list[tuple[str, int, int]]: ...

fgenv._core.Simulator.reset$:
    def reset(self, worlds: ArrayLike | None, seeds: ArrayLike | None, threads: int | None) -> NDArray[float32]: ...

fgenv._core.Simulator.observe$:
    def observe(self, threads: int | None) -> NDArray[float32]: ...

fgenv._core.Simulator.step$:
    def step(self, actions: ArrayLike, threads: int | None) -> tuple[NDArray[float32], NDArray[float64], NDArray[bool_], NDArray[bool_], NDArray[bool_]]: ...

fgenv._core.Simulator.would_collide$:
    def would_collide(self, actions: ArrayLike, threads: int | None) -> NDArray[bool_]: ...

fgenv._core.Simulator.safe_actions$:
    def safe_actions(self, actions: ArrayLike, rest: ArrayLike, threads: int | None) -> NDArray[float64]: ...

fgenv._core.Simulator.path$:
    def path(self, world: int, robot: int) -> NDArray[float64]: ...

fgenv._core.Simulator.place$:
    def place(self, world: int, robot: int, *, start: ArrayLike, goal: ArrayLike) -> None: ...

fgenv._core.Simulator.set_path$:
    def set_path(self, world: int, robot: int, path: ArrayLike) -> None: ...

fgenv._core.Simulator.toward$:
    def toward(self, targets: ArrayLike) -> NDArray[float64]: ...

fgenv._core.Simulator.(configurations|goals|velocities|hit_points|hit_times|remaining|clearances|least_clearances|traveled)$:
    def \1(self) -> NDArray[float64]: ...

fgenv._core.Simulator.(hits|hit_robots|masked)$:
    def \1(self) -> NDArray[int32]: ...

fgenv._core.Simulator.(checks|collisions|arrivals|steps|numbers|seeds|cases)$:
    def \1(self) -> NDArray[int64]: ...

fgenv._core.Simulator.status$:
    def status(self) -> NDArray[uint8]: ...

fgenv._core.Painter.__init__$:
    def __init__(self, shapes: Sequence[Shape], maps: Sequence[ArrayLike | None], which: Sequence[int], *, colors: ArrayLike, opacities: Sequence[float], sun: ArrayLike, strength: float, ambient: ArrayLike, sky: ArrayLike) -> None: ...

fgenv._core.Painter.paint$:
    def paint(self, poses: ArrayLike, *, eye: ArrayLike, axes: ArrayLike, pixels_per_slope: float, width: int, height: int, floor: ArrayLike | None, marks: ArrayLike, samples: int, contrast: float, with_depth: bool, threads: int | None) -> tuple[NDArray[uint8], Any]: ...

fgenv._core.World.motions_collide$:
    def motions_collide(self, a: int | str, start_a: ArrayLike, end_a: ArrayLike, *, b: int | str, start_b: ArrayLike, end_b: ArrayLike, margin: float, tolerance: float, threads: int | None) -> Any: ...

fgenv._core.Checker.__init__$:
    def __init__(self, world: World, robots: Any, sizes: Sequence[int], *, ways: Sequence[int], radii: Sequence[float], reverse: Sequence[bool], margin: float, tolerance: float, resolution: float, regions: Sequence[Sequence[float]]) -> None: ...

fgenv._core.Checker.serve$:
    def serve(self, serialize: Callable[[Any, Any], None]) -> tuple[Callable[[Any], bool], Callable[[Any, Any], bool], Callable[[Any], float]]: ...

fgenv._core.Checker.watch$:
    def watch(self, stop: Callable[[], None] | None, most: int) -> None: ...

fgenv._core.Checker.(valid|clearance)$:
    def \1(self, q: ArrayLike) -> Any: ...

fgenv._core.Checker.free$:
    def free(self, q0: ArrayLike, q1: ArrayLike) -> Any: ...

fgenv._core.Checker.error$:
    def error(self) -> BaseException | None: ...

fgenv._core.legs$:
    def legs(robot: Robot, q0: ArrayLike, q1: ArrayLike, *, way: int, radius: float, reverse: bool) -> NDArray[float64]: ...

fgenv._core.Network.__init__$:
    def __init__(self, layers: Sequence[tuple[ArrayLike, ArrayLike, str]]) -> None: ...

fgenv._core.Network.run$:
    def run(self, rows: ArrayLike, threads: int | None) -> NDArray[float64]: ...

fgenv._core.orca$:
    def orca(discs: ArrayLike, preferred: ArrayLike, speeds: ArrayLike, *, points: ArrayLike, horizon: float, point_horizon: float, dt: float, range: float, threads: int | None) -> NDArray[float64]:
        \doc

fgenv._core.cheapest_path$:
    def cheapest_path(costs: ArrayLike, start: ArrayLike, goal: ArrayLike) -> NDArray[int64]:
        \doc
