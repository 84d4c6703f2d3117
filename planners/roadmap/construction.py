"""Growing a roadmap for a kind of robot, until all its starts and goals are connected.

Not OMPL's PRM: it knows neither directed moves nor headings, tests one edge at a time through
Python, and cannot be stopped safely (it deadlocks). Places are spread evenly and joined to their
nearest here, and all moves are proved in one native call.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fgenv.arrays import Floats, Ints
from fgenv.collision import World
from fgenv.planners.steering import Steering, legs
from fgenv.planners.timing import steps_of
from fgenv.robots import Car, DifferentialDrive, Robot

from .heading_roadmap import expanded
from .lattice import apart, box, lattice, neighbors, pitch
from .motion_table import Balls
from .roadmap import FAR, Roadmap

if TYPE_CHECKING:
    from fgenv.planners.problem import Problem

PLACES = 500  # of the first round, at most; each round more has twice as many
FINE = 0.7  # of the pitch at which two robots just fit: of the first round's
ROUNDS = 4
NEAREST = 12
REACH = 1.6  # pitches: how far a place's neighbors are


def grow(problem: Problem, kind: int, rounds: int = ROUNDS, first: int = 0) -> Roadmap:
    """The roadmap of a kind of robot, with all its starts and goals.

    Rounds are finer each, until every robot of the kind has a way from start to goal; the last
    round's is returned where none does. Same problem, same roadmap.
    """
    members = [i for i, k in enumerate(problem.kinds) if k == kind]
    robot, name = problem.models[members[0]], problem.scenario.robots[members[0]].name
    world = problem.alone(members[0])
    ends = np.array([q for i in members for q in (problem.starts[i], problem.goals[i])])
    different = np.unique(ends, axis=0)
    for turn in range(first, first + rounds):
        rng = np.random.default_rng([problem.seed, kind, turn])
        most = PLACES << turn
        made = _round(world, name, robot, different, most, rng, problem.margin, problem.dt)
        if connected(made, ends):
            break
    return made


def connected(roadmap: Roadmap, ends: Floats) -> bool:
    """Whether each start has a way to its goal; ends (2n, nq): start, goal, start, goal..."""
    places = [roadmap.vertex(q) for q in ends]
    goals = sorted(set(places[1::2]))
    ways = roadmap.all_to(goals)
    starts = zip(places[::2], places[1::2], strict=True)
    return all(ways[a, goals.index(b)] < FAR for a, b in starts)


def _round(
    world: World,
    name: str,
    robot: Robot,
    ends: Floats,
    most: int,
    rng: np.random.Generator,
    margin: float,
    dt: float,
) -> Roadmap:
    if isinstance(robot.drive, DifferentialDrive) and robot.nq == 3:
        places, reach = _places(robot, ends, most, rng, 2)
        pairs = neighbors(places, reach, NEAREST)
        chains = np.isfinite(robot.drive.acceleration)
        made = expanded(world, name, ends, places, pairs, margin, bool(chains))
        return Roadmap(robot, *made, dt)
    q = np.concatenate([ends, _samples(robot, ends, most, rng)])
    hit = np.asarray(world.collides(name, q, margin=margin), dtype=bool)
    hit[: len(ends)] = False
    q = q[~hit]
    moves = _nearest(robot, q)
    if Steering.of(robot).way != "straight":
        ways = [steps_of(robot, legs(robot, q[a], q[b]), dt) for a, b in moves.tolist()]
        inside = [bool(np.all(robot.valid(way))) for way in ways]  # arcs swing out of the workspace
        moves, ways = moves[inside], [way for way, ok in zip(ways, inside, strict=True) if ok]
        kept = _free(world, name, ways, margin)
        return Roadmap(robot, q, moves[kept], dt, [ways[i] for i in kept])
    found = world.check_motion(name, q[moves[:, 0]], q[moves[:, 1]], margin=margin, first=False)
    return Roadmap(robot, q, moves[np.asarray(found.free, dtype=bool)], dt)


def _places(
    robot: Robot, ends: Floats, most: int, rng: np.random.Generator, d: int
) -> tuple[Floats, float]:
    """Places (n, d), those of the ends first, and how far neighbors are (m)."""
    expected = np.unique(ends[:, :d], axis=0)
    rest = robot.rest[None]
    size = 2.0 * float(Balls(robot).around(rest, rest)[1][0])
    room = box(robot, expected, size)
    step = pitch(room, size, most, FINE * (PLACES / most) ** (1.0 / d))
    return np.concatenate([expected, apart(lattice(room, step, rng), expected, step)]), REACH * step


def _samples(robot: Robot, ends: Floats, most: int, rng: np.random.Generator) -> Floats:
    """Configurations (n, nq): bases on a lattice, orientations as at the ends; else random."""
    if robot.base == "fixed" or robot.moving_joints:
        return robot.random(rng, most)
    d = 2 if robot.base == "planar" else 3
    places, _ = _places(robot, ends, most if d == 2 else most // 2, rng, d)
    places = places[len(np.unique(ends[:, :d], axis=0)) :]
    headings = ends[np.unique(np.round(ends[:, d:], 6), axis=0, return_index=True)[1], d:]
    if isinstance(robot.drive, Car):
        headings = np.linspace(-np.pi, np.pi, 8, endpoint=False)[:, None]
    if len(headings) > 2:
        return np.concatenate([places, headings[rng.integers(len(headings), size=len(places))]], 1)
    return np.concatenate(
        [np.repeat(places, len(headings), 0), np.tile(headings, (len(places), 1))], 1
    )


def _nearest(robot: Robot, q: Floats) -> Ints:
    """Directed moves (m, 2) between each of q (n, nq) and its nearest, both ways."""
    gaps = np.asarray(robot.distance(q[:, None], q[None]))
    np.fill_diagonal(gaps, np.inf)
    near = np.argsort(gaps, axis=1, kind="stable")[:, :NEAREST]
    out = np.stack([np.repeat(np.arange(len(q)), near.shape[1]), near.ravel()], axis=1)
    return np.unique(np.concatenate([out, out[:, ::-1]]), axis=0)


def _free(world: World, name: str, ways: list[Floats], margin: float) -> Ints:
    """Places of those ways (k+1, nq) that are proved free all along."""
    ends = np.cumsum([len(way) - 1 for way in ways])
    here, there = np.concatenate([w[:-1] for w in ways]), np.concatenate([w[1:] for w in ways])
    found = world.check_motion(name, here, there, margin=margin, first=False)
    parts = np.split(np.asarray(found.free, dtype=bool), ends[:-1])
    return np.flatnonzero([part.all() for part in parts])
