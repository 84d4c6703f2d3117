"""RRTConnect of the experiment: repeatable, certified, with errors that name the cause."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
import trimesh
from support.planar import Configuration, Fcl, box, planar_problem

from fgenv.paper import rrt_connect as module
from fgenv.paper.rrt_connect import rrt_connect
from fgenv.planners import Certificate, PlanningError, Problem, StateValidityChecker, certify

SQUARE = ((-2.0, -2.0), (2.0, 2.0))
START, GOAL = (-1.5, 0.0, 0.0), (1.5, 0.0, 0.0)


def wall_with_a_gap(
    robot: trimesh.Trimesh | None = None, goal: Configuration = GOAL, workspace: Any = SQUARE
) -> Problem:
    """A slab 0.9 m long that has to turn to pass a gap 0.5 m wide."""
    walls = {f"wall {s}": (box(0.1, 1.75), (0.0, s * 1.125, 0.0)) for s in (-1, 1)}
    return planar_problem(robot or box(0.2, 0.9), START, goal, walls, workspace)


def test_without_a_workspace_the_path_may_pass_around_all_bodies() -> None:
    block = {"block": (box(1.0, 6.0), (0.0, 0.0, 0.0))}
    plan = rrt_connect(planar_problem(box(0.4, 0.4), START, GOAL, block), START)
    assert plan.length > 6.0


@pytest.mark.parametrize("seed", range(4))
def test_plan_through_a_gap_is_free_by_fcl(seed: int) -> None:
    problem = wall_with_a_gap()
    plan = rrt_connect(problem, START, seed=seed)
    np.testing.assert_allclose(plan.path[[0, -1]], [START, GOAL], atol=1e-12)
    assert np.abs(np.diff(plan.path[:, 2])).max() <= np.pi
    assert (np.abs(plan.path[:, :2]) <= 2.0).all()
    assert plan.length == pytest.approx(
        np.linalg.norm(np.diff(plan.path[:, :2], axis=0), axis=1).sum()
    )
    assert 3.0 <= plan.length < 8.0
    assert Fcl(problem).free(plan.path, 0.004)


def test_same_seed_same_plan_and_other_seed_other_plan() -> None:
    plans = [rrt_connect(wall_with_a_gap(), START, seed=s) for s in (3, 3, 4, 0, 0)]
    assert plans[0].path.tobytes() == plans[1].path.tobytes()
    assert plans[0].checks == plans[1].checks
    assert plans[3].path.tobytes() == plans[4].path.tobytes()  # OMPL itself ignores seed 0
    assert plans[0].path.tobytes() != plans[2].path.tobytes()


def test_margin_is_kept() -> None:
    plan = rrt_connect(wall_with_a_gap(box(0.1, 0.6)), START, margin=0.1)
    # Between two checked states no point moves more than the resolution.
    assert plan.certificate.clearance > 0.1 - 0.02


def test_yaw_takes_the_shorter_direction_from_the_start() -> None:
    plan = rrt_connect(
        planar_problem(box(0.2, 0.2), START, (1.0, 0.0, -3.0), {}, SQUARE), (0, 0, 3)
    )
    assert plan.path[-1, 2] == pytest.approx(2 * np.pi - 3.0)
    assert len(plan.path) == 2
    start = (-1.0, 0.0, 9.0)
    plan = rrt_connect(wall_with_a_gap(goal=(1.0, 0.0, 8.5)), start)
    assert plan.path[0, 2] == pytest.approx(9.0)
    assert plan.path[-1, 2] % (2 * np.pi) == pytest.approx(8.5 % (2 * np.pi))


def test_nothing_is_printed(capfd: pytest.CaptureFixture[str]) -> None:
    for seed in (0, 1):
        rrt_connect(wall_with_a_gap(), START, seed=seed)
    assert capfd.readouterr() == ("", "")


# Failures ----------------------------------------------------------------------------------------


def test_start_and_goal_in_collision_name_the_body() -> None:
    with pytest.raises(PlanningError, match=r"start of 'robot': collides with wall 1, or"):
        rrt_connect(wall_with_a_gap(), (0.0, 1.5, 0.0))
    with pytest.raises(PlanningError, match=r"goal of 'robot': .* wall -1 and wall 1, or"):
        rrt_connect(wall_with_a_gap(goal=(0.0, 0.0, 0.0)), START)
    with pytest.raises(PlanningError, match=r"wall 1, or is closer than the margin of 0\.3 m"):
        rrt_connect(wall_with_a_gap(), (-0.3, 1.5, 0.0), margin=0.3)


def test_no_path_ends_in_time_and_says_so() -> None:
    barrier = {"barrier": (box(0.1, 9.0), (0.0, 0.0, 0.0))}
    problem = planar_problem(box(0.4, 0.4), START, GOAL, barrier, SQUARE)
    with pytest.raises(PlanningError, match=r"no path .* within 0\.3 s .*give more time"):
        rrt_connect(problem, START, time_limit=0.3)


@pytest.mark.parametrize("error", [ZeroDivisionError, KeyboardInterrupt])
def test_an_error_in_a_check_is_raised(
    error: type[BaseException], monkeypatch: pytest.MonkeyPatch
) -> None:
    class Checker(StateValidityChecker):
        error: BaseException | None = None

        def __init__(self, *args: Any, **options: Any) -> None:
            super().__init__(*args, **options)
            check, calls = self.isValid, itertools.count()

            def valid(state: Any) -> bool:
                if next(calls) == 20:
                    self.error = error("on purpose")
                return self.error is None and bool(check(state))

            self.isValid = valid

    monkeypatch.setattr(module, "StateValidityChecker", Checker)
    with pytest.raises(error, match="on purpose"):
        rrt_connect(wall_with_a_gap(), START, time_limit=20.0)


def test_a_path_that_is_not_certified_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    failed = Certificate(False, 0.0, 0.0, 1, 0)
    monkeypatch.setattr(module, "certify", lambda *_, **options: failed)
    with pytest.raises(PlanningError, match="not free between the checked states"):
        rrt_connect(wall_with_a_gap(), START)


# The certificate ---------------------------------------------------------------------------------


def test_certificate_has_the_clearance() -> None:
    """A cube that slides past another at 0.25 m."""
    cube = {"cube": (box(1.0, 1.0), (0.0, 0.0, 0.0))}
    ends = (-3.0, 1.25, 0.0), (3.0, 1.25, 0.0)
    certificate = certify(planar_problem(box(1.0, 1.0), *ends, cube), [np.linspace(*ends, 101)])
    assert certificate.proved
    assert 0.25 - 1e-4 <= certificate.clearance <= 0.25


@pytest.mark.parametrize("seed", range(20))
def test_no_path_is_certified_that_collides_by_fcl(seed: int) -> None:
    rng, problem = np.random.default_rng(seed), wall_with_a_gap()
    path = rng.uniform((-1, -1, -3), (1, 1, 3), size=(3, 3)) * (1, 0.3, 1)
    assert not certify(problem, [path]) or Fcl(problem).free(path, 0.004)


def test_certificate_fails_at_a_wall_thinner_than_any_step() -> None:
    sheet = trimesh.Trimesh([(0, -1, -1), (0, 1, -1), (0, 0, 1)], [[0, 1, 2]], process=False)
    with pytest.warns(UserWarning, match="watertight"):
        problem = planar_problem(box(0.1, 0.1, 0.1), START, GOAL, {"film": (sheet, (0, 0, 0))})
    certificate = certify(problem, [np.array([START, (-0.1, 0, 0), (0.1, 0, 0), GOAL])])
    assert not certificate.proved
    assert certificate.failed_step == 1


def test_certificate_without_obstacles() -> None:
    certificate = certify(planar_problem(box(1.0, 1.0), START, GOAL), [np.array([START, GOAL])])
    assert certificate.proved
    assert certificate.clearance == np.inf
