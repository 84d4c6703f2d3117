"""Cheapest paths over grids, and path hints that follow them."""

from __future__ import annotations

import copy
import itertools
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles.global_planner import Planner
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra
from support.robots import random_tree

from fgenv import _core
from fgenv.agents.policies.orca import OrcaPolicy
from fgenv.arrays import Floats, Floats32, Ints
from fgenv.envs import Observation, Simulator, View, policy_of
from fgenv.envs.state_readers import MOVING, PARKED
from fgenv.robots.footprint import enclosing_discs, footprint
from fgenv.scenarios import Scenario

Cell = tuple[int, int, int]
HINT = Observation(path_hint=True, path="shortest", look_ahead=0.5)


def graph(costs: Ints) -> csr_matrix:
    """Return the steps of a grid as a sparse graph."""
    layers, rows, columns = costs.shape
    number = np.arange(costs.size).reshape(costs.shape)
    tails: list[int] = []
    heads: list[int] = []
    weights: list[float] = []

    def step(here: Cell, there: Cell, length: float) -> None:
        tails.append(number[here])
        heads.append(number[there])
        weights.append(costs[there] * length)

    for k, r, c in np.argwhere(costs).tolist():
        for heading in range(8) if layers == 1 else [k]:
            dr, dc = (round(math.sqrt(2) * f(heading * math.pi / 4)) for f in (math.cos, math.sin))
            beside = [(r + dr, c + dc), (r + dr, c), (r, c + dc)]
            inside = all(0 <= i < rows and 0 <= j < columns for i, j in beside)
            if inside and all(costs[k, i, j] for i, j in beside):
                step((k, r, c), (k, r + dr, c + dc), math.hypot(dr, dc))
        for turn in (-1, 1) if layers > 1 else ():
            if costs[(k + turn) % 8, r, c]:
                step((k, r, c), ((k + turn) % 8, r, c), 1.0)
    return csr_matrix((weights, (tails, heads)), (costs.size, costs.size))


@given(
    st.integers(0, 10**6),
    st.sampled_from([1, 8]),
    st.integers(1, 12),
    st.integers(1, 12),
    st.floats(0, 0.6),
)
def test_paths_are_as_cheap_as_dijkstra_s(
    seed: int, layers: int, rows: int, columns: int, walls: float
) -> None:
    rng = np.random.default_rng(seed)
    shape = layers, rows, columns
    costs = rng.choice([1, 2, 3], shape)
    costs[rng.random(shape) < walls] = 0
    start, goal = rng.integers(0, shape), rng.integers(0, shape)
    costs[tuple(start)] = costs[tuple(goal)] = 1
    path = _core.cheapest_path(costs, start, goal)
    steps, number = graph(costs), np.arange(costs.size).reshape(shape)
    best = dijkstra(steps, indices=number[tuple(start)])[number[tuple(goal)]]
    if not len(path):
        assert math.isinf(best)
        return
    assert (path[0] == start).all()
    assert (path[-1] == goal).all()
    each = [steps[a, b] for a, b in itertools.pairwise(number[tuple(path.T)])]
    assert all(cost > 0 for cost in each)  # only steps of the grid
    assert math.fsum(each) == pytest.approx(best, rel=1e-12)


@pytest.mark.parametrize(
    ("costs", "start", "message"),
    [
        ([[1, 2]], (0, 0, 0), "costs: got shape"),
        ([[[1]]] * 2, (0, 0, 0), r"costs: got shape \(2, 1, 1\), expected \(1 or 8"),
        ([[[256]]], (0, 0, 0), r"costs\[0, 0, 0\]: got 256, expected 0 \(closed\) to 255"),
        ([[[-1]]], (0, 0, 0), "got -1, expected 0"),
        ([[[0.5]]], (0, 0, 0), "costs: got dtype float64, expected int64"),
        ([[[1]]], (0, 0, 1), r"start\[2\]: got 1, expected 0 to 0"),
        ([[[1]]], (0, -1, 0), r"start\[1\]: got -1, expected 0 to 0"),
        ([[[1]]], (0, 0), "start: got shape"),
    ],
)
def test_invalid_grids_are_errors(costs: Any, start: tuple[int, ...], message: str) -> None:
    with pytest.raises((ValueError, TypeError), match=message):
        _core.cheapest_path(costs, start, (0, 0, 0))


def check_new_paths(simulator: Simulator) -> int:
    """Compare new paths with the oracle's; returns the number of parked robots."""
    parked = (simulator.arrival_steps == simulator.steps[:, None]).any(axis=1)
    worlds = np.flatnonzero(parked | (simulator.steps == 0)).tolist()
    for world in worlds:
        for i, path in Planner(simulator, world).paths().items():
            np.testing.assert_array_equal(simulator.path(world, i), path)
    return int((simulator.status[worlds] == PARKED).sum())


