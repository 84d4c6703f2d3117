"""Movies and pictures of a record: cameras, notes, files."""

import numpy as np
import pytest
from PIL import Image
from shell import Shell

from fgenv.agents import policy_of, run_episode
from fgenv.envs import Record, Simulator
from fgenv.view.frames import frames_of
from fgenv.view.gallery import corners_of
from fgenv.view.masking import world_at
from fgenv.view.meetings import meetings
from fgenv.view.moving import CAMERAS, Tripod


@pytest.fixture(scope="module")
def record() -> Record:
    simulator = Simulator("corridor", n=4, clearance=True, autoreset=False)
    return run_episode(simulator, policy_of("goto"), steps=20)


@pytest.mark.parametrize("kind", CAMERAS)
def test_a_camera_sees_what_it_is_for(record: Record, kind: str) -> None:
    built = record.scenario.build()
    corners = corners_of(built.world())
    tripod = Tripod(kind, built, corners, 480, 360, robot=2)
    for step in (0, 10, 20):
        q = record["configurations"][step, 2]
        camera = tripod.at(step * record.dt, q)
        place = built.robots[2].forward(q[: built.robots[2].nq])[0, :3, 3]
        seen = place[None] if kind == "follow" else corners
        pixels, depth = camera.project(seen)
        assert (depth > 0).all()
        assert ((pixels > 0) & (pixels < (480, 360))).all()
    assert (kind in ("follow", "orbit")) == (tripod.at(0, q) != tripod.at(1, 0 * q))


def test_notes_are_drawn_over_the_frame(record: Record) -> None:
    first = meetings(record)[0]
    step = int(np.ceil(first.begin / record.dt))
    (plain,) = frames_of(record, [step])
    for note in ("time", "collisions", "masks"):
        (noted,) = frames_of(record, [step], notes=[note])
        other = (noted != plain).any(axis=2)
        assert 20 < other.sum() < 0.2 * other.size
    with pytest.raises(ValueError, match="note: 'who'"):
        next(frames_of(record, [0], notes=["who"]))
    with pytest.raises(ValueError, match="camera: 'low'"):
        next(frames_of(record, [0], camera="low"))


def test_masks_of_a_record_are_those_of_its_world(record: Record) -> None:
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
        assert movie.n_frames == 11
    for words, said in (
        ((), "nothing to write; wanted --gif, --mp4 or --png"),
        (("--png", "a.jpg"), "ends in .png"),
        (("--png", "a.png", "--camera", "low"), "--camera: 'low', wanted overview, top"),
        (("--png", "a.png", "--robot", "nobody"), "--robot: 'nobody', wanted one of robot 1"),
        (("--png", "a.png", "--size", "8"), "wanted WIDTHxHEIGHT"),
        (("--gif", "a.gif", "--at", "1"), "--at: is of a picture"),
    ):
        assert said in shell.refuses("render", "run.npz", *words)
