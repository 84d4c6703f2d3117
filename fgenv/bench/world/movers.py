"""Movers with paths among N bodies at rest: costs of checks, and the pairs that masks leave."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from time import perf_counter
from typing import Any

import numpy as np

from fgenv.arrays import Floats, Poses
from fgenv.bench.common.meshes import Mesh
from fgenv.bench.common.poses import random_directions, random_rotations
from fgenv.bench.common.records import Record
from fgenv.bench.common.timing import round_seconds
from fgenv.bench.peers.fgenv_ import PEER
from fgenv.bench.world.crowd import SPACING, Crowd, crowd, turned
from fgenv.collision import World

MOVERS, LEGS, PIECES, SAMPLES = 8, 4, 4, 32  # legs per path; pieces and poses per leg
ROUNDS = 7
OFF_POSES = 4  # poses per mover that are tested without masks, which is slow


@dataclass(frozen=True)
class Paths:
    """Waypoints (m, LEGS + 1, 4, 4) of m movers."""

    points: Poses

    def cut(self, parts: int) -> Poses:
        """Return poses (m, LEGS * parts + 1, 4, 4) along the paths, see `along`."""
        legs = [between(a, b, parts) for path in self.points for a, b in pairwise(path)]
        cut = np.reshape(legs, (len(self.points), LEGS * parts, 4, 4))
        return np.concatenate([cut, self.points[:, -1:]], axis=1)


def between(T0: Poses, T1: Poses, parts: int) -> Poses:
    """Return poses (parts, 4, 4) from T0, evenly towards T1, which is left out."""
    return along(T0, T1, np.arange(parts) / parts)


def along(T0: Poses, T1: Poses, fractions: Floats) -> Poses:
    """Return poses (k, 4, 4) at fractions (k,): linear position, shortest arc of orientation."""
    poses = np.tile(T0, (len(fractions), 1, 1))
    poses[:, :3, 3] += fractions[:, None] * (T1[:3, 3] - T0[:3, 3])
    turn = T1[:3, :3] @ T0[:3, :3].T
    axis = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    length = float(np.linalg.norm(axis))
    if length > 0.0:
        angles = np.arctan2(length, np.trace(turn) - 1.0) * fractions
        poses[:, :3, :3] = turned(np.tile(axis / length, (len(angles), 1)), angles) @ T0[:3, :3]
    return poses


class Scenes:
    """Worlds of different sizes around the same paths; the smaller ones are parts of the largest.

    All worlds have the same bodies near the movers, and differ in the surroundings.
    """

    def __init__(self, mesh: Mesh, sizes: Sequence[int], seed: int) -> None:
        self.mesh, self.shape = mesh, PEER.build(mesh)
        self.rng = np.random.default_rng([seed, 2])
        self.crowd: Crowd = crowd(mesh, max(sizes), self.rng)
        self.places = self.crowd.poses(0)
        inner = SPACING * mesh.size * min(100, *sizes) ** (1 / 3) / 2
        self.room = max(inner - 1.5 * mesh.size, 0.5 * inner)  # half the side of the movers' cube
        self.paths = Paths(np.zeros((0, LEGS + 1, 4, 4)))
        draft = self.world(min(1000, max(sizes)))
        self.paths = Paths(np.array([self._path(draft) for _ in range(MOVERS)]))

    def world(self, count: int, masks: str = "path") -> World:
        """Return a world with the first `count` bodies and the movers at their starts."""
        world = World(masks=masks)
        for k, path in enumerate(self.paths.points):
            world.add(self.shape, path[0], name=f"mover {k}")
        for pose in self.places[:count]:
            world.add(self.shape, pose)
        return world

    def _path(self, world: World) -> Poses:
        """Return a free path in the middle, with legs of 0.5 to 1.5 sizes."""
        name = f"mover {world.ids.size}"
        ghost = world.add(self.shape, self._random_pose(), name=name)
        while True:
            path = [self._random_pose()]
            for _ in range(200):
                pose = self._next_pose(path[-1])
                if world.check_motion(ghost, path[-1], pose):
                    path.append(pose)
                if len(path) > LEGS:
                    world.set_pose(ghost, path[0])  # later paths avoid it
                    return np.array(path)

    def _random_pose(self) -> Poses:
        pose = np.eye(4)
        pose[:3, :3] = random_rotations(self.rng, 1)[0]
        pose[:3, 3] = self.crowd.middle + self.rng.uniform(-self.room, self.room, 3)
        return pose

    def _next_pose(self, pose: Poses) -> Poses:
        there = pose.copy()
        length = self.mesh.size * self.rng.uniform(0.5, 1.5)
        there[:3, 3] += length * random_directions(self.rng, 1)[0]
        low, high = self.crowd.middle - self.room, self.crowd.middle + self.room
        there[:3, 3] = np.clip(there[:3, 3], low, high)
        turn = turned(random_directions(self.rng, 1), self.rng.uniform(0.0, np.pi / 4, 1))[0]
        there[:3, :3] = turn @ pose[:3, :3]
        return there


MoverJob = Callable[[World, str, int], object]  # of a world, a mover's name and its index


def bench_movers(mesh: Mesh, sizes: Sequence[int], seed: int, rounds: int = ROUNDS) -> Record:
    """Return costs of a mover's checks in worlds of all sizes, in turns; seconds, bytes, tests."""
    scenes = Scenes(mesh, sizes, seed)
    poses, cut = scenes.paths.cut(SAMPLES), scenes.paths.cut(PIECES)
    worlds = {count: scenes.world(count) for count in sizes}
    rows: dict[int, Record] = {count: {"bodies": count} for count in sizes}
    for count, world in worlds.items():
        candidates = [
            len(world.set_path(f"mover {k}", p)) for k, p in enumerate(scenes.paths.points)
        ]
        rows[count]["candidates"] = float(np.mean(candidates))
        rows[count]["bytes_per_body"] = world.nbytes / len(world)
    jobs = _mover_jobs(scenes.paths.points, poses, cut)
    for name, (job, checks) in jobs.items():
        for count, seconds in _race(worlds, job, rounds).items():
            rows[count][name] = seconds / checks
    for count, world in worlds.items():
        rows[count]["tests"] = _tests(scenes, world, count, poses)
    free = [_free(worlds[max(sizes)], k, cut[k]) for k in range(MOVERS)]
    return {
        "triangles": len(mesh.faces),
        "movers": MOVERS,
        "legs": LEGS,
        "motion_length": _mean_length(cut) / mesh.size,
        "free": float(np.mean(free)),
        "rows": list(rows.values()),
        "growth": {k: rows[max(sizes)][k] / rows[min(sizes)][k] for k in jobs},
    }


