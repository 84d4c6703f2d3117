"""Movers with paths among N bodies that stand: what a check costs, and what masks leave to test."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from time import perf_counter, process_time
from typing import Any

import numpy as np

from fgenv.arrays import Floats, Poses
from fgenv.bench.common.meshes import Mesh
from fgenv.bench.common.poses import random_directions, random_rotations
from fgenv.bench.peers.fgenv_ import PEER
from fgenv.bench.world.crowd import SPACING, Crowd, crowd, turned
from fgenv.collision import World

Record = dict[str, Any]
MOVERS, LEGS, PIECES, SAMPLES = 8, 4, 4, 32  # legs a path; pieces and poses a leg
ROUNDS = 7
OFF_POSES = 4  # poses a mover that are tested without masks, which is dear


@dataclass(frozen=True)
class Paths:
    """Way points (m, LEGS + 1, 4, 4) of m movers; `poses` and `pieces` cut the legs."""

    points: Poses

    def cut(self, parts: int) -> Poses:
        """Poses (m, LEGS * parts + 1, 4, 4) along the paths, linear and by the shortest arc."""
        legs = [between(a, b, parts) for path in self.points for a, b in pairwise(path)]
        cut = np.reshape(legs, (len(self.points), LEGS * parts, 4, 4))
        return np.concatenate([cut, self.points[:, -1:]], axis=1)


def between(T0: Poses, T1: Poses, parts: int) -> Poses:
    """Poses (parts, 4, 4) from T0 on, evenly towards T1, which is left out."""
    return along(T0, T1, np.arange(parts) / parts)


def along(T0: Poses, T1: Poses, fractions: Floats) -> Poses:
    """Poses (k, 4, 4) at fractions (k,): position linear, orientation by the shortest arc."""
    poses = np.tile(T0, (len(fractions), 1, 1))
    poses[:, :3, 3] += fractions[:, None] * (T1[:3, 3] - T0[:3, 3])
    way = T1[:3, :3] @ T0[:3, :3].T
    axis = np.array([way[2, 1] - way[1, 2], way[0, 2] - way[2, 0], way[1, 0] - way[0, 1]])
    length = float(np.linalg.norm(axis))
    if length > 0.0:
        angles = np.arctan2(length, np.trace(way) - 1.0) * fractions
        poses[:, :3, :3] = turned(np.tile(axis / length, (len(angles), 1)), angles) @ T0[:3, :3]
    return poses


class Scenes:
    """Worlds of different sizes around the same paths: the smaller are the middles of the largest.

    All worlds have the same bodies near the movers, and differ in the surroundings.
    """

    def __init__(self, mesh: Mesh, sizes: Sequence[int], seed: int) -> None:
        self.mesh, self.shape = mesh, PEER.build(mesh)
        self.rng = np.random.default_rng([seed, 2])
        self.still: Crowd = crowd(mesh, max(sizes), self.rng)
        self.places = self.still.poses(0)
        inner = SPACING * mesh.size * min(100, *sizes) ** (1 / 3) / 2
        self.room = max(inner - 1.5 * mesh.size, 0.5 * inner)  # that movers keep to
        self.paths = Paths(np.zeros((0, LEGS + 1, 4, 4)))
        draft = self.world(min(1000, max(sizes)))
        self.paths = Paths(np.array([self._path(draft) for _ in range(MOVERS)]))

    def world(self, count: int, masks: str = "path") -> World:
        """The first `count` bodies, and the movers, named, at the starts of their paths."""
        world = World(masks=masks)
        for k, path in enumerate(self.paths.points):
            world.add(self.shape, path[0], name=f"mover {k}")
        for pose in self.places[:count]:
            world.add(self.shape, pose)
        return world

    def _path(self, world: World) -> Poses:
        """A free path of legs half to one and a half sizes long, in the middle."""
        name = f"mover {world.ids.size}"
        ghost = world.add(self.shape, self._somewhere(), name=name)
        while True:
            path = [self._somewhere()]
            for _ in range(200):
                there = self._onward(path[-1])
                if world.check_motion(ghost, path[-1], there):
                    path.append(there)
                if len(path) > LEGS:
                    world.set_pose(ghost, path[0])  # others go around it
                    return np.array(path)

    def _somewhere(self) -> Poses:
        pose = np.eye(4)
        pose[:3, :3] = random_rotations(self.rng, 1)[0]
        pose[:3, 3] = self.still.middle + self.rng.uniform(-self.room, self.room, 3)
        return pose

    def _onward(self, pose: Poses) -> Poses:
        there = pose.copy()
        length = self.mesh.size * self.rng.uniform(0.5, 1.5)
        there[:3, 3] += length * random_directions(self.rng, 1)[0]
        low, high = self.still.middle - self.room, self.still.middle + self.room
        there[:3, 3] = np.clip(there[:3, 3], low, high)
        turn = turned(random_directions(self.rng, 1), self.rng.uniform(0.0, np.pi / 4, 1))[0]
        there[:3, :3] = turn @ pose[:3, :3]
        return there


def bench_movers(mesh: Mesh, sizes: Sequence[int], seed: int, rounds: int = ROUNDS) -> Record:
    """Costs of a mover's checks in worlds of all sizes, in turns; seconds, bytes and tests."""
    scenes = Scenes(mesh, sizes, seed)
    poses, cut = scenes.paths.cut(SAMPLES), scenes.paths.cut(PIECES)
    worlds = {count: scenes.world(count) for count in sizes}
    rows: dict[int, Record] = {count: {"bodies": count} for count in sizes}
    for count, world in worlds.items():
        found = [len(world.set_path(f"mover {k}", p)) for k, p in enumerate(scenes.paths.points)]
        rows[count]["candidates"] = float(np.mean(found))
        rows[count]["bytes_per_body"] = world.nbytes / len(world)
    jobs: dict[str, tuple[Callable[[World, str, int], object], float]] = {
        "set_path": (lambda w, name, k: w.set_path(name, scenes.paths.points[k]), 1),
        "collides": (lambda w, name, k: w.collides(name, poses[k], threads=1), poses.shape[1]),
        "check_motion": (
            lambda w, name, k: w.check_motion(name, cut[k, :-1], cut[k, 1:], threads=1),
            cut.shape[1] - 1,
        ),
        "discrete 1 cm": (
            lambda w, name, k: w.check_motion(
                name, cut[k, :-1], cut[k, 1:], mode="discrete", resolution=0.01, threads=1
            ),
            cut.shape[1] - 1,
        ),
    }
    for what, (job, each) in jobs.items():
        for count, seconds in _race(worlds, job, rounds).items():
            rows[count][what] = seconds / each
    for count, world in worlds.items():
        rows[count]["tests"] = _tests(scenes, world, count, poses)
    record: Record = {
        "triangles": len(mesh.faces),
        "movers": MOVERS,
        "legs": LEGS,
        "motion_length": _mean_length(cut) / mesh.size,
        "free": float(np.mean([_free(worlds[max(sizes)], k, cut[k]) for k in range(MOVERS)])),
        "rows": list(rows.values()),
    }
    record["growth"] = {k: rows[max(sizes)][k] / rows[min(sizes)][k] for k in jobs}
    return record


