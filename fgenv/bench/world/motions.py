"""Motions of a body past another: certified, discrete, FCL's continuous; cost and correctness."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from time import process_time
from typing import Any

import fcl
import numpy as np
import trimesh
from numpy.typing import NDArray

from fgenv.arrays import Flags, Indices, Poses
from fgenv.bench.common.meshes import Mesh
from fgenv.bench.common.poses import random_directions, random_poses_batched, random_rotations
from fgenv.bench.pairs.catalog import PAIRS
from fgenv.bench.peers.fcl_ import PEER as FCL
from fgenv.bench.peers.fgenv_ import PEER as FGENV
from fgenv.bench.world.crowd import turned
from fgenv.bench.world.movers import along, between
from fgenv.collision import World

Record = dict[str, Any]
Way = Callable[[Indices], Flags]
STEP = 0.01  # meters that any point moves in a step of the discrete check
DENSE = 1000  # poses of a motion in the cross-check of the truth
BUDGET = 4.0  # seconds
NAMES = ("panda link5, hand", "solo legs", "z1 link1, link2", "ur5 base, upper arm")
SOLVERS = {
    "FCL naive": fcl.collision_data.CCDSolverType.CCDC_NAIVE,
    "FCL advancement": fcl.collision_data.CCDSolverType.CCDC_CONSERVATIVE_ADVANCEMENT,
}


@dataclass(frozen=True)
class Motions:
    """Motions (n, 4, 4) to (n, 4, 4) of b, with a at the world's origin."""

    name: str
    a: Mesh
    b: Mesh
    T0: Poses
    T1: Poses

    def __len__(self) -> int:
        return len(self.T0)

    @property
    def radius(self) -> float:
        """Meters from the origin of b to its farthest vertex."""
        return float(np.linalg.norm(self.b.vertices, axis=1).max())

    def travel(self) -> NDArray[np.float64]:
        """Meters (n,) that no point of b moves beyond."""
        way = np.linalg.norm(self.T1[:, :3, 3] - self.T0[:, :3, 3], axis=1)
        turn = self.T1[:, :3, :3] @ self.T0[:, :3, :3].swapaxes(1, 2)
        cosine = np.clip((np.trace(turn, axis1=1, axis2=2) - 1.0) / 2.0, -1.0, 1.0)
        return np.asarray(way + self.radius * np.arccos(cosine))


def real_motions(count: int, seed: int) -> Iterator[Motions]:
    """Robot links past each other: free at the start, 0.1 to 1 size long, up to 45 degrees."""
    for k, name in enumerate(NAMES):
        pair = next(pair for pair in PAIRS if pair.name == name)
        if not pair.here:
            continue
        a, b = pair.a.load(), pair.b.load()
        rng = np.random.default_rng([seed, 3, k])
        judge = FCL.pair(FCL.build(a), FCL.build(b), np.eye(4)).collide_all
        poses = random_poses_batched(a, b, np.eye(4), 3 * count, judge, rng)
        T0 = poses[~judge(poses)][:count]
        yield Motions(name, a, b, T0, _onward(T0, b.size * 10 ** rng.uniform(-1, 0, len(T0)), rng))


def _onward(T0: Poses, length: NDArray[np.float64], rng: np.random.Generator) -> Poses:
    T1 = T0.copy()
    T1[:, :3, 3] += length[:, None] * random_directions(rng, len(T0))
    turn = turned(random_directions(rng, len(T0)), rng.uniform(0.0, np.pi / 4, len(T0)))
    T1[:, :3, :3] = turn @ T0[:, :3, :3]
    return T1


