"""All pairs per step: N bodies drift and turn; each library moves them and finds all collisions."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from time import process_time
from typing import Any, NamedTuple

import numpy as np

from fgenv.arrays import Poses
from fgenv.bench.common.memory import kept_bytes
from fgenv.bench.common.meshes import Mesh
from fgenv.bench.common.records import Record
from fgenv.bench.common.timing import rotated, timed
from fgenv.bench.peers.ground_truth import Truth
from fgenv.bench.world.crowd import Crowd, crowd
from fgenv.bench.world.peers import Bodies, Manager, Pairs

REFERENCE = "python-fcl"
CHECKED = 3  # steps with compared pairs, at most the seconds of the budget
MAX_BYTES = 1e9  # per library: some keep a tree for each body
Cost = tuple[float, float]  # seconds per step and bytes, per body


class Limits(NamedTuple):
    """Number of timed steps, and seconds per library."""

    steps: int
    budget: float


def bench_steps(
    mesh: Mesh,
    count: int,
    managers: Sequence[Manager],
    seed: int,
    limits: Limits,
    costs: dict[str, Cost],
) -> Record:
    """Return seconds per step of each library with `count` bodies, pairs, verdicts, memory.

    A library that would exceed the budget or the memory is left out. `costs` holds the costs with
    fewer bodies, and is updated.
    """
    moving = crowd(mesh, count, np.random.default_rng([seed, len(mesh.faces), count]))
    record: Record = {"bodies": count, "triangles": len(mesh.faces), "peers": {}}
    models: dict[str, Bodies] = {}
    for manager in managers:
        if _affordable(costs.get(manager.name, (0.0, 0.0)), count, limits.budget):
            _make(manager, mesh, moving, models, record["peers"])
    for name, seconds in _race(models, moving, limits).items():
        peer = record["peers"][name]
        peer["step"] = seconds
        costs[name] = seconds / count, (peer["bytes"] or 0.0) / count
    for manager in managers:
        if manager.name not in models:
            costs[manager.name] = np.inf, np.inf  # a failure with few bodies repeats with more
    record |= _verdicts(mesh, models, moving, record["peers"], limits.budget)
    return record


def _affordable(cost: Cost, count: int, budget: float) -> bool:
    seconds, size = cost
    return 3.0 * count * seconds < budget and count * size < MAX_BYTES


def _make(
    manager: Manager, mesh: Mesh, moving: Crowd, models: dict[str, Bodies], out: Record
) -> None:
    """Make a library's bodies; its record holds the error of a library that refuses so many."""
    peer: Record = {"truth": manager.truth}
    out[manager.name] = peer

    def build() -> None:
        models[manager.name] = manager.make(mesh, moving.poses(0))
        models[manager.name].step(moving.poses(1))  # some libraries fail only here

    began = process_time()
    try:
        peer["bytes"] = kept_bytes(build)  # of the bodies, which outlive the call
    except Exception as error:  # of any library
        peer["refused"] = str(error).partition("\n")[0]
        models.pop(manager.name, None)
    peer["build"] = process_time() - began


def _race(models: dict[str, Bodies], moving: Crowd, limits: Limits) -> dict[str, float]:
    """Return median CPU seconds per step; all get the same poses, and their order rotates."""
    times: dict[str, list[float]] = {name: [] for name in models}
    for step in range(limits.steps + 1):
        poses = moving.poses(step + 1)
        for name in rotated(list(models), step):
            if sum(times[name]) + (times[name] or [0.0])[-1] < limits.budget:
                times[name].append(timed(partial(models[name].step, poses)))
    return {name: float(np.median(rows[1:] or rows)) for name, rows in times.items()}


def _verdicts(
    mesh: Mesh, models: dict[str, Bodies], moving: Crowd, out: Record, budget: float
) -> Record:
    """Compare pairs of each library with the reference's, and decide pairs that fgenv disputes."""
    colliding, near, disputes, steps, spent = [], [], np.zeros(2, np.int64), 0, 0.0
    while steps < CHECKED and spent < budget:
        began, steps = process_time(), steps + 1
        poses = moving.poses(1000 + 7 * steps)
        pairs = {name: bodies.pairs(poses) for name, bodies in models.items()}
        own, reference = pairs["fgenv"], pairs.get(REFERENCE) or pairs["fgenv"]
        for name, other in pairs.items():
            out[name]["differ"] = out[name].get("differ", 0) + len(other ^ reference)
        hits, misses = decide(mesh, poses, own ^ reference)
        disputes += len(hits & own) + len(misses - own), len(hits - own) + len(misses & own)
        colliding.append(len(own))
        near.append(_near_pairs(models["fgenv"]))
        spent += process_time() - began
    return {
        "compared_steps": steps,
        "colliding": float(np.mean(colliding)),
        "near": float(np.mean(near)),
        "disputed": {"fgenv_right": int(disputes[0]), "fgenv_wrong": int(disputes[1])},
    }


def decide(mesh: Mesh, poses: Poses, pairs: Pairs) -> tuple[Pairs, Pairs]:
    """Return the pairs that collide, and the others: by python-fcl and winding numbers."""
    hits = {(i, j) for i, j in pairs if Truth(mesh, mesh, poses[i]).collides(poses[j])}
    return hits, pairs - hits


def _near_pairs(bodies: Any) -> int:
    """Count the pairs with overlapping boxes: those that fgenv tests in one step."""
    before = bodies.world.tests
    bodies.world.contact_pairs(threads=1)
    return int(bodies.world.tests - before)


def growth(records: Sequence[Record], name: str = "fgenv") -> dict[str, float]:
    """Return the growth of a step from the smallest to the largest crowd, and that of N log N.

    Crowds of less than 100 bodies do not count: most of their bodies are at the cube's walls.
    """
    rows = [r for r in records if r["bodies"] >= 100 and "step" in r["peers"].get(name, {})]
    if len(rows) < 2:
        return {}
    few, many = rows[0]["bodies"], rows[-1]["bodies"]
    times = rows[-1]["peers"][name]["step"] / rows[0]["peers"][name]["step"]
    return {
        "from": few,
        "to": many,
        "times": times,
        "n_log_n": many * np.log(many) / (few * np.log(few)),
    }
