"""Many robots on roadmaps: what every result keeps, and searches against plainer ones."""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from fgenv.arrays import Floats
from fgenv.planners.errors import PlanningError
from fgenv.planners.multi.conflict_based import conflict_based
from fgenv.planners.multi.conflict_tree import Search
from fgenv.planners.multi.conflicts import Clashes
from fgenv.planners.multi.prioritized import prioritized
from fgenv.planners.multi.roadmap_set import Tables
from fgenv.planners.multi.timetable import Timetable
from fgenv.planners.problem import Problem
from fgenv.planners.roadmap.roadmap import FAR, INF, Roadmap
from fgenv.planners.sipp.safe_intervals import stays
from fgenv.planners.sipp.sipp import Effort, sipp
from fgenv.scenarios import Scenario

METHODS = {"prioritized": prioritized, "conflict_based": conflict_based}
CASES: list[tuple[str, dict[str, Any]]] = [
    ("swap", {"n": 4}),
    ("swap", {"n": 4, "body": "long"}),
    ("swap", {"n": 4, "body": "l"}),  # holonomic
    ("doorway", {"n": 4}),
    ("corridor", {"n": 2}),
    ("forest", {"n": 4}),  # three dimensions
    ("warehouse", {"n": 4}),  # accelerations limited
    ("intersection", {"n": 2}),  # cars
]


def padded(paths: tuple[Floats | None, ...]) -> Floats:
    """Paths as one array (robots, steps + 1, nq): who has arrived stays."""
    known = [path for path in paths if path is not None]
    last = max(map(len, known))
    return np.stack([np.concatenate([p, np.repeat(p[-1:], last - len(p), 0)]) for p in known])


def assert_proved(problem: Problem, found: Timetable) -> None:
    """Every step of all at once is proved free by the world, whatever tables say."""
    q = padded(found.paths)
    for t in range(q.shape[1] - 1):
        made = problem.world.check_motions(list(problem.robots), q[:, t], q[:, t + 1])
        assert np.all(made.free), f"step {t}"


def assert_kept(problem: Problem, found: Timetable) -> None:
    """Starts, goals, limits of speed and of coordinates."""
    for i, path in enumerate(found.paths):
        assert path is not None
        assert np.array_equal(path[0], problem.starts[i])
        assert np.array_equal(path[-1], problem.goals[i])
        assert np.all(problem.models[i].valid(path))
        speed = getattr(problem.models[i].drive, "speed", np.inf)
        far = np.linalg.norm(np.diff(path[:, :2], axis=0), axis=1)
        assert far.max(initial=0.0) <= speed * problem.dt * (1 + 1e-9)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("name", "more"), CASES, ids=lambda x: str(x))
def test_all_is_proved_and_kept(method: str, name: str, more: dict[str, Any]) -> None:
    problem = Problem.of(name, **more)
    found = METHODS[method](problem, 30.0)
    assert found.complete
    assert_proved(problem, found)
    assert_kept(problem, found)


@pytest.mark.parametrize("method", METHODS)
def test_same_seed_same_paths(method: str) -> None:
    one, two = (METHODS[method](Problem.of("doorway", n=4, seed=3), 30.0) for _ in range(2))
    assert all(np.array_equal(a, b) for a, b in zip(one.paths, two.paths, strict=True))


@pytest.mark.parametrize("method", METHODS)
def test_a_margin_is_kept(method: str) -> None:
    problem = Problem.of("swap", margin=0.1, n=4)
    q = padded(METHODS[method](problem, 30.0).paths)
    for t in range(q.shape[1] - 1):
        pair = problem.world.check_motions(
            list(problem.robots), q[:, t], q[:, t + 1], margin=0.1 - 1e-6
        )
        assert np.all(pair.free)


def holonomic(
    starts: list[tuple[float, float]], goals: list[tuple[float, float]], **more: Any
) -> Problem:
    """Discs of radius 0.2 m that move any way, 1 m/s."""
    robots = [
        {"name": f"r{i}", "model": "disc", "start": (*s, 0.0), "goal": (*g, 0.0)}
        for i, (s, g) in enumerate(zip(starts, goals, strict=True))
    ]
    disc = {"kind": "disc", "radius": 0.2, "height": 0.3}
    drive = {"kind": "holonomic", "speed": 1.0, "turn_rate": 1.0}
    given = {
        "version": 1,
        "name": "discs",
        "workspace": {"low": (-2.0, -2.0), "high": (2.0, 2.0)},
        "shapes": {"disc": disc},
        "models": {"disc": {"shape": "disc", "drive": drive}},
        "robots": robots,
        **more,
    }
    return Problem.of(Scenario.model_validate(given))


@pytest.mark.parametrize("method", METHODS)
def test_goals_that_collide_are_named(method: str) -> None:
    problem = holonomic([(-1.0, 0.0), (1.0, 0.0)], [(0.0, 0.0), (0.1, 0.0)])
    with pytest.raises(PlanningError, match=r"goal.*r0.*r1"):
        METHODS[method](problem, 5.0)


