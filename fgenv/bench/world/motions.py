"""Motions of a body past another: certified, discrete, FCL's continuous; cost and correctness."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any

import fcl
import numpy as np
import trimesh
from numpy.typing import NDArray

from fgenv.arrays import Flags, Indices, Poses
from fgenv.bench.common.meshes import Mesh
from fgenv.bench.common.poses import random_directions, random_poses_batched, random_rotations
from fgenv.bench.common.records import Record
from fgenv.bench.common.timing import affordable, median_seconds
from fgenv.bench.pairs.catalog import PAIRS
from fgenv.bench.peers.fcl_ import PEER as FCL
from fgenv.bench.peers.fgenv_ import PEER as FGENV
from fgenv.bench.world.crowd import turned
from fgenv.bench.world.movers import along, between
from fgenv.collision import World

Method = Callable[[Indices], Flags]  # indices (k,) of motions to verdicts (k,), True for contact
STEP = 0.01  # meters that any point moves in a step of the discrete check
DENSE = 1000  # poses per motion in the cross-check
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
        """Return upper bounds (n,) of the travel of any point of b, meters."""
        shift = np.linalg.norm(self.T1[:, :3, 3] - self.T0[:, :3, 3], axis=1)
        turn = self.T1[:, :3, :3] @ self.T0[:, :3, :3].swapaxes(1, 2)
        cosine = np.clip((np.trace(turn, axis1=1, axis2=2) - 1.0) / 2.0, -1.0, 1.0)
        return np.asarray(shift + self.radius * np.arccos(cosine))


def real_motions(count: int, seed: int) -> Iterator[Motions]:
    """Yield motions of robot links: free at the start, 0.1 to 1 size long, up to 45 degrees."""
    for k, name in enumerate(NAMES):
        pair = next(pair for pair in PAIRS if pair.name == name)
        if not pair.available:
            continue
        a, b = pair.a.load(), pair.b.load()
        rng = np.random.default_rng([seed, 3, k])
        reference = FCL.pair(FCL.build(a), FCL.build(b), np.eye(4)).collide_all
        poses = random_poses_batched(a, b, np.eye(4), 3 * count, reference, rng)
        T0 = poses[~reference(poses)][:count]
        yield Motions(name, a, b, T0, _ends(T0, b.size * 10 ** rng.uniform(-1, 0, len(T0)), rng))


def _ends(T0: Poses, length: NDArray[np.float64], rng: np.random.Generator) -> Poses:
    T1 = T0.copy()
    T1[:, :3, 3] += length[:, None] * random_directions(rng, len(T0))
    turn = turned(random_directions(rng, len(T0)), rng.uniform(0.0, np.pi / 4, len(T0)))
    T1[:, :3, :3] = turn @ T0[:, :3, :3]
    return T1


def bullets(count: int, seed: int) -> Motions:
    """Return motions of a turning 4 mm cube through a plate of 0.1 mm; one in five misses it."""
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
    T1 = _ends(T0, np.zeros(count), rng)  # turning
    through = rng.uniform(-0.19, 0.19, (count, 2))
    through[: count // 5, 0] += 0.5
    slope = rng.uniform(-0.1, 0.1, (count, 2))
    for T, side in ((T0, -1.0), (T1, 1.0)):
        T[:, :2, 3] = through + side * slope
        T[:, 2, 3] = side * rng.uniform(0.02, 0.3, count)
    return Motions("cube, thin plate", plate, cube, T0, T1)


@contextmanager
def quiet() -> Iterator[None]:
    """Discard the output of a library to the streams of the process: FCL prints much here."""
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


class FclPair:
    """A pair in python-fcl; a at the origin."""

    def __init__(self, motions: Motions) -> None:
        model = FCL.build(motions.b)
        self.checker = FCL.pair(FCL.build(motions.a), model, np.eye(4))
        self.fixed = fcl.CollisionObject(FCL.build(motions.a))
        self.moving, self.here = fcl.CollisionObject(model), fcl.Transform()

    def discrete(self, poses: list[Poses]) -> Flags:
        """Return whether any pose (k, 4, 4) of each motion collides; stops at the first."""
        return np.array([any(map(self.checker.collide, motion)) for motion in poses], np.bool_)

    def continuous(self, T0: Poses, T1: Poses, solver: int) -> Flags:
        """Return verdicts of FCL's continuous collision: linear motion, defaults for the rest."""
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
    """Return the poses of a discrete check with that step for each motion, with both ends."""
    counts = np.maximum(1, np.ceil(motions.travel() / step)).astype(int)
    return [
        np.concatenate([between(a, b, n), b[None]])
        for a, b, n in zip(motions.T0, motions.T1, counts, strict=True)
    ]


