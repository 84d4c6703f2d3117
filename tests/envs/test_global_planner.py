"""Shortest ways over grids, and the path hint that follows them."""

import copy
import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra
from support.robots import random_tree

from fgenv import _core
from fgenv.envs import Observation, Simulator, View, policy_of
from fgenv.envs.state_readers import MOVING, PARKED
from fgenv.robots.footprint import enclosing_discs, footprint
from fgenv.scenarios import Scenario

HINT = Observation(path_hint=True, path="shortest", look_ahead=0.5)


def graph(prices):
    """The steps of a grid, as scipy has graphs."""
    layers, rows, columns = prices.shape
    number = np.arange(prices.size).reshape(prices.shape)
    tails, heads, costs = [], [], []

    def step(here, there, length):
        tails.append(number[here])
        heads.append(number[there])
        costs.append(prices[there] * length)

    for k, r, c in np.argwhere(np.isfinite(prices)).tolist():
        for heading in range(8) if layers == 1 else [k]:
            dr, dc = (round(math.sqrt(2) * f(heading * math.pi / 4)) for f in (math.cos, math.sin))
            beside = [(r + dr, c + dc), (r + dr, c), (r, c + dc)]
            inside = all(0 <= i < rows and 0 <= j < columns for i, j in beside)
            if inside and all(math.isfinite(prices[k, i, j]) for i, j in beside):
                step((k, r, c), (k, r + dr, c + dc), math.hypot(dr, dc))
        for turn in (-1, 1) if layers > 1 else ():
            if math.isfinite(prices[(k + turn) % 8, r, c]):
                step((k, r, c), ((k + turn) % 8, r, c), 1.0)
    return csr_matrix((costs, (tails, heads)), (prices.size, prices.size))


@given(
    st.integers(0, 10**6),
    st.sampled_from([1, 8]),
    st.integers(1, 12),
    st.integers(1, 12),
    st.floats(0, 0.6),
)
def test_a_way_costs_what_dijkstra_says(seed, layers, rows, columns, walls):
    rng = np.random.default_rng(seed)
    shape = layers, rows, columns
    prices = rng.choice([1.0, 2.0, 3.5], shape)
    prices[rng.random(shape) < walls] = math.inf
    start, goal = rng.integers(0, shape), rng.integers(0, shape)
    prices[tuple(start)] = prices[tuple(goal)] = 1.0
    way = _core.cheapest_way(prices, start, goal)
    steps, number = graph(prices), np.arange(prices.size).reshape(shape)
    best = dijkstra(steps, indices=number[tuple(start)])[number[tuple(goal)]]
    if not len(way):
        assert math.isinf(best)
        return
    assert (way[0] == start).all()
    assert (way[-1] == goal).all()
    each = [steps[a, b] for a, b in itertools.pairwise(number[tuple(way.T)])]
    assert all(cost > 0 for cost in each)  # only steps that there are
    assert math.fsum(each) == pytest.approx(best, rel=1e-12)


@pytest.mark.parametrize(
    ("prices", "start", "told"),
    [
        ([[1.0, 2.0]], (0, 0, 0), "prices: shape"),
        ([[[1.0]]] * 2, (0, 0, 0), r"prices: shape \(2, 1, 1\), expected \(1 or 8"),
        ([[[0.5]]], (0, 0, 0), r"prices\[0, 0, 0\] is 0.5, expected 1 or more"),
        ([[[math.nan]]], (0, 0, 0), "expected 1 or more"),
        ([[[1.0]]], (0, 0, 1), r"start\[2\] is 1, outside"),
        ([[[1.0]]], (0, -1, 0), r"start\[1\] is -1, outside"),
        ([[[1.0]]], (0, 0), "start: shape"),
    ],
)
def test_what_is_no_grid_is_told(prices, start, told):
    with pytest.raises(ValueError, match=told):
        _core.cheapest_way(prices, start, (0, 0, 0))


@pytest.mark.parametrize("name", ["random", "doorway"])
def test_paths_lead_to_the_goal_and_through_no_wall(name):
    simulator = Simulator(name, 3, cases=3, case_order="seed", n=4, observation=HINT)
    simulator.reset(seed=0)
    waiting = 0  # for others whose only way they would shut
    for world in range(3):
        alone = simulator.built.world(robots=False)
        alone.set_pose(list(simulator.built.names), simulator.standing_poses(world))
        me = simulator.built.add_robot(alone, 0, simulator.configurations[world, 0])
        for i, path in simulator._guide.paths(world).items():
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


def test_the_hint_of_a_doorway_is_the_door_and_not_the_wall():
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


def test_who_is_long_looks_along_its_path():
    # A car of 2.5 m turns on the spot in the middle of a road of 4 m alone.
    simulator = Simulator("intersection", 5, cases=5, case_order="seed", n=4, observation=HINT)
    simulator.reset(seed=0)
    alone = simulator.built.world(robots=False)
    me = simulator.built.add_robot(alone, 0, simulator.configurations[0, 0])
    for path in itertools.chain(*(simulator._guide.paths(w).values() for w in range(5))):
        ahead = np.diff(path[:, :2], axis=0)
        path[:-1, 2] = np.arctan2(ahead[:, 1], ahead[:, 0])
        for a, b in itertools.pairwise(path):
            q = np.linspace(a, [*b[:2], a[2]], 20)
            assert np.mean(alone.collides(me, q)) < 0.1


