"""What is written and drawn over a frame of an episode: the time, contacts, masks."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from fgenv.envs import Record
from fgenv.scenarios import Built
from fgenv.view.camera import Camera, box_corners
from fgenv.view.masking import middle, present, world_at
from fgenv.view.meetings import Meeting
from fgenv.view.movie import Frame
from fgenv.view.palette import BLACK, INK, SKY, WHITE, Color, robot_color
from fgenv.view.surfaces import Floats

NOTES = ("time", "collisions", "masks")
FINE = 2  # drawn so many times larger, for smooth lines
LINGER = 1.0  # seconds that a contact is still told
BOX_EDGES = np.array([(i, i | bit) for i in range(8) for bit in (1, 2, 4) if not i & bit])


def check(notes: Sequence[str]) -> None:
    """ValueError where there is no such note."""
    for note in notes:
        if note not in NOTES:
            raise ValueError(f"note: {note!r}, wanted {', '.join(NOTES)}")


def annotated(
    frame: Frame,
    camera: Camera,
    record: Record,
    built: Built,
    step: int,
    notes: Sequence[str],
    met: Sequence[Meeting],
) -> Frame:
    """A frame (height, width, 3) after a step, with notes; `met` are all meetings."""
    sheet = Sheet(frame, camera)
    if "masks" in notes:
        draw_masks(sheet, record, built, step)
    seconds = step * record.dt
    lately = [m for m in met if m.begin <= seconds <= m.end + LINGER]
    if "collisions" in notes:
        for meeting in lately:
            sheet.ring(np.array(meeting.point))
    if "time" in notes:
        sheet.text(8, 6, f"{seconds:.1f} s", INK)
    if "collisions" in notes:
        tell(sheet, lately)
    return sheet.frame()


def tell(sheet: Sheet, lately: list[Meeting]) -> None:
    """Who meets whom, in the lower left corner, the latest lowest."""
    rows = sheet.camera.height // 40
    for k, meeting in enumerate(reversed(lately[-rows:])):
        sheet.text(8, sheet.camera.height - 20 - 17 * k, meeting.text, INK)


def draw_masks(sheet: Sheet, record: Record, built: Built, step: int) -> None:
    """Boxes of what bears a robot's bit, and a line to each from the robot."""
    world = world_at(record, built, step)
    marked = set[int]()
    for i in present(record, step):
        name = built.robots[i].name
        here = middle(world, int(world.parts(name)[0]))
        found = world.candidates(name).tolist()
        marked |= set(found)
        for body in found:
            sheet.line(np.array([here, middle(world, body)]), robot_color(i), 1.5)
    for body in marked:
        low, high = world.record(body).shape.bounds
        pose = world.record(body).pose
        corners = box_corners(low, high) @ pose[:3, :3].T + pose[:3, 3]
        for ends in corners[BOX_EDGES]:
            sheet.line(ends, SKY, 1.0)


class Sheet:
    """A clear sheet over a frame: lines, rings and words."""

    def __init__(self, frame: Frame, camera: Camera) -> None:
        self.camera, self._image = camera, Image.fromarray(frame).convert("RGBA")
        self._layer = Image.new("RGBA", (FINE * camera.width, FINE * camera.height))
        self._draw = ImageDraw.Draw(self._layer)
        self._words: list[tuple[float, float, str, Color]] = []

    def line(self, ends: Floats, color: Color, width: float) -> None:
        """From one point to another, (2, 3), metres; left out where one is behind the eye."""
        pixels, depth = self.camera.project(ends)
        if (depth > 0).all():
            self._draw.line((pixels * FINE).ravel().tolist(), ink(color), round(width * FINE))

    def ring(self, point: Floats, radius: float = 7.0) -> None:
        """Around a point (3,), metres; the radius in pixels."""
        pixel, depth = self.camera.project(point)
        if depth > 0:
            box = np.concatenate([pixel - radius, pixel + radius]) * FINE
            self._draw.ellipse(box.tolist(), outline=ink(BLACK), width=2 * FINE)

    def text(self, x: float, y: float, words: str, color: Color) -> None:
        """Words from there on, pixels."""
        self._words.append((x, y, words, color))

    def frame(self) -> Frame:
        """The frame with all that."""
        self._image.alpha_composite(self._layer.reduce(FINE))
        draw = ImageDraw.Draw(self._image)
        font = ImageFont.load_default(14)
        for x, y, words, color in self._words:
            draw.text((x, y), words, ink(color), font, stroke_width=2, stroke_fill=ink(WHITE))
        return np.asarray(self._image.convert("RGB"))


def ink(color: Color) -> tuple[int, int, int]:
    """An sRGB colour in bytes."""
    red, green, blue = (round(255 * c) for c in color)
    return red, green, blue
