"""The measurements of ``fgenv bench pairs`` on one pair of meshes, for all libraries."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fgenv.arrays import Flags, Floats, Poses
from fgenv.bench.common.memory import kept_bytes
from fgenv.bench.common.poses import random_poses_batched, random_rotations
from fgenv.bench.common.records import Record
from fgenv.bench.common.timing import each_call, median_seconds, race
from fgenv.bench.pairs.catalog import Pair
from fgenv.bench.peers import Checker, Peer

BUDGET = 4.0  # seconds per library for one column of one pair
DISTANCE_POSES, CALL_POSES = 400, 2000


class PairRace:
    """The models, checkers and poses of one pair. `decades`: see `random_poses_batched`."""

    def __init__(
        self,
        pair: Pair,
        peers: list[Peer],
        count: int,
        rng: np.random.Generator,
        decades: tuple[float, float],
    ) -> None:
        self.pair, self.peers = pair, peers
        self.a, self.b = pair.a.load(), pair.b.load()
        self.pose_a = np.eye(4)
        self.pose_a[:3, :3] = random_rotations(rng, 1)[0]
        self.pose_a[:3, 3] = rng.normal(size=3)
        self.models = {p.name: (p.build(self.a), p.build(self.b)) for p in peers}
        self.checkers: dict[str, Checker] = {
            p.name: p.pair(*self.models[p.name], self.pose_a) for p in peers
        }
        # The reference, not fgenv, places the poses and classifies them as free or hit.
        reference = self.checkers.get("python-fcl") or self.checkers[peers[0].name]
        self.poses = random_poses_batched(
            self.a, self.b, self.pose_a, count, reference.collide_all, rng, decades
        )
        self.hits = reference.collide_all(self.poses)

    def run(self) -> Record:
        """Return all measurements, times in seconds."""
        record: Record = {
            "pair": self.pair.name,
            "triangles": [len(self.a.faces), len(self.b.faces)],
            "poses": len(self.poses),
            "hit_share": float(self.hits.mean()),
            "peers": {p.name: {"truth": p.truth} for p in self.peers},
        }
        self._verdicts(record["peers"])
        self._collide(record["peers"])
        self._calls(record["peers"])
        self._distance(record["peers"])
        self._builds(record["peers"])
        return record

    def _verdicts(self, out: Record) -> None:
        """Count the verdicts that differ from the reference's (fgenv also detects containment)."""
        for name, checker in self.checkers.items():
            part = slice(0, 100 if name == "embree" else None)
            differ = checker.collide_all(self.poses[part]) != self.hits[part]
            out[name]["differ"] = int(differ.sum())

    def _collide(self, out: Record) -> None:
        jobs = {name: checker.collide_all for name, checker in self.checkers.items()}
        for kind, poses in self._kinds():
            for name, seconds in race(jobs, poses, budget=BUDGET).items():
                out[name].setdefault("batch", {})[kind] = seconds

    def _kinds(self) -> list[tuple[str, Poses]]:
        free, hit = self.poses[~self.hits], self.poses[self.hits]
        parts = (("mean", self.poses), ("free", free), ("hit", hit))
        return [(kind, poses) for kind, poses in parts if len(poses)]

    def _calls(self, out: Record) -> None:
        for name, checker in self.checkers.items():
            part = slice(0, 50 if name == "embree" else CALL_POSES)
            seconds, hits = each_call(checker.collide, self.poses[part]), self.hits[part]
            out[name]["call"] = _spread(seconds, hits)

    def _distance(self, out: Record) -> None:
        poses = self.poses[~self.hits][:DISTANCE_POSES]
        jobs: dict[str, Callable[[Poses], Any]] = {
            name: checker.distance_all
            for name, checker in self.checkers.items()
            if checker.distance_all is not None
        }
        if not jobs or not len(poses):
            return
        for name, seconds in race(jobs, poses, rounds=3, budget=BUDGET).items():
            out[name]["distance"] = seconds

    def _builds(self, out: Record) -> None:
        builders = [p for p in self.peers if p.name not in ("trimesh", "mujoco", "embree")]
        jobs = {p.name: (lambda p=p: (p.build(self.a), p.build(self.b))) for p in builders}
        for name, seconds in median_seconds(jobs).items():
            out[name]["build"] = seconds
        triangles = len(self.a.faces) + len(self.b.faces)
        for p in builders:
            models = self.models[p.name]
            size = sum(map(p.nbytes, models)) if p.nbytes else kept_bytes(jobs[p.name])
            if size is not None:
                out[p.name]["bytes_per_triangle"] = size / triangles


def _spread(seconds: Floats, hits: Flags) -> Record:
    record: Record = {}
    for kind, part in (("", seconds), ("_free", seconds[~hits]), ("_hit", seconds[hits])):
        if len(part):
            record[f"mean{kind}"] = float(part.mean())
            record[f"p99{kind}"] = float(np.quantile(part, 0.99))
    return record