def test_paths_lead_around_who_has_parked():
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
    assert abs(rows[0, 0, hint][1]) > 0.01  # it was on a straight line before
    assert (rows == simulator.observe()).all()
    path, other = simulator._guide.paths(0)[0], simulator.configurations[0, 1]
    dense = np.concatenate([np.linspace(a, b, 50) for a, b in itertools.pairwise(path)])
    apart = 2.0 * math.hypot(0.306, 0.35)  # two balls that hold a disc 0.35 m high
    assert np.hypot(*(dense - other)[:, :2].T).min() > apart - 0.1  # but for corners


def test_who_would_shut_the_door_waits_until_the_other_is_through():
    policy = policy_of("orca:shortest")
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
    ("ways", "waiting"),
    [
        ([(WEST, [0.4, 0.0, 0.0]), (EAST, [-0.4, 0.0, 0.0])], {0}),  # each would shut the other's
        ([(WEST, [2.2, 1.0, 0.0]), ([2.2, 1.2, 0.0], [-2.0, 1.0, 0.0])], {0}),  # that stands there
        ([(WEST, EAST), (EAST, WEST)], set()),  # who waits would stand where the other is to park
        ([(WEST, [1.0, 1.0, 0.0]), (EAST, [-1.0, 1.0, 0.0])], set()),
    ],
)
def test_one_of_two_waits_where_both_could_not_park(ways, waiting):
    simulator = Simulator(Scenario.load("doorway", n=2, drive="holonomic"), observation=HINT)
    simulator.reset()
    for i, (start, goal) in enumerate(ways):
        simulator.place(0, i, start, goal)
    paths = simulator._guide.paths(0)
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
def test_discs_hold_the_robot(name, given, row):
    robot = Scenario.load(name, n=2, **given).build().robots[0]
    centers, radius = enclosing_discs(robot)
    assert (len(centers) > 1) == row
    points = footprint(robot)
    far = np.hypot(points[:, :1] - centers, points[:, 1:])
    assert far.min(axis=1).max() <= radius + 1e-9


def test_one_disc_holds_all_links_of_an_arm_on_wheels(monkeypatch):
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


def test_a_parked_robot_takes_the_cells_where_discs_of_both_meet():
    simulator = Simulator("intersection", n=2, drive="holonomic", observation=HINT)
    simulator.reset()
    guide, at = simulator._guide, np.array([1.0, -0.5, 0.4])
    grid = guide._grid(0, 0, 0)
    _, closed = guide._takes(0, grid, 1, at, room=True)
    centers, radius = guide._discs[0]
    assert len(centers) > 1
    for layer, a, b in np.ndindex(closed.shape):
        q = [grid.axis(0)[a], grid.axis(1)[b], layer * math.pi / 4]
        mine, other = (
            [(x + c * math.cos(t), y + c * math.sin(t)) for c in centers] for x, y, t in (q, at)
        )
        far = min(math.dist(p, o) for p in mine for o in other)
        assert closed[layer, a, b] == (far < 2 * radius)


@pytest.mark.parametrize("n", [2, 3])
def test_those_who_change_places_do_not_wait_for_each_other(n):
    scenario = Scenario.load("random", n=n, fill=0.0, drive="holonomic")
    policy = policy_of("orca:shortest")
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


def test_who_vanishes_at_its_goal_shuts_no_way():
    scenario = Scenario.load("doorway", n=2).model_copy(update={"at_goal": "vanish"})
    simulator = Simulator(scenario, observation=HINT)
    simulator.reset()
    simulator.place(0, 0, [-2.0, 0.0, 0.0], [2.0, 1.0, 0.0])
    simulator.place(0, 1, [2.0, -1.0, 0.0], [-0.4, 0.0, 0.0])
    path = simulator._guide.paths(0)[1]
    assert (path[0] != path[-1]).any()


def test_who_has_parked_on_the_other_lane_shuts_no_road():
    """Discs that enclose cars of 2.5 m shut every road in which one had parked."""
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
    path = simulator._guide.paths(0)[0]
    assert np.abs(path[:, 1] - 1.0).max() < 0.5


def test_a_guided_episode_goes_on_alike_in_copies_and_states():
    simulator = Simulator("random", 2, cases=3, n=4, observation=HINT)
    simulator.reset(seed=1)
    rng = np.random.default_rng(0)
    actions = [simulator.sample(rng) for _ in range(40)]
    other = copy.deepcopy(simulator)
    for action in actions:
        assert (simulator.step(action).observations == other.step(action).observations).all()


@pytest.mark.parametrize(
    ("name", "options", "told"),
    [
        ("forest", {}, "no planar base"),
        ("swap", {"actions": "way_points"}, "each way point is a path of its own"),
    ],
)
def test_who_cannot_be_guided_is_told(name, options, told):
    with pytest.raises(ValueError, match=told):
        Simulator(name, observation=HINT, **options)


def test_a_path_that_is_no_kind_is_told():
    with pytest.raises(ValueError, match="path: 'curved', expected straight or shortest"):
        Observation(path="curved")
