"""An episode as one page that opens from disk, plays, scrubs and marks each collision.

viser writes the scene and its player (play, scrub, speed) into a page. `page.js` adds marks on the
time line, steps by keys, and the names of bodies in contact.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import asdict
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import trimesh

from fgenv.arrays import Floats
from fgenv.collision import Shape
from fgenv.envs import Record
from fgenv.envs.contact_events import ContactEvent, contact_events
from fgenv.envs.state_readers import GONE
from fgenv.saving import save_bytes
from fgenv.scenarios import Built
from fgenv.view.figures.palette import BLACK, robot_color
from fgenv.view.robot_poses import base_paths

from .meshes import rgb
from .page_security import script_json, with_policy
from .scene import BatchedMesh, ScenarioScene
from .server import serving

if TYPE_CHECKING:
    from viser import SceneApi

RATE = 20.0  # positions per second that are stored at least
MAX_POSITIONS = 20_000  # of all robots, interpolated between steps
LINGER, LABEL_TIME = 0.6, 2.5  # seconds that a contact is shown after its end, and its label
MAX_LABELS = 200
LIFT = 0.015  # meters from the floor to paths
Progress = Callable[[int, int], object]


def write_replay(path: str | Path, record: Record, progress: Progress | None = None) -> int:
    """Write a page that plays a record; return its size in bytes.

    Args:
        path: file to write; it is replaced once the page is complete.
        progress: called with the number of steps written, and of all.

    Raises:
        ImportError: viser is missing, with the remedy.
        OSError: the file cannot be written.
    """
    page = replay_page(record, progress).encode()
    save_bytes(path, page)
    return len(page)


def replay_page(record: Record, progress: Progress | None = None) -> str:
    """Return the page as self-contained HTML."""
    events, built = contact_events(record), record.scenario.build()
    with serving(0) as server:
        scene = ScenarioScene(server.scene, built)
        camera, initial = scene.camera, server.initial_camera
        initial.position, initial.look_at, initial.fov = camera.eye, camera.target, camera.fov
        add_paths(server.scene, record, built, scene.floor)
        contacts = ContactMarks(server.scene, scene, events)
        recorder = server.get_scene_serializer()
        times: list[float] = []
        for seconds, configurations, present in positions(record, built):
            recorder.insert_sleep(seconds - (times[-1] if times else 0.0))
            times.append(seconds)
            scene.robots.move(scene.robots.poses(configurations), present)
            contacts.show(seconds)
            if progress is not None:
                progress(round(seconds / record.dt), len(record))
        html = str(recorder.as_html())
    return with_marks(html, record, events, times)


def positions(record: Record, built: Built) -> Iterator[tuple[float, list[Floats], list[bool]]]:
    """Yield seconds, configurations and presence of the robots at each step and between steps.

    Robots are interpolated between two steps, as `env.step` moves them.
    """
    q, status, steps = record["configurations"], record["status"], len(record)
    per_step = max(1, math.ceil(RATE * record.dt - 1e-9))
    per_step = max(1, min(per_step, MAX_POSITIONS // max(1, steps * len(built.robots))))
    for k in range(steps):
        present = (status[k] != GONE).tolist()
        for part in range(per_step):
            t = part / per_step
            rows = [
                robot.interpolate(q[k, i, : robot.nq], q[k + 1, i, : robot.nq], t)
                for i, robot in enumerate(built.robots)
            ]
            yield (k + t) * record.dt, rows, present
    yield steps * record.dt, list(q[steps]), (status[steps] != GONE).tolist()


class ContactMarks:
    """Black balls at contacts, and labels with the names of both bodies at the first ones."""

    def __init__(
        self, scene: SceneApi, scenario: ScenarioScene, events: list[ContactEvent]
    ) -> None:
        self.events, self._n = events, len(scenario.built.robots)
        self._shown: list[ContactEvent] | None = None
        if not events:
            return
        size = float(np.linalg.norm(scenario.high - scenario.low))
        ball = trimesh.creation.icosphere(subdivisions=2, radius=min(0.06, 0.008 * size))
        shape = Shape(ball.vertices, ball.faces, name="contact")
        self._balls = BatchedMesh(scene, "/contacts/points", shape, [BLACK] * self._n)
        self._labels = [
            scene.add_label(f"/contacts/{k}", e.text, position=e.point, visible=False)
            for k, e in enumerate(events[:MAX_LABELS])
        ]

    def show(self, seconds: float) -> None:
        """Show the contacts of a time."""
        if not self.events:
            return
        recent = [e for e in self.events if e.begin - 1e-9 <= seconds <= e.end + LINGER]
        if recent != self._shown:
            present = np.zeros(self._n, dtype=bool)
            poses = np.tile(np.eye(4), (self._n, 1, 1))
            for e in recent:
                poses[e.robot, :3, 3], present[e.robot] = e.point, True
            self._balls.move(poses, present.tolist())
            self._shown = recent
        for label, e in zip(self._labels, self.events, strict=False):
            visible = e.begin - 1e-9 <= seconds <= min(e.begin + LABEL_TIME, e.end + LINGER)
            if label.visible != visible:
                label.visible = visible


def add_paths(scene: SceneApi, record: Record, built: Built, floor: float) -> None:
    """Add the whole path of each mobile robot's base as a line."""
    for i, path in base_paths(record, built).items():
        points = path.copy()
        if built.robots[i].base == "planar":
            points[:, 2] = floor + LIFT
        moved = np.linalg.norm(np.diff(points, axis=0), axis=1) > 1e-6
        ends = np.stack([points[:-1], points[1:]], axis=1)[moved]
        if len(ends):
            color = rgb(robot_color(i))
            scene.add_line_segments(f"/ways/{i}", ends.astype(np.float32), color, thickness=0.02)


def with_marks(html: str, record: Record, events: list[ContactEvent], times: list[float]) -> str:
    """Add `page.js` and its data to a page; `times` are those of the stored positions."""
    colors = ["#{:02x}{:02x}{:02x}".format(*rgb(robot_color(i))) for i in range(record.n_robots)]
    name = record.scenario.name
    shown = [min(t for t in times if t > e.begin - 1e-9 or t == times[-1]) for e in events]
    data = {
        "title": f"{name}: {record.n_robots} robots, {record.policy}",
        "seconds": len(record) * record.dt,
        "dt": record.dt,
        "contacts": [
            asdict(e) | {"color": colors[e.robot], "shown": t}
            for e, t in zip(events, shown, strict=True)
        ],
    }
    script = files(__package__).joinpath("page.js").read_text(encoding="utf-8")
    added = f"<script>window.FGENV={script_json(data)};\n{script}</script>"
    head, end, rest = html.rpartition("</body>")
    title = f"<title>{escape(name)} - fgenv</title>"
    return with_policy(head.replace("<title>Viser</title>", title, 1) + added + end + rest)
