"""Planning by OMPL: repeatable, honest about failure, and free where it says so."""

from __future__ import annotations

import time

import fcl
import numpy as np
import pytest
import trimesh

from fgenv.arrays import Floats
from fgenv.collision import Shape, World
from fgenv.planners import PlanarChecker, PlanningError, plan_planar, prove_free, rrt_connect
from fgenv.scenarios.se2 import as_path, as_poses, reach, refine

SQUARE = [[-2.0, -2.0], [2.0, 2.0]]
START, GOAL = (-1.5, 0.0, 0.0), (1.5, 0.0, 0.0)


Place = tuple[str, trimesh.Trimesh, tuple[float, float, float]]


def shape(mesh: trimesh.Trimesh) -> Shape:
    return Shape(mesh.vertices, mesh.faces)


def checker_of(robot: trimesh.Trimesh, *places: Place, margin: float = 0.0) -> PlanarChecker:
    """A robot (first at the origin) in a world of named bodies."""
    world = World()
    mover = world.add(shape(robot), name="robot")
    for name, mesh, place in places:
        world.add(shape(mesh), as_poses(place), name=name)
    return PlanarChecker(world, mover, margin=margin)


def box(x: float, y: float, z: float = 1.0) -> trimesh.Trimesh:
    return trimesh.creation.box((x, y, z))


def wall_with_a_gap(robot: trimesh.Trimesh | None = None, margin: float = 0.0) -> PlanarChecker:
    """A slab 0.9 long has to turn to get through a gap 0.5 wide."""
    walls = [(f"wall {s}", box(0.1, 1.75), (0.0, s * 1.125, 0.0)) for s in (-1, 1)]
    return checker_of(robot or box(0.2, 0.9), *walls, margin=margin)


def fcl_free(checker: PlanarChecker, path: Floats, step: float) -> bool:
    """Whether python-fcl finds the path free at a fine step."""

    def model(shape: Shape) -> fcl.BVHModel:
        bvh = fcl.BVHModel()
        bvh.beginModel(len(shape.vertices), len(shape.faces))
        bvh.addSubModel(shape.vertices, shape.faces)
        bvh.endModel()
        return bvh

    mover = fcl.CollisionObject(model(checker.shape))
    records = [checker.world.record(int(b)) for b in checker.world.ids if b != checker.robot]
    others = [
        fcl.CollisionObject(model(b.shape), fcl.Transform(b.pose[:3, :3], b.pose[:3, 3]))
        for b in records
    ]
    for x, y, yaw in refine(as_path(path), reach(checker.shape.vertices), step):
        turn = trimesh.transformations.rotation_matrix(yaw, (0, 0, 1))[:3, :3]
        mover.setTransform(fcl.Transform(turn, [x, y, checker.height]))
        if any(fcl.collide(mover, other) for other in others):
            return False
    return True


# Plans -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(4))
def test_plan_through_a_gap_is_free_by_fcl(seed: int) -> None:
    checker = wall_with_a_gap()
    plan = plan_planar(checker, START, GOAL, bounds=SQUARE, seed=seed)
    np.testing.assert_allclose(plan.path[[0, -1]], [START, GOAL], atol=1e-12)
    assert np.abs(np.diff(plan.path[:, 2])).max() <= np.pi
    assert (np.abs(plan.path[:, :2]) <= 2.0).all()
    assert plan.length == pytest.approx(
        np.linalg.norm(np.diff(plan.path[:, :2], axis=0), axis=1).sum()
    )
    assert 3.0 <= plan.length < 8.0
    assert fcl_free(checker, plan.path, 0.004)


def test_same_seed_same_plan_and_other_seed_other_plan() -> None:
    checker = wall_with_a_gap()
    plans = [plan_planar(checker, START, GOAL, bounds=SQUARE, seed=s) for s in (3, 3, 4, 0, 0)]
    assert plans[0].path.tobytes() == plans[1].path.tobytes()
    assert plans[0].checks == plans[1].checks
    assert plans[3].path.tobytes() == plans[4].path.tobytes()  # OMPL itself ignores seed 0
    assert plans[0].path.tobytes() != plans[2].path.tobytes()


