"""Multi-robot planning on roadmaps: properties of all solutions, and brute-force oracles."""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from fgenv.arrays import Floats
from fgenv.planners.errors import PlanningError
from fgenv.planners.multi.conflict_based import plan_conflict_based
from fgenv.planners.multi.conflict_splitting import ConflictSplitter
from fgenv.planners.multi.constraint_tree import ConstraintTree
from fgenv.planners.multi.prioritized import plan_prioritized
from fgenv.planners.multi.roadmap_set import RoadmapSet
from fgenv.planners.multi.solution import Solution
from fgenv.planners.problem import Problem
from fgenv.planners.roadmap.roadmap import INF, UNREACHABLE, Roadmap
from fgenv.planners.sipp.intervals import safe_intervals
from fgenv.planners.sipp.sipp import SearchBudget, sipp
from fgenv.scenarios import Scenario

METHODS: dict[str, Callable[[Problem, float], Solution]] = {
    "prioritized": plan_prioritized,
    "conflict_based": plan_conflict_based,
}
CASES: list[tuple[str, dict[str, Any]]] = [
    ("swap", {"n": 4}),
    ("swap", {"n": 4, "body": "long"}),
    ("swap", {"n": 4, "body": "l"}),  # holonomic
    ("doorway", {"n": 4}),
    ("corridor", {"n": 2}),
    ("forest", {"n": 4}),  # three dimensions
    ("warehouse", {"n": 4}),  # limited accelerations
    ("intersection", {"n": 2}),  # cars
]


def padded(paths: tuple[Floats | None, ...]) -> Floats:
    """Paths as one array (robots, steps + 1, nq); robots stay at their goals."""
    known = [path for path in paths if path is not None]
    count = max(map(len, known))
    return np.stack([np.concatenate([p, np.repeat(p[-1:], count - len(p), 0)]) for p in known])


def assert_certified(problem: Problem, solution: Solution) -> None:
    """The world certifies each step of all robots at once, independently of the motion tables."""
    q = padded(solution.paths)
    for t in range(q.shape[1] - 1):
        result = problem.world.check_motions(list(problem.robot_ids), q[:, t], q[:, t + 1])
        assert np.all(result.free), f"step {t}"


def assert_valid(problem: Problem, solution: Solution) -> None:
    """Starts, goals, and limits of speeds and coordinates hold."""
    for i, path in enumerate(solution.paths):
        assert path is not None
        assert np.array_equal(path[0], problem.starts[i])
        assert np.array_equal(path[-1], problem.goals[i])
        assert np.all(problem.models[i].valid(path))
        speed = getattr(problem.models[i].drive, "speed", np.inf)
        length = np.linalg.norm(np.diff(path[:, :2], axis=0), axis=1)
        assert length.max(initial=0.0) <= speed * problem.dt * (1 + 1e-9)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("name", "options"), CASES, ids=lambda x: str(x))
def test_solutions_are_certified_and_valid(method: str, name: str, options: dict[str, Any]) -> None:
    problem = Problem.from_scenario(name, **options)
    solution = METHODS[method](problem, 30.0)
    assert solution.complete
    assert_certified(problem, solution)
    assert_valid(problem, solution)


@pytest.mark.parametrize("method", METHODS)
def test_the_same_seed_gives_the_same_paths(method: str) -> None:
    one, two = (
        METHODS[method](Problem.from_scenario("doorway", n=4, seed=3), 30.0) for _ in range(2)
    )
    for a, b in zip(one.paths, two.paths, strict=True):
        assert a is not None
        assert b is not None
        assert np.array_equal(a, b)


@pytest.mark.parametrize("method", METHODS)
def test_robots_keep_the_margin(method: str) -> None:
    problem = Problem.from_scenario("swap", margin=0.1, n=4)
    q = padded(METHODS[method](problem, 30.0).paths)
    for t in range(q.shape[1] - 1):
        result = problem.world.check_motions(
            list(problem.robot_ids), q[:, t], q[:, t + 1], margin=0.1 - 1e-6
        )
        assert np.all(result.free)


