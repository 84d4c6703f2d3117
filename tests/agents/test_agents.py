"""Following paths and driving under masks."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from fgenv.agents import Hit, PathFollower, drive, drive_and_replan
from fgenv.agents.events import Event
from fgenv.collision import Shape, World
from fgenv.scenarios import Scene, three_tanks
from fgenv.scenarios.se2 import as_path, as_poses, reach

PATH = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 0.0, 2.0), (2.0, 1.0, 2.5)]


def test_ends_and_corners_are_met_on_time() -> None:
    follower = PathFollower(PATH, speed=0.5, radius=0.4)
    np.testing.assert_allclose(follower.at(follower.times), PATH)
    legs = 1.0, 0.4 * 2.0, np.sqrt(2.0) + 0.4 * 0.5
    assert follower.duration == pytest.approx(sum(legs) / 0.5)
    np.testing.assert_array_equal(follower.at([-1.0, 1e9]), follower.path[[0, -1]])


@pytest.mark.parametrize("seed", range(5))
def test_no_point_of_the_body_is_faster_than_the_speed(seed: int) -> None:
    rng = np.random.default_rng(seed)
    vertices = rng.normal(size=(50, 3))
    path = rng.uniform(-3, 3, size=(5, 3))
    follower = PathFollower(path, speed=0.7, radius=reach(vertices))
    ticks = follower.ticks(0.02)
    poses = as_poses(follower.at(ticks))
    points = vertices @ poses[:, :3, :3].swapaxes(1, 2) + poses[:, None, :3, 3]
    moved = np.linalg.norm(np.diff(points, axis=0), axis=2)
    assert moved.max() <= 0.02 + 1e-12
    assert (moved <= 0.7 * np.diff(ticks)[:, None] + 1e-12).all()


def test_until_cuts_the_path() -> None:
    follower = PathFollower(PATH, speed=1.0, radius=1.0)
    np.testing.assert_allclose(follower.until(0.25), [(0, 0, 0), (0.25, 0, 0)])
    np.testing.assert_allclose(follower.until(2.0), [*PATH[:2], (1, 0, 1)])
    np.testing.assert_allclose(follower.until(follower.duration), as_path(PATH))
    assert follower.until(0.0).shape == (2, 3)


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
        PathFollower(path, speed=speed, radius=1.0)


def corridor(goal_free: bool = True) -> Scene:
    """A cube that has to get past a post; the goal may be walled in."""
    world = World()
    cube, post = trimesh.creation.box((0.5, 0.5, 0.5)), trimesh.creation.cylinder(0.3, 1.0)
    mover = world.add(Shape(cube.vertices, cube.faces), name="cube")
    world.add(Shape(post.vertices, post.faces), as_poses((2.0, 0.1, 0.0)), name="post")
    if not goal_free:
        ring = trimesh.creation.annulus(0.8, 0.9, 1.0)
        world.add(Shape(ring.vertices, ring.faces), as_poses((4.0, 0.0, 0.0)), name="ring")
    return Scene("corridor", world, mover, (0.0, 0.0, 0.0), (4.0, 0.0, 0.0))


def at(scene: Scene) -> list[float]:
    """Where the mover's origin is, x and y."""
    return scene.world.poses(scene.mover)[:2, 3].tolist()


def test_first_contact_where_geometry_says() -> None:
    scene = corridor()
    hit = drive(scene, scene.straight_path, speed=1.0, step=0.03).hit
    assert hit is not None
    # The cube's flat front meets the post's foremost vertex or edge: x = 2 - 0.3 - 0.25.
    post = scene.world.record("post").shape.vertices[:, 0].min()
    assert hit.after[0] == pytest.approx(2.0 + post - 0.25, abs=2e-6)
    assert hit.time == pytest.approx(hit.after[0], abs=1e-9)
    assert 0 <= hit.seen - hit.time <= 0.03


def test_drive_stands_at_the_last_free_step_and_no_mask_is_left() -> None:
    scene = corridor()
    done = drive(scene, scene.straight_path, step=0.03)
    assert done.hit is not None
    assert at(scene) == pytest.approx(done.driven[-1, :2])
    assert 0 <= done.hit.before[0] - at(scene)[0] <= 0.03
    assert list(scene.masks.values()) == [0, 0]


def test_no_mask_is_left_after_an_error() -> None:
    def report(event: Event) -> None:
        if isinstance(event, Hit):
            raise RuntimeError("stop")

    scene = corridor()
    with pytest.raises(RuntimeError, match="stop"):
        drive(scene, scene.straight_path, report=report)
    assert list(scene.masks.values()) == [0, 0]


def test_replanning_goes_around() -> None:
    scene = corridor()
    journey = drive_and_replan(scene, scene.straight_path, seed=2)
    assert journey.arrived
    assert len(journey.plans) == 1
    assert at(scene) == pytest.approx(scene.goal[:2])


def test_no_way_around_is_told() -> None:
    scene = corridor(goal_free=False)
    journey = drive_and_replan(scene, scene.straight_path, time_limit=0.3)
    assert not journey.arrived
    assert journey.problem is not None
    assert "no path" in journey.problem


def test_free_path_needs_no_plan() -> None:
    scene = three_tanks()
    journey = drive_and_replan(scene, np.array([scene.start, (0.0, -3.0, 0.0)]))
    assert journey.arrived
    assert not journey.plans
    assert at(scene) == pytest.approx((0.0, -3.0))


def test_thinner_than_a_step_is_met() -> None:
    scene = corridor()
    sheet = trimesh.creation.box((1e-4, 3.0, 1.0))
    scene.world.add(Shape(sheet.vertices, sheet.faces), as_poses((0.8, 0.0, 0.0)), name="sheet")
    hit = drive(scene, scene.straight_path, step=0.9).hit
    assert hit is not None
    assert hit.body == "sheet"
    assert hit.after[0] == pytest.approx(0.8 - 5e-5 - 0.25, abs=2e-6)