@pytest.mark.parametrize(
    ("name", "options", "arrivals"),
    [
        ("random", {"cases": 3, "n": 6, "drive": "holonomic"}, 3),
        ("random", {"n": 5, "starts": "random"}, 2),
        ("doorway", {"cases": 3, "n": 5}, 0),
        ("intersection", {"cases": 3, "n": 4}, 0),
        ("warehouse", {"n": 6}, 1),
    ],
)
def test_paths_equal_the_oracle_s_while_robots_park(
    name: str, options: dict[str, Any], arrivals: int
) -> None:
    simulator = Simulator(name, 2, observation=HINT, max_steps=150, **options)
    rng = np.random.default_rng(0)
    simulator.reset(seed=3)
    goal = simulator.goals[0, 0]
    behind = goal - [0.3 * math.cos(goal[2]), 0.3 * math.sin(goal[2]), 0.0]
    simulator.place(0, 0, behind, goal)  # the first to park
    rows, parked = simulator.observe(), check_new_paths(simulator)
    for _ in range(160):
        rows = simulator.step(follow_hints(simulator, rows, rng)).observations
        parked = max(parked, check_new_paths(simulator))
    assert parked > arrivals


def follow_hints(simulator: Simulator, rows: Floats32, rng: np.random.Generator) -> Floats:
    """Return actions toward the path hints, with noise."""
    hint = next(part for part in simulator.layouts[0] if part.name == "path_hint").slice
    targets, ahead = simulator.configurations, rows[..., hint].astype(float)
    cosine, sine = np.cos(targets[..., 2]), np.sin(targets[..., 2])
    x = cosine * ahead[..., 0] - sine * ahead[..., 1]
    y = sine * ahead[..., 0] + cosine * ahead[..., 1]
    targets[..., :3] += np.stack([x, y, np.arctan2(y, x) - targets[..., 2]], axis=-1)
    close = simulator.remaining < 0.4
    targets[close] = simulator.goals[close]
    return simulator.toward(targets) + 0.2 * simulator.sample(rng)


def paths_of(simulator: Simulator, world: int) -> dict[int, Floats]:
    """Return the paths of all robots of a world; after a reset all move."""
    return {i: simulator.path(world, i) for i in range(simulator.n_robots)}


@pytest.mark.parametrize("name", ["random", "doorway"])
def test_paths_lead_to_the_goal_and_through_no_wall(name: str) -> None:
    simulator = Simulator(name, 3, cases=3, case_order="seed", n=4, observation=HINT)
    simulator.reset(seed=0)
    waiting = 0  # robots that would block another one's only path
    for world in range(3):
        alone = simulator.built.world(robots=False)
        alone.set_pose(list(simulator.built.names), simulator.static_poses(world))
        me = simulator.built.add_robot(alone, 0, simulator.configurations[world, 0])
        for i, path in paths_of(simulator, world).items():
            assert (path[0] == simulator.configurations[world, i]).all()
            if (path[-1] == path[0]).all():
                waiting += 1
                continue
            assert (path[-1] == simulator.goals[world, i]).all()
            dense = simulator.robots[i].interpolate(
                path[:-1, None], path[1:, None], np.linspace(0, 1, 20)[None]
            )
            # Cells are open at their middles: between them a disc of 0.3 m may graze a corner.
            assert np.mean(alone.collides(me, dense)) < 0.02
    assert waiting <= 6  # of 12


def test_the_hint_leads_through_the_door() -> None:
    simulator = Simulator("doorway", n=2, drive="holonomic", observation=HINT)
    simulator.reset(seed=0)
    q = np.zeros(3)
    q[:2] = -2.0, 1.5
    goal = np.array([2.0, 1.5, 0.0])
    simulator.place(0, 0, q, goal)
    part = next(part for part in simulator.layouts[0] if part.name == "path_hint")
    x, y = simulator.observe()[0, 0, part.slice]
    assert x > 0
    assert y < -0.1
    assert math.hypot(x, y) == pytest.approx(0.5, abs=0.1)


def test_a_long_robot_looks_along_its_path() -> None:
    # A car of 2.5 m can turn on the spot only in the middle of a road of 4 m.
    simulator = Simulator("intersection", 5, cases=5, case_order="seed", n=4, observation=HINT)
    simulator.reset(seed=0)
    alone = simulator.built.world(robots=False)
    me = simulator.built.add_robot(alone, 0, simulator.configurations[0, 0])
    for path in itertools.chain(*(paths_of(simulator, w).values() for w in range(5))):
        ahead = np.diff(path[:, :2], axis=0)
        path[:-1, 2] = np.arctan2(ahead[:, 1], ahead[:, 0])
        for a, b in itertools.pairwise(path):
            q = np.linspace(a, [*b[:2], a[2]], 20)
            assert np.mean(alone.collides(me, q)) < 0.1


