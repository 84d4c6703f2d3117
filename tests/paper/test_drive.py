"""Timed paths, and drives under masks."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from support.planar import at, box, planar_problem

from fgenv.paper.drive import Drive, drive
from fgenv.paper.experiment import Replan, run_experiment
from fgenv.paper.scene import masks, three_tanks
from fgenv.paper.timed_path import TimedPath, as_path, radius_of
from fgenv.planners import Problem

PATH = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 0.0, 2.0), (2.0, 1.0, 2.5)]
STRAIGHT = [(0.0, 0.0, 0.0), (4.0, 0.0, 0.0)]


def test_ends_and_corners_are_reached_on_time() -> None:
    timed = TimedPath(PATH, speed=0.5, radius=0.4)
    np.testing.assert_allclose(timed.at(timed.times), PATH)
    legs = 1.0, 0.4 * 2.0, np.sqrt(2.0) + 0.4 * 0.5
    assert timed.duration == pytest.approx(sum(legs) / 0.5)
    np.testing.assert_array_equal(timed.at([-1.0, 1e9]), timed.path[[0, -1]])


@pytest.mark.parametrize("seed", range(5))
def test_no_point_of_the_body_is_faster_than_the_speed(seed: int) -> None:
    rng = np.random.default_rng(seed)
    vertices = rng.normal(size=(50, 3))
    path = rng.uniform(-3, 3, size=(5, 3))
    timed = TimedPath(path, speed=0.7, radius=radius_of(vertices))
    ticks = timed.ticks(0.02)
    x, y, yaw = timed.at(ticks).T[:, :, None]
    points = np.stack(
        [
            x + np.cos(yaw) * vertices[:, 0] - np.sin(yaw) * vertices[:, 1],
            y + np.sin(yaw) * vertices[:, 0] + np.cos(yaw) * vertices[:, 1],
        ],
        axis=-1,
    )
    moved = np.linalg.norm(np.diff(points, axis=0), axis=2)
    assert moved.max() <= 0.02 + 1e-12
    assert (moved <= 0.7 * np.diff(ticks)[:, None] + 1e-12).all()


def test_until_cuts_the_path() -> None:
    timed = TimedPath(PATH, speed=1.0, radius=1.0)
    np.testing.assert_allclose(timed.until(0.25), [(0, 0, 0), (0.25, 0, 0)])
    np.testing.assert_allclose(timed.until(2.0), [*PATH[:2], (1, 0, 1)])
    np.testing.assert_allclose(timed.until(timed.duration), as_path(PATH))
    assert timed.until(0.0).shape == (2, 3)


@pytest.mark.parametrize(
    ("path", "speed", "message"),
    [
        ([(0, 0, 0)], 1.0, "n >= 2"),
        ([(0, 0), (1, 1)], 1.0, "shape"),
        ([(0, 0, 0), (np.inf, 0, 0)], 1.0, "finite"),
        (PATH, 0.0, "speed"),
    ],
)
def test_bad_arguments(path: list[tuple[float, ...]], speed: float, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        TimedPath(path, speed=speed, radius=1.0)


def corridor(**more: tuple[trimesh.Trimesh, tuple[float, float, float]]) -> Problem:
    """A cube in front of a post."""
    post = trimesh.creation.cylinder(0.3, 1.0), (2.0, 0.1, 0.0)
    return planar_problem(box(0.5, 0.5, 0.5), STRAIGHT[0], STRAIGHT[1], {"post": post, **more})


def test_first_contact_agrees_with_the_geometry() -> None:
    problem = corridor()
    hit = drive(problem, STRAIGHT, speed=1.0, step=0.03).hit
    assert hit is not None
    # The cube's flat front meets the post's foremost vertex or edge: x = 2 - 0.3 - 0.25.
    post = problem.world.record("post").shape.vertices[:, 0].min()
    assert hit.after[0] == pytest.approx(2.0 + post - 0.25, abs=2e-6)
    assert hit.time == pytest.approx(hit.after[0], abs=1e-9)
    assert 0 <= hit.detected - hit.time <= 0.03


def test_drive_stops_at_the_last_free_step_and_leaves_no_mask() -> None:
    problem = corridor()
    done = drive(problem, STRAIGHT, step=0.03)
    assert done.hit is not None
    np.testing.assert_allclose(at(problem), done.driven[-1])
    assert 0 <= done.hit.before[0] - at(problem)[0] <= 0.03
    assert list(masks(problem.world).values()) == [0, 0]


def test_an_error_leaves_no_mask(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = corridor()
    monkeypatch.setattr("fgenv.paper.drive.contact_point", lambda *_: None)
    with pytest.raises(RuntimeError, match="neither certified free of post"):
        drive(problem, STRAIGHT)
    assert list(masks(problem.world).values()) == [0, 0]


def test_replanning_goes_around() -> None:
    problem = corridor()
    results: list[Drive | Replan] = []
    experiment = run_experiment(problem, seed=2, report=results.append)
    assert experiment.arrived
    assert results == [experiment.drives[0], experiment.replan, experiment.drives[1]]
    np.testing.assert_allclose(at(problem), STRAIGHT[1])


def test_a_blocked_goal_is_reported() -> None:
    ring = trimesh.creation.annulus(0.8, 0.9, 1.0), (4.0, 0.0, 0.0)
    experiment = run_experiment(corridor(ring=ring), time_limit=0.3)
    assert not experiment.arrived
    assert experiment.failure is not None
    assert "no path" in experiment.failure


def test_a_free_path_needs_no_plan() -> None:
    problem = three_tanks()
    path = np.array([problem.starts[0], (0.0, -3.0, 0.0)])
    experiment = run_experiment(problem, path=path)
    assert experiment.arrived
    assert experiment.replan is None
    np.testing.assert_allclose(at(problem)[:2], (0.0, -3.0))


def test_a_body_thinner_than_a_step_is_hit() -> None:
    sheet = box(1e-4, 3.0), (0.8, 0.0, 0.0)
    hit = drive(corridor(sheet=sheet), STRAIGHT, step=0.9).hit
    assert hit is not None
    assert hit.body == "sheet"
    assert hit.after[0] == pytest.approx(0.8 - 5e-5 - 0.25, abs=2e-6)