def _mover_jobs(points: Poses, poses: Poses, cut: Poses) -> dict[str, tuple[MoverJob, int]]:
    """Return the jobs by name, each with its number of checks per mover."""
    motions = cut.shape[1] - 1

    def check(world: World, name: str, k: int, **options: Any) -> object:
        return world.check_motion(name, cut[k, :-1], cut[k, 1:], threads=1, **options)

    return {
        "set_path": (lambda world, name, k: world.set_path(name, points[k]), 1),
        "collides": (
            lambda world, name, k: world.collides(name, poses[k], threads=1),
            poses.shape[1],
        ),
        "check_motion": (check, motions),
        "discrete 1 cm": (partial(check, mode="discrete", resolution=0.01), motions),
    }


def _race(worlds: Mapping[int, World], job: MoverJob, rounds: int) -> dict[int, float]:
    """Return the median CPU seconds of the job per mover, worlds in turn, after a first round."""

    def run(world: World) -> None:
        for k in range(MOVERS):
            job(world, f"mover {k}", k)

    seconds = round_seconds({n: partial(run, world) for n, world in worlds.items()}, rounds + 1)
    return {count: float(np.median(times[1:])) / MOVERS for count, times in seconds.items()}


def _tests(scenes: Scenes, world: World, count: int, poses: Poses) -> dict[str, float]:
    """Return the pairs tested per pose of a mover: with masks, as published, without."""
    tests = {}
    for masks in ("path", "published", "off"):
        part = poses[:, :: -(-poses.shape[1] // OFF_POSES)] if masks == "off" else poses
        checked = world if masks == "path" else scenes.world(count, masks)
        for k, points in enumerate(scenes.paths.points):
            checked.set_path(f"mover {k}", points)
        before = checked.tests
        for k in range(MOVERS):
            checked.collides(f"mover {k}", part[k], threads=1)
        tests[masks] = (checked.tests - before) / (MOVERS * part.shape[1])
    return tests


def _free(world: World, k: int, cut: Poses) -> float:
    return float(np.mean(world.check_motion(f"mover {k}", cut[:-1], cut[1:]).free))


def _mean_length(cut: Poses) -> float:
    return float(np.linalg.norm(np.diff(cut[:, :, :3, 3], axis=1), axis=-1).mean())


def bench_threads(mesh: Mesh, count: int, seed: int, rounds: int = ROUNDS) -> dict[str, float]:
    """Return speed-ups of two threads over one, by the wall clock, least time of the rounds."""
    scenes = Scenes(mesh, [count], seed)
    world = scenes.world(count)
    poses, cut = scenes.paths.cut(1000)[0], scenes.paths.cut(200)[0]
    world.set_path("mover 0", scenes.paths.points[0])
    jobs: dict[str, Callable[[int], object]] = {
        "contacts": lambda n: world.contact_pairs(threads=n),
        "collides": lambda n: world.collides("mover 0", poses, threads=n),
        "check_motion": lambda n: world.check_motion("mover 0", cut[:-1], cut[1:], threads=n),
    }
    speed_ups = {}
    for name, job in jobs.items():
        seconds = round_seconds({n: partial(job, n) for n in (1, 2)}, rounds, clock=perf_counter)
        speed_ups[name] = float(seconds[1].min() / seconds[2].min())
    return speed_ups