def test_paths_lead_around_parked_robots() -> None:
    scenario = Scenario.load("random", n=2, fill=0.0, drive="holonomic")
    simulator = Simulator(scenario, observation=HINT, autoreset=False)
    simulator.reset()
    simulator.place(0, 0, [-2.0, 0.0, 0.0], [2.0, 0.0, 0.0])
    simulator.place(0, 1, [0.0, 0.5, 0.0], [0.0, 0.0, 0.0])
    hint = next(part for part in simulator.layouts[0] if part.name == "path_hint").slice
    assert np.allclose(simulator.observe()[0, 0, hint], [0.5, 0.0])
    while simulator.status[0, 1] == MOVING:
        action = simulator.toward(simulator.goals)
        action[0, 0] = 0.0
        rows = simulator.step(action).observations
    assert abs(rows[0, 0, hint][1]) > 0.01  # it was 0 on the straight line before
    assert (rows == simulator.observe()).all()
    path, other = simulator.path(0, 0), simulator.configurations[0, 1]
    dense = np.concatenate([np.linspace(a, b, 50) for a, b in itertools.pairwise(path)])
    apart = 2.0 * math.hypot(0.306, 0.35)  # two balls that hold a disc 0.35 m high
    assert np.hypot(*(dense - other)[:, :2].T).min() > apart - 0.1  # except at corners


def test_a_robot_that_would_block_the_door_waits_for_the_other() -> None:
    policy = policy_of("orca:shortest")
    assert isinstance(policy, OrcaPolicy)
    scenario = Scenario.load("doorway", n=2, drive="holonomic")
    simulator = Simulator(scenario, observation=policy.observation, autoreset=False)
    simulator.reset()
    simulator.place(0, 0, [-2.0, 0.0, 0.0], [2.0, 1.0, 0.0])
    waiting = [2.0, -1.0, 0.7]
    simulator.place(0, 1, waiting, [-0.4, 0.0, 0.0])
    policy.reset(View(simulator))
    hint = next(part for part in simulator.layouts[0] if part.name == "path_hint").slice
    rows = simulator.observe()
    while simulator.status[0, 0] == MOVING:
        assert np.linalg.norm(rows[0, 0, hint]) > 0.1
        assert (rows[0, 1, hint] == 0.0).all()
        rows = simulator.step(policy.act(rows)).observations
    np.testing.assert_allclose(simulator.configurations[0, 1], waiting, atol=1e-6)
    assert np.linalg.norm(rows[0, 1, hint]) > 0.1


WEST, EAST = [-2.0, 0.0, 0.0], [2.0, 0.0, 0.0]  # of the door


@pytest.mark.parametrize(
    ("ends", "waiting"),
    [
        ([(WEST, [0.4, 0.0, 0.0]), (EAST, [-0.4, 0.0, 0.0])], {0}),  # each would block the other
        (
            [(WEST, [2.2, 1.0, 0.0]), ([2.2, 1.2, 0.0], [-2.0, 1.0, 0.0])],
            {0},
        ),  # taken by robot 1
        ([(WEST, EAST), (EAST, WEST)], set()),  # each stands on the other's goal
        ([(WEST, [1.0, 1.0, 0.0]), (EAST, [-1.0, 1.0, 0.0])], set()),
    ],
)
def test_a_robot_waits_if_parking_would_block_the_other(
    ends: list[tuple[list[float], list[float]]], waiting: set[int]
) -> None:
    simulator = Simulator(Scenario.load("doorway", n=2, drive="holonomic"), observation=HINT)
    simulator.reset()
    for i, (start, goal) in enumerate(ends):
        simulator.place(0, i, start, goal)
    paths = paths_of(simulator, 0)
    assert {i for i, path in paths.items() if (path[0] == path[-1]).all()} == waiting


@pytest.mark.parametrize(
    ("name", "given", "row"),
    [
        ("intersection", {}, True),
        ("swap", {"body": "long"}, True),
        ("swap", {"body": "l"}, False),
        ("doorway", {}, False),
        ("warehouse", {}, True),
    ],
)
def test_discs_enclose_the_robot(name: str, given: dict[str, Any], row: bool) -> None:
    robot = Scenario.load(name, n=2, **given).build().robots[0]
    centers, radius = enclosing_discs(robot)
    assert (len(centers) > 1) == row
    points = footprint(robot)
    far = np.hypot(points[:, :1] - centers, points[:, 1:])
    assert far.min(axis=1).max() <= radius + 1e-9