def holonomic(starts: list[tuple[float, float]], goals: list[tuple[float, float]]) -> Problem:
    """Holonomic discs of radius 0.2 m with a speed of 1 m/s."""
    robots = [
        {"name": f"r{i}", "model": "disc", "start": (*s, 0.0), "goal": (*g, 0.0)}
        for i, (s, g) in enumerate(zip(starts, goals, strict=True))
    ]
    disc = {"kind": "disc", "radius": 0.2, "height": 0.3}
    drive = {"kind": "holonomic", "speed": 1.0, "turn_rate": 1.0}
    scenario = {
        "version": 1,
        "name": "discs",
        "workspace": {"low": (-2.0, -2.0), "high": (2.0, 2.0)},
        "shapes": {"disc": disc},
        "models": {"disc": {"shape": "disc", "drive": drive}},
        "robots": robots,
    }
    return Problem.from_scenario(Scenario.model_validate(scenario))


@pytest.mark.parametrize("method", METHODS)
def test_colliding_goals_are_errors(method: str) -> None:
    problem = holonomic([(-1.0, 0.0), (1.0, 0.0)], [(0.0, 0.0), (0.1, 0.0)])
    with pytest.raises(PlanningError, match=r"goal.*r0.*r1"):
        METHODS[method](problem, 5.0)


@pytest.mark.parametrize("method", METHODS)
def test_colliding_starts_are_errors(method: str) -> None:
    problem = holonomic([(0.0, 0.0), (0.1, 0.0)], [(-1.0, 0.0), (1.0, 0.0)])
    with pytest.raises(PlanningError, match=r"start.*r0.*r1"):
        METHODS[method](problem, 5.0)


@pytest.mark.parametrize("method", METHODS)
def test_a_robot_at_its_goal_stays_or_moves_aside(method: str) -> None:
    problem = holonomic([(-1.0, 0.0), (0.0, 0.0)], [(1.0, 0.0), (0.0, 0.0)])
    solution = METHODS[method](problem, 10.0)
    assert_certified(problem, solution)
    assert_valid(problem, solution)


def bay() -> tuple[Problem, RoadmapSet]:
    """Three vertices in a line and a bay beside the middle: one robot has to wait in the bay."""
    problem = holonomic([(-1.0, 0.0), (1.0, 0.0)], [(1.0, 0.0), (-1.0, 0.0)])
    q = np.array([(-1.0, 0, 0), (1.0, 0, 0), (0, 0, 0), (0, 0.5, 0)])
    return problem, with_roadmap(problem, q, [(0, 2), (1, 2), (3, 2)])


def with_roadmap(problem: Problem, q: Floats, edges: list[tuple[int, int]]) -> RoadmapSet:
    """Set of one roadmap with vertices q (n, nq), and edges in both directions."""
    directed = np.array([e for a, b in edges for e in ((a, b), (b, a))], dtype=np.int64)
    roadmaps = RoadmapSet(problem)
    roadmaps.__dict__["roadmaps"] = (Roadmap(problem.models[0], q, directed, problem.dt),)
    return roadmaps


def test_one_robot_waits_in_the_bay() -> None:
    problem, roadmaps = bay()
    solution = plan_conflict_based(problem, 10.0, roadmaps=roadmaps)
    assert_certified(problem, solution)
    in_bay = [path[:, 1].max() > 0.49 for path in solution.paths if path is not None]
    waits = [
        (np.diff(path, axis=0) == 0).all(1).any() for path in solution.paths if path is not None
    ]
    assert sorted(in_bay) == [False, True]
    assert any(waits)


def test_prioritized_planning_fails_in_the_bay_in_every_order() -> None:
    problem, roadmaps = bay()
    with pytest.raises(PlanningError, match=r"2 orders.*r[01]"):
        plan_prioritized(problem, 10.0, restarts=1, roadmaps=roadmaps)


