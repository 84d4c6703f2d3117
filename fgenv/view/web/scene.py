"""A scenario in a viser scene: static bodies, robots, their goals, the floor."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fgenv.arrays import Floats
from fgenv.scenarios import Built
from fgenv.view.figures.camera import Camera, overview
from fgenv.view.figures.palette import INK, Color, robot_color, static_color
from fgenv.view.figures.scenario_picture import GOAL_OPACITY, LIFT, body_opacity, world_corners
from fgenv.view.robot_poses import part_poses

from .meshes import mesh_of, mesh_rgb, quaternions, rgb

if TYPE_CHECKING:
    from viser import BatchedMeshHandle, SceneApi

    from fgenv.collision import Shape

BAR_GAP = 0.5  # meters from the scale bar to the scene


class BatchedMesh:
    """Bodies of one shape: one mesh, and a pose and a color per body."""

    def __init__(
        self, scene: SceneApi, name: str, shape: Shape, colors: list[Color], opacity: float = 1.0
    ) -> None:
        n, (vertices, faces) = len(colors), mesh_of(shape)
        self._scales = np.ones(n, dtype=np.float32)
        self.handle: BatchedMeshHandle = scene.add_batched_meshes_simple(
            name,
            vertices,
            faces,
            batched_wxyzs=np.tile((1.0, 0.0, 0.0, 0.0), (n, 1)),
            batched_positions=np.zeros((n, 3)),
            batched_scales=self._scales,
            batched_colors=mesh_rgb(colors),
            lod="off",
            opacity=None if opacity == 1.0 else opacity,
            side="front" if shape.watertight else "double",
            cast_shadow=opacity == 1.0,
            receive_shadow=opacity == 1.0,
        )

    def move(self, poses: Floats, present: Sequence[bool] | None = None) -> None:
        """Move the bodies to poses (n, 4, 4); absent bodies are hidden."""
        self.handle.batched_positions = poses[:, :3, 3].astype(np.float32)
        self.handle.batched_wxyzs = quaternions(poses)
        shown = np.ones(len(poses)) if present is None else np.array(present)
        scales = shown.astype(np.float32)
        if not np.array_equal(scales, self._scales):
            self.handle.batched_scales = self._scales = scales

    def recolor(self, colors: Sequence[Color]) -> None:
        """Change the colors, (n,)."""
        self.handle.batched_colors = mesh_rgb(colors)


class RobotMeshes:
    """All robots of a scenario: a batched mesh per shape, over all robots that have it."""

    def __init__(self, scene: SceneApi, name: str, built: Built, opacity: float = 1.0) -> None:
        self.robots = built.robots
        parts = [(i, part.shape) for i, robot in enumerate(self.robots) for part in robot.parts]
        self.owners = np.array([i for i, _ in parts], dtype=int)
        shapes = list({id(shape): shape for _, shape in parts}.values())
        self._indices = [
            np.array([k for k, (_, s) in enumerate(parts) if s is shape]) for shape in shapes
        ]
        self.meshes = [
            BatchedMesh(scene, f"{name}/{k}", s, [robot_color(i) for i in self.owners[at]], opacity)
            for k, (s, at) in enumerate(zip(shapes, self._indices, strict=True))
        ]

    def poses(self, configurations: Sequence[Floats]) -> Floats:
        """Return the poses of all parts, (parts, 4, 4), robot by robot."""
        robots = zip(self.robots, configurations, strict=True)
        return np.reshape(
            [pose for robot, q in robots for pose in part_poses(robot, q)], (-1, 4, 4)
        )

    def move(self, poses: Floats, present: Sequence[bool] | None = None) -> None:
        """Move all parts to poses (parts, 4, 4); absent robots are hidden."""
        n = len(poses)
        shown = np.ones(n, dtype=bool) if present is None else np.asarray(present)[self.owners]
        for mesh, at in zip(self.meshes, self._indices, strict=True):
            mesh.move(poses[at], shown[at].tolist())


class ScenarioScene:
    """A whole scenario in a viser scene.

    Args:
        corners: (n, 3), meters, of more that the camera has to see.

    Attributes:
        robots, goals: meshes that can be moved.
        camera: an overview of everything.
        low, high: corners (3,) of the scene's box, meters.
    """

    def __init__(self, scene: SceneApi, built: Built, corners: Floats | None = None) -> None:
        self.scene, self.built = scene, built
        ends = [world_corners(built.world(q)) for q in (built.starts, built.goals)]
        points = np.concatenate([*ends, *([] if corners is None else [corners])])
        self.low, self.high = points.min(axis=0), points.max(axis=0)
        self.floor = min(0.0, float(self.low[2]))
        self.camera: Camera = overview(points, 640, 640)  # fits any window but a high one
        self._add_floor()
        self._add_scale_bar()
        self._add_static_bodies()
        self.goals = RobotMeshes(scene, "/goals", built, GOAL_OPACITY)
        self.robots = RobotMeshes(scene, "/robots", built)
        self.robots.move(self.robots.poses(built.starts))
        self.set_goals(built.goals)

    def set_goals(self, goals: Sequence[Floats]) -> None:
        """Move the goals to configurations (nq,), lifted a little: coplanar faces flicker."""
        poses = self.goals.poses(goals)
        poses[:, 2, 3] += LIFT
        self.goals.move(poses)

    def move_static(self, poses: Floats) -> None:
        """Move the static bodies to poses (m, 4, 4)."""
        for mesh, at in self._static:
            mesh.move(poses[at])

    def recolor_static(self, colors: Sequence[Color]) -> None:
        """Change the colors of the static bodies, one for each."""
        for mesh, at in self._static:
            mesh.recolor([colors[i] for i in at])

    def _add_static_bodies(self) -> None:
        built = self.built
        batches: dict[tuple[int, float], list[int]] = {}
        for i, (shape, groups) in enumerate(zip(built.shapes, built.body_groups, strict=True)):
            batches.setdefault((id(shape), body_opacity(groups)), []).append(i)
        self._static = []
        for k, ((_, opacity), at) in enumerate(batches.items()):
            shape = built.shapes[at[0]]
            colors = [static_color(shape.name)] * len(at)
            mesh = BatchedMesh(self.scene, f"/bodies/{k}", shape, colors, opacity)
            self._static.append((mesh, at))
        self.move_static(built.poses)

    def _add_floor(self) -> None:
        """Add a floor with a line per meter, under viser's default light.

        The player of a replay resets the light at each start, so any other light would flash.
        """
        far = 3.0 * float(np.linalg.norm(np.subtract(self.camera.eye, self.camera.target)))
        self.scene.set_up_direction("+z")
        self.scene.add_grid(
            "/floor",
            infinite_grid=True,
            cell_size=1.0,
            section_size=10.0,
            cell_color=(205, 207, 209),
            section_color=(185, 188, 191),
            fade_distance=far,
            plane_color=(236, 236, 234),
            plane_opacity=1.0,
            shadow_opacity=0.3,
            position=(0.0, 0.0, self.floor - LIFT / 4),
        )

    def _add_scale_bar(self) -> None:
        x, y = float(self.low[0]), float(self.low[1]) - BAR_GAP
        ends = [[[x, y, self.floor + LIFT], [x + 1.0, y, self.floor + LIFT]]]
        width = min(0.03, 0.004 * float(np.linalg.norm(self.high - self.low)))
        self.scene.add_line_segments("/scale", np.array(ends), rgb(INK), thickness=width)
        self.scene.add_label(
            "/scale/label", "1 m", position=(x + 0.5, y, self.floor + 0.05), anchor="top-center"
        )