def bench_motions(motions: Motions, rounds: int = 5, budget: float = BUDGET) -> Record:
    """Return costs of each method on free motions and on the others, and verdicts on all.

    A method that would take more than `budget` seconds gets only the first motions.
    """
    world = World()
    world.add(FGENV.build(motions.a))
    robot = world.add(FGENV.build(motions.b), motions.T0[0])
    fcl_pair = FclPair(motions)
    result = world.check_motion(robot, motions.T0, motions.T1)
    free = np.asarray(result.free)
    return {
        "name": motions.name,
        "triangles": [len(motions.a.faces), len(motions.b.faces)],
        "size": motions.b.size,
        "motions": len(motions),
        "free": int(free.sum()),
        "travel": _quartiles(motions.travel()[free]),
        "clearance": _quartiles(_clearance(world, robot, motions, free)),
        "truth": cross_check(motions, fcl_pair, result),
        "ways": _compare(_methods(world, robot, motions, fcl_pair), free, rounds, budget),
    }


def _compare(methods: Mapping[str, Method], free: Flags, rounds: int, budget: float) -> Record:
    """Return seconds per motion and wrong verdicts of each method."""
    rows = np.arange(len(free))
    limits = {
        name: affordable(method, rows, budget, least=10, trial=3)
        for name, method in methods.items()
    }
    hits = {name: method(rows[: limits[name]]) for name, method in methods.items()}
    seconds_free = _race(methods, limits, np.flatnonzero(free), rounds)
    seconds_contact = _race(methods, limits, np.flatnonzero(~free), rounds)
    return {
        name: {
            "free": seconds_free.get(name),
            "contact": seconds_contact.get(name),
            "asked": limits[name],
            "missed": int((~hit & ~free[: len(hit)]).sum()),
            "false_alarms": int((hit & free[: len(hit)]).sum()),
        }
        for name, hit in hits.items()
    }


def _methods(world: World, robot: int, motions: Motions, pair: FclPair) -> dict[str, Method]:
    """Return the methods to check motions."""
    poses = steps(motions, STEP)

    def check(rows: Indices, **options: Any) -> Flags:
        T0, T1 = motions.T0[rows], motions.T1[rows]
        return ~np.asarray(world.check_motion(robot, T0, T1, threads=1, **options).free)

    def continuous(rows: Indices, solver: int) -> Flags:
        return pair.continuous(motions.T0[rows], motions.T1[rows], solver)

    return {
        "continuous": check,
        "any contact": partial(check, first_contact=False),
        "discrete 1 cm": partial(check, mode="discrete", resolution=STEP),
        "FCL discrete 1 cm": lambda rows: pair.discrete([poses[k] for k in rows]),
        **{name: partial(continuous, solver=solver) for name, solver in SOLVERS.items()},
    }


def cross_check(motions: Motions, pair: FclPair, result: Any) -> Record:
    """Compare the certified result with python-fcl, on dense samples and at each contact.

    `contradicted`: certified free, and python-fcl finds a pose that collides; must be 0.
    `sampling_missed`: contacts that dense sampling misses.
    """
    ends = zip(motions.T0, motions.T1, strict=True)
    dense = pair.discrete([between(a, b, DENSE) for a, b in ends])
    free, by = np.asarray(result.free), np.asarray(result.contact_by)
    confirmed = [
        pair.checker.collide(_at(motions, int(k), float(by[k])))
        for k in np.flatnonzero(~free & np.isfinite(by))
    ]
    return {
        "contradicted": int((free & dense).sum()),
        "sampling_missed": int((~free & ~dense).sum()),
        "contacts_confirmed": int(np.sum(confirmed)),
        "contacts": len(confirmed),
        "unresolved": int(np.isnan(by).sum()),
    }


def _at(motions: Motions, k: int, fraction: float) -> Poses:
    """Return the pose (4, 4) of a motion at a fraction of it."""
    return np.asarray(along(motions.T0[k], motions.T1[k], np.array([fraction]))[0])


def _clearance(world: World, robot: int, motions: Motions, free: Flags) -> NDArray[np.float64]:
    """Return the least distance (n,) at 16 poses of each free motion, in sizes."""
    pairs = zip(motions.T0[free], motions.T1[free], strict=True)
    poses = np.array([between(a, b, 16) for a, b in pairs]).reshape(-1, 16, 4, 4)
    least = world.clearance(robot, poses).distance.min(axis=1)
    return np.asarray(least / motions.b.size)


def _quartiles(values: NDArray[np.float64]) -> list[float]:
    return [float(v) for v in np.quantile(values, (0.25, 0.5, 0.75))] if len(values) else []


def _race(
    methods: Mapping[str, Method], limits: Mapping[str, int], rows: Indices, rounds: int
) -> dict[str, float]:
    """Return median CPU seconds per motion of each method, in turns; limited methods run once."""
    parts = {name: part for name, last in limits.items() if len(part := rows[rows < last])}
    jobs = {name: partial(methods[name], part) for name, part in parts.items()}
    whole = {name: job for name, job in jobs.items() if limits[name] == max(limits.values())}
    limited = {name: job for name, job in jobs.items() if name not in whole}
    seconds = median_seconds(whole, rounds) | median_seconds(limited, 1)
    return {name: seconds[name] / len(part) for name, part in parts.items()}