def _race(
    worlds: Mapping[int, World], job: Callable[[World, str, int], object], rounds: int
) -> dict[int, float]:
    """Median CPU seconds of the job for one mover, worlds in turn."""
    taken: dict[int, list[float]] = {count: [] for count in worlds}
    order = list(worlds)
    for turn in range(rounds + 1):
        first = turn % len(order)
        for count in order[first:] + order[:first]:
            began = process_time()
            for k in range(MOVERS):
                job(worlds[count], f"mover {k}", k)
            taken[count].append((process_time() - began) / MOVERS)
    return {count: float(np.median(times[1:])) for count, times in taken.items()}


def _tests(scenes: Scenes, world: World, count: int, poses: Poses) -> dict[str, float]:
    """Pairs of bodies tested for one pose of a mover: with masks, as published, without."""
    found = {}
    for masks in ("path", "published", "off"):
        some = poses[:, :: -(-poses.shape[1] // OFF_POSES)] if masks == "off" else poses
        asked = world if masks == "path" else scenes.world(count, masks)
        for k, points in enumerate(scenes.paths.points):
            asked.set_path(f"mover {k}", points)
        before = asked.tests
        for k in range(MOVERS):
            asked.collides(f"mover {k}", some[k], threads=1)
        found[masks] = (asked.tests - before) / (MOVERS * some.shape[1])
    return found


def _free(world: World, k: int, cut: Poses) -> float:
    return float(np.mean(world.check_motion(f"mover {k}", cut[:-1], cut[1:]).free))


def _mean_length(cut: Poses) -> float:
    return float(np.linalg.norm(np.diff(cut[:, :, :3, 3], axis=1), axis=-1).mean())


def bench_threads(mesh: Mesh, count: int, seed: int, rounds: int = ROUNDS) -> dict[str, float]:
    """How many times two threads are faster than one, by the clock: least of the rounds each."""
    scenes = Scenes(mesh, [count], seed)
    world = scenes.world(count)
    poses, cut = scenes.paths.cut(1000)[0], scenes.paths.cut(200)[0]
    world.set_path("mover 0", scenes.paths.points[0])
    jobs: dict[str, Callable[[int], object]] = {
        "contacts": lambda n: world.contact_pairs(threads=n),
        "collides": lambda n: world.collides("mover 0", poses, threads=n),
        "check_motion": lambda n: world.check_motion("mover 0", cut[:-1], cut[1:], threads=n),
    }
    found = {}
    for name, job in jobs.items():
        least = {1: np.inf, 2: np.inf}
        for _ in range(rounds):
            for n in least:
                began = perf_counter()
                job(n)
                least[n] = min(least[n], perf_counter() - began)
        found[name] = float(least[1] / least[2])
    return found
