"""A scenario in a viser scene: what stands, robots that move, their goals, light and floor."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fgenv.arrays import Floats
from fgenv.scenarios import Built
from fgenv.view.figures.camera import Camera, overview
from fgenv.view.figures.gallery import CLEAR, GHOST, GLASS, LIFT, corners_of
from fgenv.view.figures.palette import INK, Color, robot_color, static_color

from .meshes import many_rgb, mesh_of, quaternions, rgb

if TYPE_CHECKING:
    from viser import BatchedMeshHandle, SceneApi

    from fgenv.collision import Shape

EDGE = 0.5  # meters that the scale bar is off what stands


class Flock:
    """Bodies of one shape: one mesh for all, and a pose and a size each."""

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
            batched_colors=many_rgb(colors),
            lod="off",
            opacity=None if opacity == 1.0 else opacity,
            side="front" if shape.watertight else "double",
            cast_shadow=opacity == 1.0,
            receive_shadow=opacity == 1.0,
        )

    def move(self, poses: Floats, here: Sequence[bool] | None = None) -> None:
        """To poses (n, 4, 4); who is not here is not drawn."""
        self.handle.batched_positions = poses[:, :3, 3].astype(np.float32)
        self.handle.batched_wxyzs = quaternions(poses)
        scales = np.ones(len(poses), np.float32) if here is None else np.array(here, np.float32)
        if not np.array_equal(scales, self._scales):
            self.handle.batched_scales = self._scales = scales

    def paint(self, colors: Sequence[Color]) -> None:
        """In other colors, (n,)."""
        self.handle.batched_colors = many_rgb(colors)


class Fleet:
    """All robots of a scenario: a flock for each shape, whichever robots it is of."""

    def __init__(self, scene: SceneApi, name: str, built: Built, opacity: float = 1.0) -> None:
        self.robots = built.robots
        parts = [(i, part.shape) for i, robot in enumerate(self.robots) for part in robot.parts]
        self.owners = np.array([i for i, _ in parts], dtype=int)
        shapes = list({id(shape): shape for _, shape in parts}.values())
        self._places = [
            np.array([k for k, (_, s) in enumerate(parts) if s is shape]) for shape in shapes
        ]
        self.flocks = [
            Flock(scene, f"{name}/{k}", s, [robot_color(i) for i in self.owners[at]], opacity)
            for k, (s, at) in enumerate(zip(shapes, self._places, strict=True))
        ]

    def poses(self, configurations: Sequence[Floats]) -> Floats:
        """Of all parts, (parts, 4, 4), robot by robot."""
        found = []
        for robot, q in zip(self.robots, configurations, strict=True):
            links = robot.forward(q[: robot.nq])
            found += [links[part.link] @ part.origin for part in robot.parts]
        return np.reshape(found, (-1, 4, 4))

    def move(self, poses: Floats, here: Sequence[bool] | None = None) -> None:
        """All parts to poses (parts, 4, 4); `here` says of each robot if it is there."""
        there = np.ones(len(poses), dtype=bool) if here is None else np.asarray(here)[self.owners]
        for flock, at in zip(self.flocks, self._places, strict=True):
            flock.move(poses[at], there[at].tolist())


class Scenery:
    """All of a scenario in a scene.

    Args:
        corners: (n, 3), meters, of more that the camera is to see.

    Attributes:
        robots, goals: fleets that can be moved.
        camera: sees all.
    """

    def __init__(self, scene: SceneApi, built: Built, corners: Floats | None = None) -> None:
        self.scene, self.built = scene, built
        ends = [corners_of(built.world(q)) for q in (built.starts, built.goals)]
        every = np.concatenate([*ends, *([] if corners is None else [corners])])
        self.low, self.high = every.min(axis=0), every.max(axis=0)
        self.floor = min(0.0, float(self.low[2]))
        self.camera: Camera = overview(every, 640, 640)  # in any window but a high one
        self._ground()
        self._stand()
        self.goals = Fleet(scene, "/goals", built, GHOST)
        self.robots = Fleet(scene, "/robots", built)
        self.robots.move(self.robots.poses(built.starts))
        self.aim(built.goals)

    def aim(self, goals: Sequence[Floats]) -> None:
        """Goals to configurations (nq,) each; a little up, else they flicker in what lies there."""
        poses = self.goals.poses(goals)
        poses[:, 2, 3] += LIFT
        self.goals.move(poses)

    def move_standing(self, poses: Floats) -> None:
        """What stands to poses (m, 4, 4)."""
        for flock, at in self._standing:
            flock.move(poses[at])

    def paint_standing(self, colors: Sequence[Color]) -> None:
        """What stands in other colors, one for each body."""
        for flock, at in self._standing:
            flock.paint([colors[i] for i in at])

    def _stand(self) -> None:
        kinds: dict[tuple[int, float], list[int]] = {}
        for i, (shape, groups) in enumerate(
            zip(self.built.shapes, self.built.body_groups, strict=True)
        ):
            kinds.setdefault((id(shape), CLEAR if GLASS in groups else 1.0), []).append(i)
        self._standing = []
        for k, ((_, opacity), at) in enumerate(kinds.items()):
            shape = self.built.shapes[at[0]]
            colors = [static_color(shape.name)] * len(at)
            self._standing.append((Flock(self.scene, f"/bodies/{k}", shape, colors, opacity), at))
        self.move_standing(self.built.poses)

    def _ground(self) -> None:
        """A floor with a line each meter, a bar of a meter; the light is viser's own.

        Its player puts light back to viser's own whenever it starts over: any other would flash.
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
        x, y = float(self.low[0]), float(self.low[1]) - EDGE
        ends = [[[x, y, self.floor + LIFT], [x + 1.0, y, self.floor + LIFT]]]
        wide = min(0.03, 0.004 * float(np.linalg.norm(self.high - self.low)))
        self.scene.add_line_segments("/scale", np.array(ends), rgb(INK), thickness=wide)
        self.scene.add_label(
            "/scale/label", "1 m", position=(x + 0.5, y, self.floor + 0.05), anchor="top-center"
        )