def test_margin_is_kept() -> None:
    checker = wall_with_a_gap(box(0.1, 0.6), margin=0.1)
    plan = plan_planar(checker, START, GOAL, bounds=SQUARE)
    exact = PlanarChecker(checker.world, checker.robot)
    # Between two checked states no point moves more than the resolution.
    assert prove_free(exact, plan.path).least > 0.1 - 0.02


def test_bounds_are_found_where_none_are_given() -> None:
    checker = checker_of(box(0.4, 0.4), ("block", box(1.0, 6.0), (0, 0, 0)))
    plan = plan_planar(checker, START, GOAL)
    assert plan.length > 6.0


def test_yaw_runs_the_short_way() -> None:
    plan = rrt_connect(lambda x, y, yaw: True, (0, 0, 3.0), (1, 0, -3.0), SQUARE)
    assert plan.path[-1, 2] == pytest.approx(2 * np.pi - 3.0)
    assert len(plan.path) == 2


def test_yaw_goes_on_from_the_start() -> None:
    plan = rrt_connect(lambda x, y, yaw: abs(x) > 0.1 or y > 1, (-1, 0, 9.0), (1, 0, 8.5), SQUARE)
    assert plan.path[0, 2] == pytest.approx(9.0)
    assert plan.path[-1, 2] % (2 * np.pi) == pytest.approx(8.5 % (2 * np.pi))


def test_nothing_is_printed(capfd: pytest.CaptureFixture[str]) -> None:
    for seed in (0, 1):
        plan_planar(wall_with_a_gap(), START, GOAL, bounds=SQUARE, seed=seed)
    assert capfd.readouterr() == ("", "")


# Failures say why --------------------------------------------------------------------------------


def test_start_and_goal_in_collision_name_the_body() -> None:
    checker = wall_with_a_gap()
    with pytest.raises(PlanningError, match=r"start: the body collides with wall 1$"):
        plan_planar(checker, (0.0, 1.5, 0.0), GOAL)
    with pytest.raises(PlanningError, match=r"goal: the body collides with wall -1 and wall 1$"):
        plan_planar(checker, START, (0.0, 0.0, 0.0))
    near = wall_with_a_gap(margin=0.3)
    with pytest.raises(PlanningError, match=r"wall 1 closer than 0\.3 m"):
        plan_planar(near, (-0.3, 1.5, 0.0), GOAL)


def test_no_path_ends_in_time_and_says_so() -> None:
    checker = checker_of(box(0.4, 0.4), ("barrier", box(0.1, 9.0), (0, 0, 0)))
    began = time.monotonic()
    with pytest.raises(PlanningError, match=r"no path .* within 0\.3 s .*time_limit"):
        plan_planar(checker, START, GOAL, bounds=SQUARE, time_limit=0.3)
    assert time.monotonic() - began < 5.0


def test_ends_outside_the_bounds_or_not_valid() -> None:
    with pytest.raises(PlanningError, match=r"goal .*3\.000.* outside the bounds"):
        rrt_connect(lambda x, y, yaw: True, START, (3, 0, 0), SQUARE)
    with pytest.raises(PlanningError, match=r"start .* is not valid"):
        rrt_connect(lambda x, y, yaw: x > 0, START, GOAL, SQUARE)


@pytest.mark.parametrize("error", [ZeroDivisionError, KeyboardInterrupt])
def test_an_error_in_the_checker_surfaces(error: type[BaseException]) -> None:
    calls = 0

    def valid(x: float, y: float, yaw: float) -> bool:
        nonlocal calls
        calls += 1
        if calls > 20:
            raise error("on purpose")
        return abs(x) > 0.1

    with pytest.raises(error, match="on purpose"):
        rrt_connect(valid, START, GOAL, SQUARE, time_limit=20.0)
    assert calls == 21  # it isn't asked again


