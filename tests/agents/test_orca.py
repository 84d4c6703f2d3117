"""ORCA: the native solution against an independent one, and episodes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize

from fgenv import _core
from fgenv.agents import OrcaPolicy, run_episode
from fgenv.agents.evaluation.case_runner import run_cases
from fgenv.envs import Simulator, View, policy_of
from fgenv.robots.footprint import enclosing_radius
from fgenv.scenarios import Scenario, frozen

HORIZON, DT = 2.0, 0.1
SETTINGS: dict[str, Any] = {
    "horizon": HORIZON,
    "point_horizon": HORIZON,
    "dt": DT,
    "range": 100.0,
    "threads": None,
}


def solved(discs: Any, expected: Any, speeds: Any, points: Any = None) -> Any:
    """Return velocities of one world, (discs, 2)."""
    rows = np.asarray(discs, dtype=np.float64)[None]
    if points is None:
        points = np.full((1, rows.shape[1], 0, 2), np.nan)
    speeds = np.broadcast_to(speeds, rows.shape[:2])
    return _core.orca(rows, [expected], speeds, points=points, **SETTINGS)[0]


def inside(v: np.ndarray, p: np.ndarray, r: float) -> bool:
    """Whether a relative velocity leads to contact within the horizon, by the definition."""
    t = np.clip(np.dot(p, v) / max(np.dot(v, v), 1e-300), 0.0, HORIZON)
    return bool(np.linalg.norm(p - t * v) < r)


def nearest_exit(v: np.ndarray, p: np.ndarray, r: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the least change of v to the border of the cone, by search, and the normal there."""
    now = inside(v, p, r)

    def crossing(angle: float) -> float:
        u = np.array([math.cos(angle), math.sin(angle)])
        steps = np.linspace(0.0, 2.5, 100)
        states = [inside(v + s * u, p, r) != now for s in steps]
        if not any(states):
            return math.inf
        k = int(np.argmax(states))
        low, high = steps[k - 1], steps[k]
        for _ in range(40):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if inside(v + middle * u, p, r) != now else (middle, high)
        return float(high)

    rough = np.linspace(-math.pi, math.pi, 121)
    best = rough[int(np.argmin([crossing(angle) for angle in rough]))]
    fine = np.linspace(best - 0.06, best + 0.06, 121)
    lengths = [crossing(angle) for angle in fine]
    k = int(np.argmin(lengths))
    n = np.array([math.cos(fine[k]), math.sin(fine[k])])
    return lengths[k] * n, n if now else -n


def test_two_discs_follow_the_definition() -> None:
    rng = np.random.default_rng(0)
    for _ in range(3):
        p, v = rng.uniform(0.9, 3.0) * unit(rng), 0.8 * unit(rng)
        u, n = nearest_exit(v, p, 0.8)
        discs = [[0, 0, *v, 0.4, 0], [*p, 0, 0, 0.4, 0]]
        expected = v - 0.5 * n + 0.2 * np.array([n[1], -n[0]])
        (found, _) = solved(discs, [expected, [0, 0]], 5.0)
        point = v + 0.5 * u
        short = max(0.0, float(np.dot(point - expected, n)))
        np.testing.assert_allclose(found, expected + short * n, atol=2e-3)


def unit(rng: np.random.Generator) -> np.ndarray:
    """Return a random direction."""
    angle = rng.uniform(-math.pi, math.pi)
    return np.array([math.cos(angle), math.sin(angle)])