def test_a_failure_names_the_robot_and_returns_the_other_paths() -> None:
    problem = holonomic([(-1.0, 0.0), (1.0, 0.0)], [(1.0, 0.0), (-1.0, 0.0)])
    line = np.array([(-1.0, 0, 0), (1.0, 0, 0), (0, 0, 0)])
    roadmaps = with_roadmap(problem, line, [(0, 2), (1, 2)])
    with pytest.raises(PlanningError, match=r"prioritized.*r[01]") as caught:
        plan_prioritized(problem, 10.0, restarts=2, roadmaps=roadmaps)
    assert caught.value.best.missing in ((0,), (1,))


def test_a_meta_agent_is_planned_jointly() -> None:
    problem = holonomic([(-1.0, 0.0), (1.0, 0.0)], [(1.0, 0.0), (-1.0, 0.0)])
    line = np.array([(-1.0, 0, 0), (1.0, 0, 0), (0, 0, 0)])
    merged = []

    def joint_planner(robots: tuple[int, ...], seconds: float) -> list[Floats]:
        merged.append(robots)
        assert 0 < seconds <= 20.0
        t = np.linspace(0, np.pi, 60)
        return [
            np.stack([-s * np.cos(t), -s * np.sin(t), 0 * t], axis=1).round(12) for s in (1.0, -1.0)
        ]

    roadmaps = with_roadmap(problem, line, [(0, 2), (1, 2)])
    solution = plan_conflict_based(problem, 20.0, joint_planner=joint_planner, roadmaps=roadmaps)
    assert merged == [(0, 1)]
    assert solution.complete
    assert solution.stats.meta_agents == ((0, 1),)
    assert_certified(problem, solution)


def test_the_time_limit_holds() -> None:
    with pytest.raises(PlanningError, match=r"time limit ended during|within"):
        plan_prioritized(Problem.from_scenario("swap", n=8), 1e-3)


class Graph:
    """A roadmap without robots: random edges of one to three steps."""

    def __init__(self, rng: np.random.Generator, n: int) -> None:
        pairs = [(a, b) for a in range(n) for b in range(n) if a != b and rng.random() < 0.5]
        self.heads = [b for _, b in pairs]
        self.durations = [int(k) for k in rng.integers(1, 4, len(pairs))]
        self.successors = [
            [(e, b, self.durations[e]) for e, (a, b) in enumerate(pairs) if a == u]
            for u in range(n)
        ]

    def cost_to_go(self, goal: int) -> list[int]:
        cost = [0 if v == goal else UNREACHABLE for v in range(len(self.successors))]
        for _ in cost:
            for u, edges in enumerate(self.successors):
                cost[u] = min([cost[u], *(k + cost[b] for _, b, k in edges)])
        return cost

    def first_motion(self, e: int) -> int:
        return 1000 * (e + 1)


class RandomIntervals:
    """Random unsafe steps at vertices, and random unsafe start instants of edges."""

    def __init__(self, rng: np.random.Generator, graph: Graph, last: int) -> None:
        self.steps = rng.random((len(graph.successors), last)) < 0.4
        self.start = rng.random((len(graph.heads), last)) < 0.4
        self.last = last

    def at_vertex(self, v: int) -> list[tuple[int, int]]:
        unsafe = np.flatnonzero(self.steps[v]).tolist()
        between = [t for t in unsafe if t - 1 in unsafe]
        return safe_intervals([(t, t) for t in unsafe], between)

    def first_start(self, e: int, low: int, high: int) -> int:
        unsafe = np.flatnonzero(self.start[e]).tolist()
        start = next(t for t in itertools.count(low) if t not in unsafe)
        return start if start <= high else -1

    def may_wait(self, v: int, t: int) -> bool:
        return t >= self.last or not self.steps[v, t]

    def may_start(self, e: int, t: int) -> bool:
        return t >= self.last or not self.start[e, t]


