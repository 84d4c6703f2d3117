"""Construction of the roadmap of a kind of robot: refined until starts and goals are connected.

OMPL's PRM is not used, since it supports neither directed edges nor headings, checks single edges
through Python and cannot be interrupted safely. Here vertices are spread evenly and connected to
their nearest neighbors, and one native call checks all edges.
"""

from __future__ import annotations

import numpy as np

from fgenv.arrays import Floats, Ints
from fgenv.planners.deadline import NEVER, Deadline
from fgenv.planners.problem import Problem
from fgenv.planners.timing import steps_of
from fgenv.robots import Robot

from .edge_check import EdgeCheck
from .heading_roadmap import heading_roadmap
from .lattice import apart, lattice, lattice_pitch, neighbor_pairs, sampling_box
from .motion_table import BoundingSpheres
from .roadmap import UNREACHABLE, Roadmap

MAX_POSITIONS = 500  # of the first round; doubled in each later round
FINE = 0.7  # least pitch of the first round, relative to that at which two robots just fit
ROUNDS = 4
NEIGHBORS = 12
REACH = 1.6  # distance of neighbors, in pitches


def build_roadmap(problem: Problem, kind: int, deadline: Deadline = NEVER) -> Roadmap:
    """Build the roadmap of a kind of robot, with all of its starts and goals.

    Rounds use more vertices each, until every robot of the kind has a path from start to goal; if
    none achieves that, the roadmap of the last round is returned. The same problem gives the same
    roadmap.

    Raises:
        PlanningError: the deadline passed before a roadmap was complete.
    """
    members = [i for i, k in enumerate(problem.kinds) if k == kind]
    robot = problem.models[members[0]]
    name = problem.scenario.robots[members[0]].name
    check = EdgeCheck(problem.world_with(members[0]), name, problem.margin, deadline)
    ends = np.array([q for i in members for q in (problem.starts[i], problem.goals[i])])
    distinct = np.unique(ends, axis=0)
    for turn in range(ROUNDS):
        rng = np.random.default_rng([problem.seed, kind, turn])
        roadmap = _build_round(check, robot, distinct, MAX_POSITIONS << turn, rng, problem.dt)
        if _connects(roadmap, ends):
            break
    return roadmap


def _connects(roadmap: Roadmap, ends: Floats) -> bool:
    """Whether each start has a path to its goal; ends (2n, nq): start, goal, start, goal, ..."""
    vertices = [roadmap.vertex(q) for q in ends]
    goals = sorted(set(vertices[1::2]))
    costs = roadmap.costs_to_go(goals)
    robots = zip(vertices[::2], vertices[1::2], strict=True)
    return all(costs[start, goals.index(goal)] < UNREACHABLE for start, goal in robots)


def _build_round(
    check: EdgeCheck,
    robot: Robot,
    ends: Floats,
    max_positions: int,
    rng: np.random.Generator,
    dt: float,
) -> Roadmap:
    """Roadmap with the ends (n, nq) and up to `max_positions` positions."""
    if robot.steering().turns_in_place and robot.nq == 3:
        positions, reach = _positions(robot, ends, max_positions, rng, 2)
        pairs = neighbor_pairs(positions, reach, NEIGHBORS)
        chains = bool(np.isfinite(robot.actions[0].rate))  # stops take time
        q, edges = heading_roadmap(check, ends, positions, pairs, chains)
        return Roadmap(robot, q, edges, dt, None, check.deadline)
    q = np.concatenate([ends, check.valid(_samples(robot, ends, max_positions, rng))])
    edges = _nearest(robot, q)
    if robot.steering().method == "straight":
        return Roadmap(robot, q, check.free_edges(q, edges), dt, None, check.deadline)
    edges, paths = _steered(check, robot, q, edges, dt)
    return Roadmap(robot, q, edges, dt, paths)


def _steered(
    check: EdgeCheck, robot: Robot, q: Floats, edges: Ints, dt: float
) -> tuple[Ints, list[Floats]]:
    """Edges along the steering that are free and in the workspace, and their timed paths."""
    paths = []
    for a, b in edges.tolist():
        check.deadline.check("the steering of a roadmap's edges")
        paths.append(steps_of(robot, robot.steer(q[a], q[b]), dt))
    inside = [bool(np.all(robot.valid(path))) for path in paths]  # arcs can leave the workspace
    edges, paths = edges[inside], [path for path, ok in zip(paths, inside, strict=True) if ok]
    free = check.free_paths(paths)
    return edges[free], [paths[i] for i in free]


def _positions(
    robot: Robot, ends: Floats, max_positions: int, rng: np.random.Generator, d: int
) -> tuple[Floats, float]:
    """Positions (n, d), those of the ends first, and the distance of neighbors (m)."""
    at_ends = np.unique(ends[:, :d], axis=0)
    rest = robot.rest[None]
    size = 2.0 * float(BoundingSpheres(robot).of_motions(rest, rest)[1][0])
    box = sampling_box(robot, at_ends, size)
    fine = FINE * (MAX_POSITIONS / max_positions) ** (1.0 / d)
    pitch = lattice_pitch(box, size, max_positions, fine)
    points = apart(lattice(box, pitch, rng), at_ends, pitch)
    return np.concatenate([at_ends, points]), REACH * pitch


def _samples(robot: Robot, ends: Floats, max_positions: int, rng: np.random.Generator) -> Floats:
    """Configurations (n, nq): lattice positions with the ends' orientations; random for arms."""
    if robot.base == "fixed" or robot.moving_joints:
        return robot.random(rng, max_positions)
    d = 2 if robot.base == "planar" else 3
    count = max_positions if d == 2 else max_positions // 2
    positions, _ = _positions(robot, ends, count, rng, d)
    positions = positions[len(np.unique(ends[:, :d], axis=0)) :]
    turns = ends[np.unique(np.round(ends[:, d:], 6), axis=0, return_index=True)[1], d:]
    if robot.steering().car_like:
        turns = np.linspace(-np.pi, np.pi, 8, endpoint=False)[:, None]
    if len(turns) > 2:
        return np.concatenate([positions, turns[rng.integers(len(turns), size=len(positions))]], 1)
    pairs = np.repeat(positions, len(turns), 0), np.tile(turns, (len(positions), 1))
    return np.concatenate(pairs, axis=1)


def _nearest(robot: Robot, q: Floats) -> Ints:
    """Directed edges (m, 2) between each of q (n, nq) and its nearest neighbors, both ways."""
    gaps = np.asarray(robot.displacement_bound(q[:, None], q[None]))
    np.fill_diagonal(gaps, np.inf)
    near = np.argsort(gaps, axis=1, kind="stable")[:, :NEIGHBORS]
    out = np.stack([np.repeat(np.arange(len(q)), near.shape[1]), near.ravel()], axis=1)
    return np.unique(np.concatenate([out, out[:, ::-1]]), axis=0)