def half_planes(discs: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return the half-planes of the first disc with each other, from its answer to a far one."""
    found = []
    for other in discs[1:]:
        ends = []
        for k in range(16):
            angle = 2 * math.pi * k / 16
            expected = 50.0 * np.array([math.cos(angle), math.sin(angle)])
            v = solved([discs[0], other], [expected, [0, 0]], 1e3)[0]
            if np.linalg.norm(v - expected) > 1e-9:
                ends.append((v, (v - expected) / np.linalg.norm(v - expected)))
        found.append(ends[0])
    return found


def projected(expected: np.ndarray, speed: float, planes: Any) -> np.ndarray | None:
    """Return the allowed velocity closest to the preferred one by SciPy; None if there is none."""
    limits: list[Any] = [{"type": "ineq", "fun": lambda v: speed**2 - v @ v}]
    limits += [{"type": "ineq", "fun": lambda v, p=p, n=n: (v - p) @ n} for p, n in planes]
    best = minimize(lambda v: ((v - expected) ** 2).sum(), np.zeros(2), constraints=limits)
    kept = best.success and all(limit["fun"](best.x) > -1e-6 for limit in limits)
    return best.x if kept else None


def test_many_discs_equal_a_quadratic_program() -> None:
    rng, compared = np.random.default_rng(1), 0
    for _ in range(12):
        discs = np.zeros((5, 6))
        discs[:, :2], discs[:, 2:4] = rng.uniform(-4, 4, (5, 2)), rng.uniform(-1, 1, (5, 2))
        discs[0, :2], discs[:, 4] = 0, 0.3
        expected = rng.uniform(-1.0, 1.0, 2)
        best = projected(expected, 1.2, half_planes(discs))
        if np.linalg.norm(discs[1:, :2], axis=1).min() > 0.7 and best is not None:
            found = solved(discs, [expected, *np.zeros((4, 2))], 1.2)[0]
            np.testing.assert_allclose(found, best, atol=1e-3)
            compared += 1
    assert compared >= 6


def test_a_single_disc_takes_its_preferred_velocity_within_its_limit() -> None:
    np.testing.assert_array_equal(solved([[0, 0, 0, 0, 1, 0]], [[0.3, 0.4]], 1.0), [[0.3, 0.4]])
    np.testing.assert_allclose(solved([[0, 0, 0, 0, 1, 0]], [[3, 4]], 1.0), [[0.6, 0.8]])


def test_a_moving_disc_takes_all_avoidance_of_parked_discs_and_points() -> None:
    me = [0, 0, 1, 0, 0.5, 0]
    resting = solved([me, [1.5, 0.1, 0, 0, 0.5, 1]], [[1, 0], [0, 0]], 1.0)[0]
    shared = solved([me, [1.5, 0.1, 0, 0, 0.5, 0]], [[1, 0], [0, 0]], 1.0)[0]
    assert resting[0] < shared[0] < 1
    assert not inside(resting * (1 - 1e-6), np.array([1.5, 0.1]), 1.0)
    points = np.array([[[[1.0, 0.0], [np.nan, np.nan]]]])
    stopped = solved([me], [[1, 0]], 1.0, points)[0]
    assert not inside(stopped * (1 - 1e-6), np.array([1.0, 0.0]), 0.5)


def test_infeasible_constraints_minimize_the_largest_violation() -> None:
    walls = [
        [0.9 * math.cos(a), 0.9 * math.sin(a), 0, 0, 0.5, 1] for a in np.arange(4) * math.pi / 2
    ]
    (v, *_) = solved([[0, 0, 0, 0, 0.5, 0], *walls], [[1, 0], *np.zeros((4, 2))], 1.0)
    np.testing.assert_allclose(v, 0.0, atol=1e-9)


def test_mirrored_discs_give_mirrored_velocities() -> None:
    rng = np.random.default_rng(2)
    discs = np.array([[*rng.uniform(-3, 3, 2), *rng.uniform(-1, 1, 2), 0.2, 0] for _ in range(6)])
    expected, turned = rng.uniform(-1, 1, (6, 2)), discs.copy()
    turned[:, [1, 3]] *= -1
    np.testing.assert_allclose(
        solved(turned, expected * [1, -1], 1.0), solved(discs, expected, 1.0) * [1, -1], atol=1e-9
    )


@pytest.mark.parametrize("n", [4, 8])
def test_jittered_swap_is_solved(n: int) -> None:
    """Discs of 0.3 m, differential drives of 1 m/s, circle of 4 m, jitter 0.2 m, 60 s."""
    cases = frozen("swap", n=n, jitter=0.2, cases=10)
    found = run_cases(cases, OrcaPolicy(), range(10), clearance=False)
    assert np.mean([episode.success for episode in found]) >= 0.9
    assert sum(sum(episode.robot_collisions) for episode in found) <= 2


def test_holonomic_discs_pass_each_other() -> None:
    scenario = Scenario.load("swap", n=6, seed=1, jitter=0.2)
    model = scenario.models["disc"]
    drive = {"kind": "holonomic", "speed": 1.0, "turn_rate": 2.0}
    changed = model.model_validate({**model.model_dump(), "drive": drive})
    scenario = scenario.model_copy(update={"models": {"disc": changed}})
    simulator = Simulator(scenario, autoreset=False)
    run_episode(simulator, OrcaPolicy())
    assert (simulator.arrival_steps >= 0).all()
    assert simulator.collision_counts.sum() == 0


@pytest.mark.parametrize("name", ["doorway", "intersection", "random", "warehouse"])
def test_actions_for_every_scenario_with_planar_bases(name: str) -> None:
    simulator = Simulator(name, 2, n=3)
    policy, rows = policy_of("orca"), simulator.reset(seed=0)
    policy.reset(View(simulator))
    for _ in range(20):
        actions = policy.act(rows)
        assert (np.abs(actions) <= 1).all()
        rows = simulator.step(actions).observations
    assert (simulator.traveled > 0).any()


def test_a_turning_holonomic_base_follows_the_preferred_velocity() -> None:
    """Regression: the direction was off by half of the turn in a step, up to 0.1 rad."""
    scenario = Scenario.load("random", n=1, fill=0.0, drive="holonomic")
    simulator = Simulator(scenario)
    simulator.reset()
    policy = OrcaPolicy()
    policy.reset(View(simulator))
    simulator.place(0, 0, [-2.0, -1.0, 2.5], [2.0, 1.0, 0.0])
    turned = 0.0
    for _ in range(20):
        before = simulator.configurations[0, 0]
        to = simulator.goals[0, 0] - before
        simulator.step(policy.act(simulator.observe()))
        by = simulator.configurations[0, 0] - before
        turned += abs(by[2])
        assert math.atan2(by[1], by[0]) == pytest.approx(math.atan2(to[1], to[0]), abs=1e-6)
    assert turned > 1.0


def test_removed_robots_hide_no_lidar_points() -> None:
    """Robots vanish at their goals; walls near a vanished robot remain visible."""
    scenario = Scenario.load("random", n=2, seed=0, at_goal="vanish")
    first = scenario.robots[0]
    here = first.model_copy(update={"goal": first.start})
    scenario = scenario.model_copy(update={"robots": (here, scenario.robots[1])})
    simulator = Simulator(scenario, autoreset=False)
    policy, rows = OrcaPolicy(), simulator.reset(seed=0)
    policy.reset(View(simulator))
    q, beside = simulator.configurations, np.array([0.1, 0.0])

    def left() -> bool:
        point = (q[:, 0, None, :2] + beside).copy()
        policy._remove_robots(1, point, q)
        return bool(np.isfinite(point).all())

    assert not left()
    simulator.step(policy.act(rows))
    assert policy.view.present.tolist() == [[False, True]]
    assert left()


def test_the_disc_encloses_the_body() -> None:
    simulator = Simulator("swap", n=3)
    assert enclosing_radius(simulator.robots[0]) == pytest.approx(0.3, abs=3e-3)
    long = Simulator("swap", n=3, body="long")
    assert enclosing_radius(long.robots[0]) == pytest.approx(math.hypot(0.6, 0.15), abs=1e-6)


def test_robots_without_a_planar_base_raise() -> None:
    for name in ("forest", "cell"):
        simulator = Simulator(name, n=2)
        simulator.reset(seed=0)
        with pytest.raises(ValueError, match="expected discs on a plane"):
            OrcaPolicy().reset(View(simulator))


def test_invalid_arguments_raise() -> None:
    with pytest.raises(ValueError, match=r"discs: got shape \(3,\), expected \(worlds, discs, 6\)"):
        _core.orca(np.zeros(3), [], [], points=[], **SETTINGS)
    points = np.zeros((1, 1, 0, 2))
    with pytest.raises(ValueError, match="horizon: got 0"):
        _core.orca(
            np.zeros((1, 1, 6)),
            np.zeros((1, 1, 2)),
            [[1]],
            points=points,
            **SETTINGS | {"horizon": 0},
        )
    with pytest.raises(ValueError, match="preferred: got shape"):
        _core.orca(np.zeros((1, 1, 6)), np.zeros((1, 2)), [[1]], points=points, **SETTINGS)


def test_shortest_paths_lead_through_clutter() -> None:
    cases = frozen("random", cases=4, n=4, drive="holonomic")
    shares = []
    for name in ("orca", "orca:shortest"):
        found = run_cases(cases, policy_of(name), range(4), clearance=False, max_steps=300)
        shares.append(np.mean([robot.success for e in found for robot in e.results.robots]))
    assert shares[1] == 1.0
    assert shares[0] < 0.9
