"""Replay pages: their data, and their behavior in a browser."""

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
import trimesh
from support.browser import CHROMIUM, page
from support.shell import Shell

import fgenv
from fgenv.agents import run_episode
from fgenv.collision import Shape
from fgenv.envs import Record, Simulator, policy_of
from fgenv.envs.contact_events import contact_events
from fgenv.view.episodes import load_episode
from fgenv.view.web.meshes import mesh_of, quaternions
from fgenv.view.web.replay import positions, write_replay

pytest.importorskip("viser")
SLIDER = "document.querySelector('[role=\"slider\"]')"
NOW = f"Number({SLIDER}.getAttribute('aria-valuenow'))"


@pytest.fixture(scope="module")
def record() -> Record:
    simulator = Simulator("corridor", n=4, clearance=True, autoreset=False)
    return run_episode(simulator, policy_of("goto"), steps=40)


@pytest.fixture(scope="module")
def path(record: Record, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("replay") / "run.html"
    assert write_replay(path, record) == path.stat().st_size
    return path


def test_a_page_is_small_and_needs_nothing_else(path: Path) -> None:
    text = path.read_text()
    assert len(text) < 1_200_000
    assert not re.search(r"<(script|link|img)[^>]+(src|href)=[\"']https?:", text)


def test_it_says_who_meets_whom(record: Record, path: Path) -> None:
    found = re.search(r"window\.FGENV=(\{.*\});", path.read_text())
    assert found
    contacts = json.loads(found[1])["contacts"]
    assert [m["text"] for m in contacts] == [m.text for m in contact_events(record)]
    met = {(m.text.split(" meets ")[0]) for m in contact_events(record)}
    assert met
    for i, name in enumerate(record.names):
        others = {record.names[k] for k in record["hit_robots"][:, i] if k >= 0}
        assert (record["hits"][:, i] >= 0).any() == (name in met or bool(others & met))


def test_positions_are_the_records_own_at_each_step(record: Record) -> None:
    built = record.scenario.build()
    found = list(positions(record, built))
    times = np.array([seconds for seconds, _, _ in found])
    assert (np.diff(times) > 0).all()
    assert np.diff(times).max() <= 0.05 + 1e-9
    for k in range(len(record) + 1):
        _, q, _ = found[int(np.argmin(abs(times - k * record.dt)))]
        np.testing.assert_array_equal(np.stack(q), record["configurations"][k])


def test_quaternions_turn_as_matrices_do() -> None:
    rng = np.random.default_rng(0)
    q = rng.normal(size=(1000, 4))
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    q[:4] = np.eye(4)  # half turns about each axis, and none
    w, v = q[:, 0], q[:, 1:]
    cross = np.cross(np.eye(3)[None], v[:, None])  # rows e_i x v
    turn = (w**2 - (v**2).sum(1))[:, None, None] * np.eye(3)
    turn = turn + 2 * v[:, :, None] * v[:, None, :] + 2 * w[:, None, None] * cross
    poses = np.tile(np.eye(4), (1000, 1, 1))
    poses[:, :3, :3] = turn
    assert np.allclose(np.linalg.det(turn), 1)
    found = quaternions(poses)
    assert np.allclose(np.abs((found * q).sum(axis=1)), 1, atol=1e-6)


def test_sharp_edges_stay_sharp() -> None:
    box, ball = trimesh.creation.box(), trimesh.creation.icosphere(subdivisions=3)
    assert len(mesh_of(Shape(box.vertices, box.faces))[0]) == 24
    vertices, faces = mesh_of(Shape(ball.vertices, ball.faces))
    assert len(vertices) == len(ball.vertices)
    assert np.allclose(vertices[faces], ball.vertices[ball.faces], atol=1e-6)


def test_a_plan_is_played_as_if_driven(tmp_path: Path) -> None:
    plan = fgenv.plan("doorway", n=2, method="prioritized", seed=1)
    plan.save(tmp_path / "plan.npz")
    found = load_episode(tmp_path / "plan.npz")
    assert len(found) == plan.steps
    for i, q in enumerate(plan.configurations):
        np.testing.assert_array_equal(found["configurations"][:, i, : q.shape[1]], q)
    assert (found["status"][-1] == 1).all()
    assert contact_events(found) == []


def test_command(record: Record, shell: Shell) -> None:
    record.save("run.npz")
    code, out, err = shell("replay", "run.npz")
    assert (code, err) == (0, "")
    assert out == f"written: run.html, {Path('run.html').stat().st_size:,} bytes\n"
    Path("no.npz").write_bytes(b"nothing")
    for words, said in (
        (["no.npz"], "is damaged, or no record"),
        (["run.npz", "--html", "run.png"], "ends in .html"),
        (["run.npz", "--html", "no/run.html"], "there is no folder no"),
    ):
        assert said in shell.refuses("replay", *words)


@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
def test_in_a_browser_it_shows_scrubs_and_jumps(record: Record, path: Path) -> None:
    with page() as shown:
        shown.open(path.as_uri())
        shown.wait(SLIDER)
        empty = shown.picture()
        shown.wait("document.querySelectorAll('.fgenv-mark').length")
        assert shown.run("document.querySelectorAll('.fgenv-mark').length") == len(
            contact_events(record)
        )
        first = (
            math.ceil(contact_events(record)[0].begin / 0.05) * 0.05
        )  # positions are so far apart
        shown.key("Home")
        shown.key("n")
        shown.wait(f"Math.abs({NOW} - {first}) < 1e-5")
        shown.key("ArrowRight")
        shown.wait(f"Math.abs({NOW} - {first + record.dt}) < 1e-5")
        shown.key("p")
        shown.wait(f"Math.abs({NOW} - {first}) < 1e-5")
        early = shown.settled()
        x, y = shown.run(
            f"(r => [r.left + 0.9 * r.width, r.top + r.height / 2])"
            f"({SLIDER}.closest('.mantine-Slider-root').getBoundingClientRect())"
        )
        shown.click(x, y)
        shown.wait(f"Math.abs({NOW} - {0.9 * len(record) * record.dt}) < 0.1")
        late = shown.settled()
        assert shown.errors == []
    assert (np.abs(early.astype(int) - empty).max(axis=2) > 60).mean() > 0.02
    assert (np.abs(early.astype(int) - late).max(axis=2) > 60).sum() > 200  # robots have moved
    orange = np.abs(early.astype(int) - (215, 135, 0)).max(axis=2) < 45  # of robot 1
    assert orange.sum() > 100