def test_one_disc_encloses_all_links_of_an_arm_on_wheels(monkeypatch: pytest.MonkeyPatch) -> None:
    base = np.array([[-2.0, -0.5], [2.0, -0.5], [2.0, 0.5], [-2.0, 0.5]])
    monkeypatch.setattr("fgenv.robots.footprint.footprint", lambda robot: base)
    rng = np.random.default_rng(0)
    trees = [random_tree(rng, "planar") for _ in range(20)]
    arms = [robot for robot in trees if any(link.shapes for link in robot.links[1:])]
    assert len(arms) > 10
    for robot in arms:
        centers, radius = enclosing_discs(robot)
        assert centers.tolist() == [0.0]
        assert radius == robot.reach[robot.root]


def test_a_parked_robot_closes_the_cells_where_discs_overlap() -> None:
    simulator = Simulator("intersection", n=2, drive="holonomic", observation=HINT)
    simulator.reset()
    planner, at = Planner(simulator, 0), np.array([1.0, -0.5, 0.4])
    grid = planner.empty_grid(0)
    _, closed = planner.taken(0, grid, 1, at)
    centers, radius = planner.discs[0]
    assert len(centers) > 1
    for layer, a, b in np.ndindex(closed.shape):
        q = [grid.axis(0)[a], grid.axis(1)[b], layer * math.pi / 4]
        mine, other = (
            [(x + c * math.cos(t), y + c * math.sin(t)) for c in centers] for x, y, t in (q, at)
        )
        far = min(math.dist(p, o) for p in mine for o in other)
        assert closed[layer, a, b] == (far < 2 * radius)


@pytest.mark.parametrize("n", [2, 3])
def test_robots_that_swap_places_do_not_wait_for_each_other(n: int) -> None:
    scenario = Scenario.load("random", n=n, fill=0.0, drive="holonomic")
    policy = policy_of("orca:shortest")
    assert isinstance(policy, OrcaPolicy)
    simulator = Simulator(scenario, observation=policy.observation, autoreset=False)
    simulator.reset()
    turns = 2 * math.pi / n * np.arange(n)
    places = np.column_stack([np.cos(turns), np.sin(turns) + 0.1 * turns, turns])
    for i in range(n):
        simulator.place(0, i, places[i], places[(i + 1) % n])
    policy.reset(View(simulator))
    rows, over = simulator.observe(), False
    while not over:
        step = simulator.step(policy.act(rows))
        rows, over = step.observations, bool(step.terminated[0] or step.truncated[0])
    assert (simulator.status == PARKED).all()


def test_a_robot_that_vanishes_at_its_goal_blocks_no_path() -> None:
    scenario = Scenario.load("doorway", n=2).model_copy(update={"at_goal": "vanish"})
    simulator = Simulator(scenario, observation=HINT)
    simulator.reset()
    simulator.place(0, 0, [-2.0, 0.0, 0.0], [2.0, 1.0, 0.0])
    simulator.place(0, 1, [2.0, -1.0, 0.0], [-0.4, 0.0, 0.0])
    path = simulator.path(0, 1)
    assert (path[0] != path[-1]).any()


def test_a_robot_parked_on_the_other_lane_blocks_no_road() -> None:
    """A single enclosing disc of a parked car of 2.5 m would block the road."""
    seen = Observation(path_hint=True, path="shortest", look_ahead=1.5)
    scenario = Scenario.load("intersection", n=2, drive="holonomic", jitter=0.0)
    simulator = Simulator(scenario, observation=seen, autoreset=False)
    simulator.reset()
    simulator.place(0, 1, [4.9, -1.0, 0.0], [5.0, -1.0, 0.0])
    simulator.place(0, 0, [7.0, 1.0, math.pi], [-5.0, 1.0, math.pi])
    while simulator.status[0, 1] == MOVING:
        action = simulator.toward(simulator.goals)
        action[0, 0] = 0.0
        simulator.step(action)
    path = simulator.path(0, 0)
    assert np.abs(path[:, 1] - 1.0).max() < 0.5


def test_copies_with_shortest_paths_continue_identically() -> None:
    simulator = Simulator("random", 2, cases=3, n=4, observation=HINT)
    simulator.reset(seed=1)
    rng = np.random.default_rng(0)
    actions = [simulator.sample(rng) for _ in range(40)]
    other = copy.deepcopy(simulator)
    for action in actions:
        assert (simulator.step(action).observations == other.step(action).observations).all()


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("forest", {}, "expected a robot with a planar base"),
        ("swap", {"actions": "way_points"}, "each way point is a path of its own"),
    ],
)
def test_shortest_paths_need_planar_bases_and_drive_actions(
    name: str, options: dict[str, Any], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        Simulator(name, observation=HINT, **options)


def test_an_unknown_path_is_an_error() -> None:
    with pytest.raises(ValueError, match="path: got 'curved', expected straight or shortest"):
        Observation(path="curved")