@pytest.mark.parametrize("method", METHODS)
def test_starts_that_collide_are_named(method: str) -> None:
    problem = holonomic([(0.0, 0.0), (0.1, 0.0)], [(-1.0, 0.0), (1.0, 0.0)])
    with pytest.raises(PlanningError, match=r"start.*r0.*r1"):
        METHODS[method](problem, 5.0)


@pytest.mark.parametrize("method", METHODS)
def test_who_is_at_the_goal_moves_aside_or_stays(method: str) -> None:
    problem = holonomic([(-1.0, 0.0), (0.0, 0.0)], [(1.0, 0.0), (0.0, 0.0)])
    found = METHODS[method](problem, 10.0)
    assert_proved(problem, found)
    assert_kept(problem, found)


def bay() -> tuple[Problem, Tables]:
    """Three places in a line and a bay beside the middle: two can change ends only by waiting."""
    problem = holonomic([(-1.0, 0.0), (1.0, 0.0)], [(1.0, 0.0), (-1.0, 0.0)])
    q = np.array([(-1.0, 0, 0), (1.0, 0, 0), (0, 0, 0), (0, 0.5, 0)])
    return problem, with_roadmap(problem, q, [(0, 2), (1, 2), (3, 2)])


def with_roadmap(problem: Problem, q: Floats, edges: list[tuple[int, int]]) -> Tables:
    """Tables whose only roadmap has these vertices, and edges both ways."""
    moves = np.array([m for a, b in edges for m in ((a, b), (b, a))], dtype=np.int64)
    tables = Tables(problem)
    tables.__dict__["roadmaps"] = (Roadmap(problem.models[0], q, moves, problem.dt),)
    return tables


def test_one_waits_in_the_bay() -> None:
    problem, tables = bay()
    found = conflict_based(problem, 10.0, tables=tables)
    assert_proved(problem, found)
    in_bay = [path[:, 1].max() > 0.49 for path in found.paths if path is not None]
    waits = [(np.diff(path, axis=0) == 0).all(1).any() for path in found.paths if path is not None]
    assert sorted(in_bay) == [False, True]
    assert any(waits)


def test_no_order_lets_two_into_the_bay() -> None:
    problem, tables = bay()
    with pytest.raises(PlanningError, match=r"2 orders.*r[01]"):
        prioritized(problem, 10.0, restarts=1, tables=tables)


def test_a_failure_tells_who_and_keeps_the_rest() -> None:
    problem = holonomic([(-1.0, 0.0), (1.0, 0.0)], [(1.0, 0.0), (-1.0, 0.0)])
    line = np.array([(-1.0, 0, 0), (1.0, 0, 0), (0, 0, 0)])
    tables = with_roadmap(problem, line, [(0, 2), (1, 2)])
    with pytest.raises(PlanningError, match=r"prioritized.*r[01]") as caught:
        prioritized(problem, 10.0, restarts=2, tables=tables)
    assert caught.value.best.missing in ((0,), (1,))


def test_a_knot_is_solved_jointly() -> None:
    problem = holonomic([(-1.0, 0.0), (1.0, 0.0)], [(1.0, 0.0), (-1.0, 0.0)])
    line = np.array([(-1.0, 0, 0), (1.0, 0, 0), (0, 0, 0)])
    asked = []

    def knot(robots: tuple[int, ...], seconds: float) -> list[Floats]:
        asked.append(robots)
        assert 0 < seconds <= 20.0
        t = np.linspace(0, np.pi, 60)
        return [
            np.stack([-s * np.cos(t), -s * np.sin(t), 0 * t], axis=1).round(12) for s in (1.0, -1.0)
        ]

    tables = with_roadmap(problem, line, [(0, 2), (1, 2)])
    found = conflict_based(problem, 20.0, knot=knot, tables=tables)
    assert asked == [(0, 1)]
    assert found.complete
    assert found.stats.knots == ((0, 1),)
    assert_proved(problem, found)


def test_time_is_kept() -> None:
    with pytest.raises(PlanningError, match="within"):
        prioritized(Problem.of("swap", n=8), 1e-3)


class Graph:
    """A roadmap without robots: moves of some steps between numbers."""

    def __init__(self, rng: np.random.Generator, n: int) -> None:
        pairs = [(a, b) for a in range(n) for b in range(n) if a != b and rng.random() < 0.5]
        self.heads = [b for _, b in pairs]
        self.lengths = [int(k) for k in rng.integers(1, 4, len(pairs))]
        self.out = [
            [(e, b, self.lengths[e]) for e, (a, b) in enumerate(pairs) if a == u] for u in range(n)
        ]

    def to(self, goal: int) -> list[int]:
        cost = [0 if v == goal else FAR for v in range(len(self.out))]
        for _ in cost:
            for u, moves in enumerate(self.out):
                cost[u] = min([cost[u], *(k + cost[b] for _, b, k in moves)])
        return cost

    def first(self, e: int) -> int:
        return 1000 * (e + 1)