def test_a_checker_may_return_what_numpy_calls_a_bool() -> None:
    plan = rrt_connect(lambda x, y, yaw: np.hypot(x, y) > 0.5, START, GOAL, SQUARE)  # type: ignore[arg-type]
    assert plan.length > 3.0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"bounds": [[0, 0], [0, 1]]}, "bounds"),
        ({"start": (0, 0)}, "start"),
        ({"goal": (0, np.nan, 0)}, "goal"),
        ({"resolution": 0.0}, "resolution"),
        ({"time_limit": -1.0}, "time_limit"),
        ({"seed": -1}, "seed"),
    ],
)
def test_bad_arguments(change: dict[str, object], message: str) -> None:
    good: dict[str, object] = {"start": START, "goal": GOAL, "bounds": SQUARE}
    with pytest.raises(ValueError, match=message):
        rrt_connect(lambda x, y, yaw: True, **{**good, **change})  # type: ignore[arg-type]


# The checker, and the proof ----------------------------------------------------------------------


def test_checker_says_the_same_one_by_one_and_in_batches() -> None:
    checker = wall_with_a_gap()
    places = np.random.default_rng(0).uniform((-1, -2, -4), (1, 2, 4), size=(500, 3))
    free = checker.free(places)
    assert 0.2 < free.mean() < 0.9
    assert [checker(*q) for q in places.tolist()] == free.tolist()
    assert [not checker.hits(q) for q in places] == free.tolist()


def test_proof_knows_the_clearance() -> None:
    """A cube that slides past another at 0.25 m."""
    checker = checker_of(box(1.0, 1.0), ("cube", box(1.0, 1.0), (0, 0, 0)))
    proof = prove_free(checker, [(-3.0, 1.25, 0.0), (3.0, 1.25, 0.0)])
    assert proof.proved
    assert 0.25 - 1e-4 <= proof.least <= 0.25
    assert proof.where[1] == 1.25
    assert proof.edges == 1


def test_a_path_that_is_not_proved_is_planned_anew() -> None:
    seen: list[Floats] = []

    def proof(path: Floats) -> bool:
        seen.append(path)
        return len(seen) == 2

    plan = rrt_connect(lambda x, y, yaw: True, START, GOAL, SQUARE, proof=proof)
    assert plan.path is seen[1]
    with pytest.raises(PlanningError, match="not free"):
        rrt_connect(lambda x, y, yaw: True, START, GOAL, SQUARE, proof=lambda path: False)


@pytest.mark.parametrize("seed", range(20))
def test_nothing_is_proved_that_fcl_sees_collide(seed: int) -> None:
    rng, checker = np.random.default_rng(seed), wall_with_a_gap()
    path = rng.uniform((-1, -1, -3), (1, 1, 3), size=(3, 3)) * (1, 0.3, 1)
    proof = prove_free(checker, path)
    assert not proof.proved or fcl_free(checker, path, 0.004)


def test_proof_stops_at_a_wall_thinner_than_any_step() -> None:
    sheet = trimesh.Trimesh([(0, -1, -1), (0, 1, -1), (0, 0, 1)], [[0, 1, 2]], process=False)
    with pytest.warns(UserWarning, match="watertight"):
        checker = checker_of(box(0.1, 0.1, 0.1), ("film", sheet, (0, 0, 0)))
    proof = prove_free(checker, [START, GOAL])
    assert not proof.proved
    assert proof.where[0] == pytest.approx(-0.05, abs=1e-5)


def test_proof_without_obstacles() -> None:
    proof = prove_free(checker_of(box(1.0, 1.0)), [START, GOAL])
    assert proof.proved
    assert proof.least == np.inf
