"""An episode as one page: opens from disk, plays, scrubs, has a mark for each collision.

viser writes the scene and its own player (play, scrub, speed) into a page. `page.js` puts onto that
player what it lacks: marks on its time line, steps by keys, who meets whom.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator
from dataclasses import asdict
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import trimesh

from fgenv.arrays import Floats
from fgenv.collision import Shape
from fgenv.envs import Record
from fgenv.scenarios import Built
from fgenv.view.contact_events import Meeting, meetings
from fgenv.view.figures.palette import BLACK, robot_color

from .meshes import rgb
from .scenery import Flock, Scenery
from .server import serving

if TYPE_CHECKING:
    from viser import SceneApi

GONE = 2  # of a record's status
SMOOTHNESS = 20.0  # positions a second that are stored at least; steps are what is real
MOST = 20_000  # positions of all robots that are stored beside the steps' own
LINGER, TOLD = 0.6, 2.5  # seconds that a contact is still shown, and said who it is of
MOST_LABELS = 200


def write_replay(
    path: str | Path, record: Record, progress: Callable[[int, int], object] | None = None
) -> int:
    """Write a page that plays a record; returns its bytes.

    Args:
        path: what is there is replaced when all is made.
        progress: called with the number of steps made, and of all.

    Raises:
        ImportError: viser is missing, with the remedy.
        OSError: it cannot be written.
    """
    path, page = Path(path), replay_page(record, progress).encode()
    half = path.with_name(f".{path.name}.part")
    try:
        half.write_bytes(page)
        half.replace(path)
    finally:
        half.unlink(missing_ok=True)
    return len(page)


def replay_page(record: Record, progress: Callable[[int, int], object] | None = None) -> str:
    """The page, HTML that needs nothing else."""
    met, built = meetings(record), record.scenario.build()
    with serving(0) as server:
        scenery = Scenery(server.scene, built)
        camera = scenery.camera
        server.initial_camera.position = camera.eye
        server.initial_camera.look_at = camera.target
        server.initial_camera.fov = camera.fov
        ways(server.scene, record, built, scenery.floor)
        contacts = Contacts(server.scene, scenery, met)
        recorder = server.get_scene_serializer()
        times: list[float] = []
        for seconds, configurations, here in positions(record, built):
            recorder.insert_sleep(seconds - (times[-1] if times else 0.0))
            times.append(seconds)
            scenery.robots.move(scenery.robots.poses(configurations), here)
            contacts.show(seconds)
            if progress is not None:
                progress(round(seconds / record.dt), len(record))
        html = str(recorder.as_html())
    return with_marks(html, record, met, times)


def positions(record: Record, built: Built) -> Iterator[tuple[float, list[Floats], list[bool]]]:
    """Seconds, configurations of the robots, and who is there: each step, and evenly between.

    Between two steps robots go straight, as `env.step` drives them.
    """
    q, status, steps = record["configurations"], record["status"], len(record)
    between = max(1, math.ceil(SMOOTHNESS * record.dt - 1e-9))
    between = max(1, min(between, MOST // max(1, steps * len(built.robots))))
    for k in range(steps):
        here = (status[k] != GONE).tolist()
        for part in range(between):
            t = part / between
            rows = [
                robot.interpolate(q[k, i, : robot.nq], q[k + 1, i, : robot.nq], t)
                for i, robot in enumerate(built.robots)
            ]
            yield (k + t) * record.dt, rows, here
    yield steps * record.dt, list(q[steps]), (status[steps] != GONE).tolist()


class Contacts:
    """Black balls where robots meet something, with who meets whom beside the first ones."""

    def __init__(self, scene: SceneApi, scenery: Scenery, met: list[Meeting]) -> None:
        self.met, self._n = met, len(scenery.built.robots)
        self._shown: list[Meeting] | None = None
        if not met:
            return
        size = float(np.linalg.norm(scenery.high - scenery.low))
        ball = trimesh.creation.icosphere(subdivisions=2, radius=min(0.06, 0.008 * size))
        shape = Shape(ball.vertices, ball.faces, name="contact")
        self._balls = Flock(scene, "/contacts/points", shape, [BLACK] * self._n)
        self._labels = [
            scene.add_label(f"/contacts/{k}", m.text, position=m.point, visible=False)
            for k, m in enumerate(met[:MOST_LABELS])
        ]

    def show(self, seconds: float) -> None:
        """What is met then, or was a moment ago."""
        if not self.met:
            return
        lately = [m for m in self.met if m.begin - 1e-9 <= seconds <= m.end + LINGER]
        if lately != self._shown:
            here = np.zeros(self._n, dtype=bool)
            poses = np.tile(np.eye(4), (self._n, 1, 1))
            for m in lately:
                poses[m.robot, :3, 3], here[m.robot] = m.point, True
            self._balls.move(poses, here.tolist())
            self._shown = lately
        for label, m in zip(self._labels, self.met, strict=False):
            told = m.begin - 1e-9 <= seconds <= min(m.begin + TOLD, m.end + LINGER)
            if label.visible != told:
                label.visible = told


def ways(scene: SceneApi, record: Record, built: Built, floor: float) -> None:
    """The whole way of each robot's base as a line; arms have none."""
    for i, robot in enumerate(built.robots):
        if robot.base == "fixed" or len(record) == 0:
            continue
        links = robot.forward(record["configurations"][:, i, : robot.nq], robot.root)
        points = links[:, :3, 3].copy()
        if robot.base == "planar":
            points[:, 2] = floor + 0.015
        apart = np.linalg.norm(np.diff(points, axis=0), axis=1) > 1e-6
        ends = np.stack([points[:-1], points[1:]], axis=1)[apart]
        if len(ends):
            color = rgb(robot_color(i))
            scene.add_line_segments(f"/ways/{i}", ends.astype(np.float32), color, thickness=0.02)


def with_marks(html: str, record: Record, met: list[Meeting], times: list[float]) -> str:
    """The page with our own additions to viser's player; `times` are those of its positions."""
    colors = ["#{:02x}{:02x}{:02x}".format(*rgb(robot_color(i))) for i in range(record.n_robots)]
    scenario = record.scenario.name
    shown = [min(t for t in times if t > m.begin - 1e-9 or t == times[-1]) for m in met]
    told = {
        "title": f"{scenario}: {record.n_robots} robots, {record.policy}",
        "seconds": len(record) * record.dt,
        "dt": record.dt,
        "meetings": [
            asdict(m) | {"color": colors[m.robot], "shown": t}
            for m, t in zip(met, shown, strict=True)
        ],
    }
    data = json.dumps(told, separators=(",", ":")).replace("<", "\\u003c")
    script = files(__package__).joinpath("page.js").read_text(encoding="utf-8")
    added = f"<script>window.FGENV={data};\n{script}</script>"
    head, end, rest = html.rpartition("</body>")
    title = f"<title>{scenario} - fgenv</title>".replace("&", "&amp;")
    return head.replace("<title>Viser</title>", title, 1) + added + end + rest
