"""What is written and drawn over a frame of an episode: the time, trails, contacts, masks."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fgenv.arrays import Floats
from fgenv.collision import World
from fgenv.envs import Record
from fgenv.scenarios import Built
from fgenv.view.contact_events import Meeting
from fgenv.view.figures.camera import Camera
from fgenv.view.figures.movie import Frame
from fgenv.view.figures.overlay import Sheet
from fgenv.view.figures.palette import INK, robot_color
from fgenv.view.mask_links import GONE, links, present

NOTES = ("time", "trails", "collisions", "masks")
LINGER = 1.0  # seconds that a contact is still told
TRAIL = 4.0  # seconds back
LIFT = 0.01  # meters that trails are over where a base is
HIDDEN = 0.02  # of the way to a point: what is nearer by more hides it


def check(notes: Sequence[str]) -> None:
    """ValueError where there is no such note."""
    for note in notes:
        if note not in NOTES:
            raise ValueError(f"note: got {note!r}, expected {', '.join(NOTES)}")


class Notes:
    """Notes on the frames of one episode.

    Args:
        expected: of `NOTES`.
        met: all meetings.
        whose: robots whose masks are drawn; all if left out.
    """

    def __init__(
        self,
        record: Record,
        built: Built,
        expected: Sequence[str],
        met: Sequence[Meeting],
        whose: Sequence[int] | None = None,
    ) -> None:
        check(expected)
        self.record, self.expected, self.met = record, expected, met
        self.names = [robot.name for robot in built.robots]
        self.whose = range(record.n_robots) if whose is None else whose
        self._ways = [
            robot.forward(record["configurations"][:, i, : robot.nq], robot.root)[:, :3, 3]
            for i, robot in enumerate(built.robots)
        ]
        self._moving = [i for i, robot in enumerate(built.robots) if robot.base != "fixed"]

    def candidates(self, world: World, step: int) -> set[int]:
        """Bodies that bear the bit of a robot whose masks are drawn."""
        here = set(present(self.record, step)) & set(self.whose)
        return {body for i in here for body in world.candidates(self.names[i]).tolist()}

    def over(self, frame: Frame, camera: Camera, step: int, world: World | None) -> Frame:
        """The frame (height, width, 3) after a step, with notes; `world` is then, if needed."""
        sheet, seconds = Sheet(frame, camera), step * self.record.dt
        lately = [m for m in self.met if m.begin <= seconds <= m.end + LINGER]
        if "trails" in self.expected and world is not None:
            self._trails(sheet, step, world)
        if "masks" in self.expected and world is not None:
            self._masks(sheet, step, world)
        if "collisions" in self.expected:
            for meeting in lately:
                sheet.ring(np.array(meeting.point))
        if "time" in self.expected:
            sheet.text(8, 6, f"{seconds:.1f} s", INK)
        if "collisions" in self.expected:
            tell(sheet, lately)
        return sheet.frame()

    def _trails(self, sheet: Sheet, step: int, world: World) -> None:
        """Where each robot has been, paler the longer ago, and not where something hides it."""
        begin = max(0, step - round(TRAIL / self.record.dt))
        for i in self._moving:
            if self.record["status"][step, i] == GONE:
                continue
            way = self._ways[i][begin : step + 1] + (0.0, 0.0, LIFT)
            seen = visible(way, sheet.camera, world)
            for k in np.flatnonzero(seen[1:] & seen[:-1]).tolist():
                age = (step - begin - k) * self.record.dt / TRAIL
                sheet.line(way[k : k + 2], robot_color(i), 2.5, 0.9 * (1.0 - age) + 0.05)

    def _masks(self, sheet: Sheet, step: int, world: World) -> None:
        """A line from each robot to whatever bears its bit."""
        for i in sorted(set(present(self.record, step)) & set(self.whose)):
            for _, line in links(world, self.names[i]):
                sheet.line(line, robot_color(i), 2.0, halo=1.0)
                sheet.dot(line[1], robot_color(i), 3.5)


def tell(sheet: Sheet, lately: list[Meeting]) -> None:
    """Who meets whom, in the lower left corner, the latest lowest."""
    rows = sheet.camera.height // 40
    for k, meeting in enumerate(reversed(lately[-rows:])):
        sheet.text(8, sheet.camera.height - 20 - 17 * k, meeting.text, INK)


def visible(
    points: Floats, camera: Camera, world: World
) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Which points (n, 3) no body is in front of."""
    by = points - np.asarray(camera.eye)
    far = np.linalg.norm(by, axis=1)
    found = world.raycast(np.broadcast_to(camera.eye, by.shape), by / far[:, None])
    return np.asarray(found.distance > far * (1.0 - HIDDEN))
