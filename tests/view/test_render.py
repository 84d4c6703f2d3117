"""Movies and pictures of a record: cameras, annotations, files."""

import numpy as np
import pytest
from PIL import Image
from PIL.GifImagePlugin import GifImageFile
from support.shell import Shell

from fgenv.agents import run_episode
from fgenv.envs import Record, Simulator, policy_of
from fgenv.envs.contact_events import contact_events
from fgenv.view.figures.annotations import Annotations
from fgenv.view.figures.camera_path import CAMERAS, CameraPath
from fgenv.view.figures.episode_frames import frames_of
from fgenv.view.figures.scenario_painter import ScenarioPainter
from fgenv.view.figures.scenario_picture import world_corners
from fgenv.view.mask_links import mask_links, world_at


@pytest.fixture(scope="module")
def record() -> Record:
    simulator = Simulator("corridor", n=4, clearance=True, autoreset=False)
    return run_episode(simulator, policy_of("goto"), steps=20)


@pytest.mark.parametrize("kind", CAMERAS)
def test_a_camera_sees_its_subject(record: Record, kind: str) -> None:
    built = record.scenario.build()
    corners = world_corners(built.world())
    path = CameraPath(kind, built, corners, 480, 360, robot=2)
    for step in (0, 10, 20):
        q = record["configurations"][step, 2]
        camera = path.at(step * record.dt, q)
        place = built.robots[2].forward(q[: built.robots[2].nq])[0, :3, 3]
        seen = place[None] if kind == "follow" else corners
        pixels, depth = camera.project(seen)
        assert (depth > 0).all()
        assert ((pixels > 0) & (pixels < (480, 360))).all()
    assert (kind in ("follow", "orbit")) == (path.at(0, q) != path.at(1, 0 * q))


def test_notes_are_drawn_over_the_frame(record: Record) -> None:
    first = contact_events(record)[0]
    step = int(np.ceil(first.begin / record.dt))
    (plain,) = frames_of(record, [step])
    for note in ("time", "trails", "collisions", "masks"):
        (noted,) = frames_of(record, [step], notes=[note])
        other = (noted != plain).any(axis=2)
        assert 20 < other.sum() < 0.2 * other.size
    with pytest.raises(ValueError, match="notes: got 'who'"):
        next(frames_of(record, [0], notes=["who"]))
    with pytest.raises(ValueError, match="camera: got 'low'"):
        next(frames_of(record, [0], camera="low"))


def test_trails_are_where_robots_have_been(record: Record) -> None:
    """No pixel changes away from the paths of robots."""
    built, step = record.scenario.build(), 20
    (plain,), (trailed,) = (frames_of(record, [step], notes=notes) for notes in ([], ["trails"]))
    changed = np.argwhere((trailed != plain).any(axis=2))[:, ::-1] + 0.5
    camera = CameraPath("overview", built, ScenarioPainter(built).corners, 480, 360).at(
        0, built.starts[0]
    )
    paths = record["configurations"][:, :, :3] * (1.0, 1.0, 0.0)
    pixels, _ = camera.project(paths.reshape(-1, 3))
    far = np.linalg.norm(changed[:, None] - pixels, axis=2).min(axis=1)
    assert len(changed) > 100
    assert far.max() < 8.0


def test_masks_of_one_robot_mark_only_its_candidates(record: Record) -> None:
    built, step = record.scenario.build(), 3
    annotations = Annotations(record, built, ["masks"], [], [1])
    world = world_at(record, built, step)
    marked = annotations.candidates(world, step)
    assert marked == set(world.candidates("robot 2").tolist())
    for body, line in mask_links(world, "robot 2"):
        low, high = world.record(body).shape.bounds
        pose = world.record(body).pose
        local = (line[1] - pose[:3, 3]) @ pose[:3, :3]
        assert ((local >= low - 1e-9) & (local <= high + 1e-9)).all()


def test_an_overview_looks_from_its_azimuth_and_elevation(record: Record) -> None:
    built = record.scenario.build()
    corners = world_corners(built.world())
    look = "overview", built, corners, 480, 360, 0
    ahead = CameraPath(*look, azimuth=0.3, elevation=0.9).at(0.0, built.starts[0]).axes[2]
    assert np.arctan2(-ahead[1], -ahead[0]) == pytest.approx(0.3)
    assert np.arcsin(-ahead[2]) == pytest.approx(0.9)
    with pytest.raises(ValueError, match="got camera 'orbit', expected camera 'overview'"):
        CameraPath("orbit", built, corners, 480, 360, azimuth=0.3)


def test_the_world_of_a_record_has_its_masks_and_configurations(record: Record) -> None:
    world = world_at(record, record.scenario.build(), 3)
    assert all(world.own_bit(name) for name in record.names)
    for i, name in enumerate(record.names):
        robot = world.record(int(world.parts(name)[0])).robot
        assert robot is not None
        np.testing.assert_array_equal(world.configuration(name), record["configurations"][3, i])


def test_command(record: Record, shell: Shell) -> None:
    record.save("run.npz")
    files = ("--gif", "a.gif", "--mp4", "a.mp4", "--png", "a.png", "--at", "1")
    look = ("--camera", "follow", "--size", "128x96", "--fps", "5")
    code, out, _ = shell("render", "run.npz", *files, *look)
    assert (code, out.count("written: ")) == (0, 3)
    with Image.open("a.gif") as movie, Image.open("a.png") as picture:
        assert movie.size == picture.size == (128, 96)
        assert isinstance(movie, GifImageFile)
        assert movie.n_frames == 11
    shell("render", "run.npz", "--gif", "b.gif", "--size", "128x96", "--fps", "5", "--speed", "2")
    with Image.open("b.gif") as movie:
        assert isinstance(movie, GifImageFile)
        assert movie.n_frames == 6  # 2 s of 20 steps in 1 s
    for words, said in (
        (
            ("--png", "a.png", "--elevation", "120"),
            "--elevation: got 120, expected 5 to 89 degrees",
        ),
        (
            ("--png", "a.png", "--azimuth", "400"),
            "--azimuth: got 400, expected -360 to 360 degrees",
        ),
        (("--png", "a.png", "--camera", "top", "--azimuth", "0"), "are of --camera overview"),
        ((), "nothing to write; expected --gif, --mp4 or --png"),
        (("--png", "a.jpg"), "ends in .png"),
        (("--png", "a.png", "--camera", "low"), "--camera: got 'low'; did you mean 'follow'?"),
        (("--png", "a.png", "--robot", "nobody"), "--robot: got 'nobody', expected one of robot 1"),
        (("--png", "a.png", "--size", "8"), "expected WIDTHxHEIGHT"),
        (("--gif", "a.gif", "--at", "1"), "--at: is of a picture"),
    ):
        assert said in shell.refuses("render", "run.npz", *words)