def bullets(count: int, seed: int) -> Motions:
    """A turning 4 mm cube shot through a plate of 0.1 mm; one in five goes past it."""
    rng = np.random.default_rng([seed, 4])
    plate, cube = (
        Mesh(name, np.asarray(box.vertices), np.asarray(box.faces, np.int32))
        for name, box in (
            ("plate", trimesh.creation.box((0.4, 0.4, 1e-4))),
            ("cube", trimesh.creation.box((0.004, 0.004, 0.004))),
        )
    )
    T0 = np.tile(np.eye(4), (count, 1, 1))
    T0[:, :3, :3] = random_rotations(rng, count)
    T1 = _onward(T0, np.zeros(count), rng)  # turning
    through = rng.uniform(-0.19, 0.19, (count, 2))
    through[: count // 5, 0] += 0.5
    slope = rng.uniform(-0.1, 0.1, (count, 2))
    for T, side in ((T0, -1.0), (T1, 1.0)):
        T[:, :2, 3] = through + side * slope
        T[:, 2, 3] = side * rng.uniform(0.02, 0.3, count)
    return Motions("cube, thin plate", plate, cube, T0, T1)


@contextmanager
def quiet() -> Iterator[None]:
    """Without what a library writes to the process's own streams: FCL has much to say here."""
    sys.stdout.flush()
    kept = [os.dup(stream) for stream in (1, 2)]
    with open(os.devnull, "w", encoding="utf-8") as nothing:
        for stream in (1, 2):
            os.dup2(nothing.fileno(), stream)
    try:
        yield
    finally:
        for stream, old in zip((1, 2), kept, strict=True):
            os.dup2(old, stream)
            os.close(old)


class Fcl:
    """One pair in python-fcl; a at the origin."""

    def __init__(self, motions: Motions) -> None:
        model = FCL.build(motions.b)
        self.pair = FCL.pair(FCL.build(motions.a), model, np.eye(4))
        self.fixed = fcl.CollisionObject(FCL.build(motions.a))
        self.moving, self.here = fcl.CollisionObject(model), fcl.Transform()

    def discrete(self, poses: list[Poses]) -> Flags:
        """Whether any of the poses (k, 4, 4) of each motion collides; stops at the first."""
        return np.array([any(map(self.pair.collide, some)) for some in poses], np.bool_)

    def continuous(self, T0: Poses, T1: Poses, solver: int) -> Flags:
        """Its continuous collision, linear motion, at its own defaults for the rest."""
        request = fcl.ContinuousCollisionRequest(
            ccd_motion_type=fcl.collision_data.CCDMotionType.CCDM_LINEAR, ccd_solver_type=solver
        )
        hits = []
        with quiet():
            for a, b in zip(T0, T1, strict=True):
                self.moving.setTransform(fcl.Transform(a[:3, :3], a[:3, 3]))
                result = fcl.ContinuousCollisionResult()
                there = fcl.Transform(b[:3, :3], b[:3, 3])
                fcl.continuousCollide(self.fixed, self.here, self.moving, there, request, result)
                hits.append(bool(result.is_collide))
        return np.array(hits, np.bool_)


def steps(motions: Motions, step: float) -> list[Poses]:
    """The poses that a discrete check with that step asks for each motion, both ends included."""
    counts = np.maximum(1, np.ceil(motions.travel() / step)).astype(int)
    return [
        np.concatenate([between(a, b, n), b[None]])
        for a, b, n in zip(motions.T0, motions.T1, counts, strict=True)
    ]


def bench_motions(motions: Motions, rounds: int = 5, budget: float = BUDGET) -> Record:
    """Cost of each way on the free motions and on the others, and verdicts of all on all.

    A way that would take more than `budget` seconds for all motions is asked the first of them.
    """
    world = World()
    world.add(FGENV.build(motions.a))
    robot = world.add(FGENV.build(motions.b), motions.T0[0])
    other = Fcl(motions)
    jobs = _ways(world, robot, motions, other)
    result = world.check_motion(robot, motions.T0, motions.T1)
    free = np.asarray(result.free)
    record: Record = {
        "name": motions.name,
        "triangles": [len(motions.a.faces), len(motions.b.faces)],
        "size": motions.b.size,
        "motions": len(motions),
        "free": int(free.sum()),
        "travel": _quartiles(motions.travel()[free]),
        "clearance": _quartiles(_clearance(world, robot, motions, free)),
        "truth": cross_check(motions, other, result),
    }
    asked = {name: _affordable(job, len(motions), budget) for name, job in jobs.items()}
    hits = {name: jobs[name](np.arange(asked[name])) for name in jobs}
    rows_free, rows_met = np.flatnonzero(free), np.flatnonzero(~free)
    seconds_free = _race(jobs, asked, rows_free, rounds)
    seconds_met = _race(jobs, asked, rows_met, rounds)
    record["ways"] = {
        name: {
            "free": seconds_free.get(name),
            "contact": seconds_met.get(name),
            "asked": asked[name],
            "missed": int((~met & ~free[: len(met)]).sum()),
            "false_alarms": int((met & free[: len(met)]).sum()),
        }
        for name, met in hits.items()
    }
    return record


def _ways(world: World, robot: int, motions: Motions, other: Fcl) -> dict[str, Way]:
    """Each way to check motions: rows (k,) of them to verdicts (k,), True for contact."""
    poses = steps(motions, STEP)

    def ours(**how: Any) -> Way:
        def ask(rows: Indices) -> Flags:
            T0, T1 = motions.T0[rows], motions.T1[rows]
            return ~np.asarray(world.check_motion(robot, T0, T1, threads=1, **how).free)

        return ask

    def theirs(solver: int) -> Way:
        return lambda rows: other.continuous(motions.T0[rows], motions.T1[rows], solver)

    return {
        "continuous": ours(),
        "any contact": ours(first_contact=False),
        "discrete 1 cm": ours(mode="discrete", resolution=STEP),
        "FCL discrete 1 cm": lambda rows: other.discrete([poses[k] for k in rows]),
        **{name: theirs(solver) for name, solver in SOLVERS.items()},
    }


def _affordable(job: Way, count: int, budget: float) -> int:
    """How many motions, the first ones, the budget (s) is enough for."""
    began = process_time()
    job(np.arange(min(3, count)))
    return int(np.clip(3 * budget / (process_time() - began + 1e-9), min(10, count), count))


def cross_check(motions: Motions, other: Fcl, result: Any) -> Record:
    """The certified result against python-fcl: sampled densely, and at each contact shown.

    `contradicted`: proved free, and python-fcl finds a pose that collides; must be 0.
    `sampling_missed`: contacts that are shown and that even dense sampling steps over.
    """
    ends = zip(motions.T0, motions.T1, strict=True)
    dense = other.discrete([between(a, b, DENSE) for a, b in ends])
    free, by = np.asarray(result.free), np.asarray(result.contact_by)
    shown = [
        other.pair.collide(_at(motions, int(k), float(by[k])))
        for k in np.flatnonzero(~free & np.isfinite(by))
    ]
    return {
        "contradicted": int((free & dense).sum()),
        "sampling_missed": int((~free & ~dense).sum()),
        "contacts_confirmed": int(np.sum(shown)),
        "contacts": len(shown),
        "unresolved": int(np.isnan(by).sum()),
    }


def _at(motions: Motions, k: int, fraction: float) -> Poses:
    """The pose (4, 4) of a motion at a fraction of it."""
    return np.asarray(along(motions.T0[k], motions.T1[k], np.array([fraction]))[0])


def _clearance(world: World, robot: int, motions: Motions, free: Flags) -> NDArray[np.float64]:
    """Least distance (n,) on the way, looked for at 16 poses of each free motion, in sizes."""
    pairs = zip(motions.T0[free], motions.T1[free], strict=True)
    poses = np.array([between(a, b, 16) for a, b in pairs]).reshape(-1, 16, 4, 4)
    least = world.clearance(robot, poses).distance.min(axis=1)
    return np.asarray(least / motions.b.size)


def _quartiles(values: NDArray[np.float64]) -> list[float]:
    return [float(v) for v in np.quantile(values, (0.25, 0.5, 0.75))] if len(values) else []


def _race(
    jobs: Mapping[str, Way], asked: Mapping[str, int], rows: Indices, rounds: int
) -> dict[str, float]:
    """Median CPU-seconds per motion of each method, in turns; slow methods run once."""
    taken: dict[str, list[float]] = {name: [] for name in jobs}
    order, every = list(jobs), max(asked.values())
    for turn in range(rounds):
        for name in order[turn % len(order) :] + order[: turn % len(order)]:
            some = rows[rows < asked[name]]
            if len(some) and (asked[name] == every or not taken[name]):
                began = process_time()
                jobs[name](some)
                taken[name].append((process_time() - began) / len(some))
    return {name: float(np.median(times)) for name, times in taken.items() if times}