class Dangers:
    """Unsafe steps at vertices, and unsafe instants to begin moves at, by chance."""

    def __init__(self, rng: np.random.Generator, graph: Graph, last: int) -> None:
        self.steps = rng.random((len(graph.out), last)) < 0.4
        self.begin = rng.random((len(graph.heads), last)) < 0.4
        self.last = last

    def waits(self, v: int) -> list[tuple[int, int]]:
        unsafe = np.flatnonzero(self.steps[v]).tolist()
        between = [t for t in unsafe if t - 1 in unsafe]
        return stays([(t, t) for t in unsafe], between)

    def first(self, e: int, low: int, high: int) -> int:
        unsafe = np.flatnonzero(self.begin[e]).tolist()
        begin = next(t for t in itertools.count(low) if t not in unsafe)
        return begin if begin <= high else -1

    def may_wait(self, v: int, t: int) -> bool:
        return t >= self.last or not self.steps[v, t]

    def may_begin(self, e: int, t: int) -> bool:
        return t >= self.last or not self.begin[e, t]


def soonest(graph: Graph, safe: Dangers, start: int, goal: int) -> int | None:
    """By brute force over time: the instant from which it can stay at the goal."""
    reached: dict[int, set[int]] = {0: {start}}
    for t in range(safe.last + 100):
        for v in reached.get(t, set()):
            if v == goal and all(safe.may_wait(goal, k) for k in range(t, safe.last)):
                return t
            if safe.may_wait(v, t):
                reached.setdefault(t + 1, set()).add(v)
            for e, head, length in graph.out[v]:
                if safe.may_begin(e, t):
                    reached.setdefault(t + length, set()).add(head)
    return None


def test_safe_intervals_find_what_time_steps_find() -> None:
    found = 0
    for seed in range(150):
        rng = np.random.default_rng(seed)
        graph = Graph(rng, 5)
        safe = Dangers(rng, graph, 12)
        roadmap: Any = graph
        track = sipp(roadmap, 0, 4, safe, Effort())
        expected = soonest(graph, safe, 0, 4)
        assert (track and track.arrival) == expected
        found += track is not None
    assert found > 50


def joint_cost(tables: Tables) -> int:
    """By brute force over all robots' states: the least sum of arrivals."""
    roadmap, meet = tables.roadmaps[0], tables.meetings.meet
    goals = tables.goals
    # a state of a robot: vertex and steps still to make; None: parked
    first = tuple((v, ()) for v in tables.starts)
    heap: list[tuple[int, int, Any]] = [(0, 0, first)]
    best, count = {first: 0}, itertools.count(1)

    def choices(i: int, state: Any) -> Iterator[tuple[int, Any, int]]:
        if state is None:
            yield goals[i], None, 0
            return
        v, todo = state
        if todo:
            yield todo[0], (v, todo[1:]), 1
            return
        if v == goals[i]:
            yield v, None, 0
        yield v, (v, ()), 1
        for e, head, _ in roadmap.out[v]:
            steps = tuple(roadmap.numbers(e).tolist())
            yield steps[0], (head, steps[1:]), 1

    while heap:
        cost, _, states = heapq.heappop(heap)
        if cost > best[states]:
            continue
        if all(state is None for state in states):
            return cost
        for chosen in itertools.product(*(choices(i, s) for i, s in enumerate(states))):
            steps = [np.array([c[0]]) for c in chosen]
            if any(meet(0, a, 0, b)[0] for a, b in itertools.combinations(steps, 2)):
                continue
            then, more = tuple(c[1] for c in chosen), cost + sum(c[2] for c in chosen)
            if more < best.get(then, INF):
                best[then] = more
                heapq.heappush(heap, (more, next(count), then))
    raise AssertionError("no way")


LITTLE = np.array([(x, y, 0.0) for x in (-0.5, 0.0, 0.5) for y in (0.0, 0.45)])


@pytest.mark.parametrize("seed", range(8))
def test_conflict_based_search_is_optimal(seed: int) -> None:
    rng = np.random.default_rng(seed)
    starts, goals = (rng.permutation(6)[:2] for _ in range(2))
    problem = holonomic(*([tuple(LITTLE[i, :2]) for i in ends] for ends in (starts, goals)))
    edges = [(0, 1), (2, 3), (4, 5), (0, 2), (2, 4), (1, 3)]
    tables = with_roadmap(problem, LITTLE, edges)
    found = conflict_based(problem, 20.0, suboptimality=1.0, tables=tables)
    cost = sum(len(path) - 1 for path in found.paths if path is not None)
    assert cost == joint_cost(tables)
    loose = conflict_based(problem, 20.0, suboptimality=1.5, tables=tables)
    assert sum(len(p) - 1 for p in loose.paths if p is not None) <= 1.5 * cost


def test_one_of_two_bans_is_kept_by_all_that_do_not_meet() -> None:
    _, tables = bay()
    node = Search(tables, Effort()).root()
    assert node is not None
    for clash in node.clashes.values():
        one, other = Clashes(tables).parted(clash, node.tracks)
        if one.act == other.act == "move":
            a, b = (tables.roadmaps[0].numbers(ban.what) for ban in (one, other))
            for s, t in itertools.product(range(*one.range), range(*other.range)):
                k = np.arange(max(s, t), min(s + len(a), t + len(b)))
                assert tables.meetings.meet(0, a[k - s], 0, b[k - t]).any()
