"""Annotations over frames of an episode: the time, trails, contacts, masks."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fgenv.arrays import Flags, Floats
from fgenv.collision import World
from fgenv.envs import Record
from fgenv.envs.contact_events import ContactEvent
from fgenv.envs.state_readers import GONE
from fgenv.scenarios import Built
from fgenv.scenarios.errors import near
from fgenv.view.figures.camera import Camera
from fgenv.view.figures.movie import Frame
from fgenv.view.figures.overlay import Overlay
from fgenv.view.figures.palette import INK, robot_color
from fgenv.view.mask_links import mask_links, present_robots
from fgenv.view.robot_poses import base_paths

ANNOTATIONS = ("time", "trails", "collisions", "masks")
LINGER = 1.0  # seconds that a contact is shown after its end
TRAIL = 4.0  # seconds
LIFT = 0.01  # meters from a base up to its trail
OCCLUDED = 0.02  # a point is hidden by a body nearer by more than this share of its distance


def check_annotations(names: Sequence[str]) -> None:
    """Raise ValueError if a name is not one of `ANNOTATIONS`."""
    for name in names:
        if name not in ANNOTATIONS:
            raise ValueError(f"notes: got {name!r}; {near(name, ANNOTATIONS)}")


class Annotations:
    """Annotations on the frames of one episode.

    Args:
        names: a selection of `ANNOTATIONS`.
        events: all contacts of the record.
        mask_robots: robots with visible masks; all if left out.
    """

    def __init__(
        self,
        record: Record,
        built: Built,
        names: Sequence[str],
        events: Sequence[ContactEvent],
        mask_robots: Sequence[int] | None = None,
    ) -> None:
        check_annotations(names)
        self.record, self.names, self.events = record, names, events
        self.robots = [robot.name for robot in built.robots]
        self.mask_robots = range(record.n_robots) if mask_robots is None else mask_robots
        self._paths = base_paths(record, built)

    def candidates(self, world: World, step: int) -> set[int]:
        """Return the bodies in the masks that are drawn."""
        shown = self._robots_with_masks(step)
        return {body for i in shown for body in world.candidates(self.robots[i]).tolist()}

    def annotate(self, frame: Frame, camera: Camera, step: int, world: World | None) -> Frame:
        """Return the frame (height, width, 3) after a step with its annotations.

        `world` is the world after that step; trails and masks need it.
        """
        overlay, seconds = Overlay(frame, camera), step * self.record.dt
        recent = [e for e in self.events if e.begin <= seconds <= e.end + LINGER]
        if "trails" in self.names and world is not None:
            self._draw_trails(overlay, step, world)
        if "masks" in self.names and world is not None:
            self._draw_masks(overlay, step, world)
        if "collisions" in self.names:
            for event in recent:
                overlay.ring(np.array(event.point))
        if "time" in self.names:
            overlay.text(8, 6, f"{seconds:.1f} s", INK)
        if "collisions" in self.names:
            write_events(overlay, recent)
        return overlay.frame()

    def _robots_with_masks(self, step: int) -> list[int]:
        return sorted(set(present_robots(self.record, step)) & set(self.mask_robots))

    def _draw_trails(self, overlay: Overlay, step: int, world: World) -> None:
        """Draw the visible parts of the bases' recent paths, paler with age."""
        begin = max(0, step - round(TRAIL / self.record.dt))
        for i, whole in self._paths.items():
            if self.record["status"][step, i] == GONE:
                continue
            path = whole[begin : step + 1] + (0.0, 0.0, LIFT)
            seen = visible(path, overlay.camera, world)
            for k in np.flatnonzero(seen[1:] & seen[:-1]).tolist():
                age = (step - begin - k) * self.record.dt / TRAIL
                overlay.line(path[k : k + 2], robot_color(i), 2.5, 0.9 * (1.0 - age) + 0.05)

    def _draw_masks(self, overlay: Overlay, step: int, world: World) -> None:
        """Draw a line from each robot to each body in its mask."""
        for i in self._robots_with_masks(step):
            for _, line in mask_links(world, self.robots[i]):
                overlay.line(line, robot_color(i), 2.0, halo=1.0)
                overlay.dot(line[1], robot_color(i), 3.5)


def write_events(overlay: Overlay, events: list[ContactEvent]) -> None:
    """Write contacts into the lower left corner, the latest at the bottom."""
    rows = overlay.camera.height // 40
    for k, event in enumerate(reversed(events[-rows:])):
        overlay.text(8, overlay.camera.height - 20 - 17 * k, event.text, INK)


def visible(points: Floats, camera: Camera, world: World) -> Flags:
    """Return which points (n, 3) no body hides from the camera."""
    offset = points - np.asarray(camera.eye)
    distance = np.linalg.norm(offset, axis=1)
    eyes = np.broadcast_to(camera.eye, offset.shape)
    hits = world.raycast(eyes, offset / distance[:, None])
    return np.asarray(hits.distance > distance * (1.0 - OCCLUDED))