def earliest_arrival(graph: Graph, safe: RandomIntervals, start: int, goal: int) -> int | None:
    """Instant from which the robot can stay at the goal, by brute force over time."""
    reached: dict[int, set[int]] = {0: {start}}
    for t in range(safe.last + 100):
        for v in reached.get(t, set()):
            if v == goal and all(safe.may_wait(goal, k) for k in range(t, safe.last)):
                return t
            if safe.may_wait(v, t):
                reached.setdefault(t + 1, set()).add(v)
            for e, head, duration in graph.successors[v]:
                if safe.may_start(e, t):
                    reached.setdefault(t + duration, set()).add(head)
    return None


def test_sipp_agrees_with_brute_force_over_time() -> None:
    found = 0
    for seed in range(150):
        rng = np.random.default_rng(seed)
        graph = Graph(rng, 5)
        safe = RandomIntervals(rng, graph, 12)
        roadmap: Any = graph
        path = sipp(roadmap, 0, 4, safe, SearchBudget())
        assert (path and path.arrival) == earliest_arrival(graph, safe, 0, 4)
        found += path is not None
    assert found > 50


def optimal_cost(roadmaps: RoadmapSet) -> int:
    """Least sum of costs, by brute force over the joint states."""
    roadmap, collide = roadmaps.roadmaps[0], roadmaps.pairs.collide
    goals = roadmaps.goals
    # State of a robot: vertex and motions that remain on its edge; None: at its goal for good.
    first = tuple((v, ()) for v in roadmaps.starts)
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
        for e, head, _ in roadmap.successors[v]:
            motions = tuple(roadmap.edge_motions(e).tolist())
            yield motions[0], (head, motions[1:]), 1

    while heap:
        cost, _, states = heapq.heappop(heap)
        if cost > best[states]:
            continue
        if all(state is None for state in states):
            return cost
        for chosen in itertools.product(*(choices(i, s) for i, s in enumerate(states))):
            motions = [np.array([c[0]]) for c in chosen]
            if any(collide(0, a, 0, b)[0] for a, b in itertools.combinations(motions, 2)):
                continue
            after, total = tuple(c[1] for c in chosen), cost + sum(c[2] for c in chosen)
            if total < best.get(after, INF):
                best[after] = total
                heapq.heappush(heap, (total, next(count), after))
    raise AssertionError("no solution")


GRID = np.array([(x, y, 0.0) for x in (-0.5, 0.0, 0.5) for y in (0.0, 0.45)])


@pytest.mark.parametrize("seed", range(8))
def test_conflict_based_search_is_optimal(seed: int) -> None:
    rng = np.random.default_rng(seed)
    starts, goals = (rng.permutation(6)[:2] for _ in range(2))
    problem = holonomic(*([tuple(GRID[i, :2]) for i in ends] for ends in (starts, goals)))
    edges = [(0, 1), (2, 3), (4, 5), (0, 2), (2, 4), (1, 3)]
    roadmaps = with_roadmap(problem, GRID, edges)
    solution = plan_conflict_based(problem, 20.0, suboptimality=1.0, roadmaps=roadmaps)
    cost = sum(len(path) - 1 for path in solution.paths if path is not None)
    assert cost == optimal_cost(roadmaps)
    bounded = plan_conflict_based(problem, 20.0, suboptimality=1.5, roadmaps=roadmaps)
    assert sum(len(p) - 1 for p in bounded.paths if p is not None) <= 1.5 * cost


def test_actions_that_violate_both_constraints_of_a_conflict_collide() -> None:
    _, roadmaps = bay()
    node = ConstraintTree(roadmaps, SearchBudget()).root()
    assert node is not None
    for conflict in node.conflicts.values():
        one, other = ConflictSplitter(roadmaps).split(conflict, node.paths)
        if one.kind == other.kind == "edge":
            a, b = (roadmaps.roadmaps[0].edge_motions(c.target) for c in (one, other))
            for s, t in itertools.product(range(*one.interval), range(*other.interval)):
                k = np.arange(max(s, t), min(s + len(a), t + len(b)))
                assert roadmaps.pairs.collide(0, a[k - s], 0, b[k - t]).any()
