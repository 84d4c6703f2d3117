"""All pairs per step: N bodies drift and turn; each library moves them and finds all collisions."""

from __future__ import annotations

import gc
from collections.abc import Sequence
from time import process_time
from typing import Any

import numpy as np

from fgenv.arrays import Poses
from fgenv.bench.common.memory import kept_bytes
from fgenv.bench.common.meshes import Mesh
from fgenv.bench.peers.ground_truth import Truth
from fgenv.bench.world.crowd import Crowd, crowd
from fgenv.bench.world.peers import Bodies, Manager, Pairs

Record = dict[str, Any]
JUDGE = "python-fcl"
CHECKED = 3  # steps with compared pairs, at most the seconds of the budget
MOST_BYTES = 1e9  # that a library may take: some keep a tree for each body
Cost = tuple[float, float]  # seconds per step and bytes, per body


def bench_steps(
    mesh: Mesh,
    count: int,
    racing: Sequence[Manager],
    seed: int,
    *,
    steps: int,
    budget: float,
    costs: dict[str, Cost],
) -> Record:
    """One row: seconds per step of each library with `count` bodies, pairs, verdicts, memory.

    A library that would take too long or too much memory is left out. `costs` holds the costs with
    fewer bodies, and is updated.
    """
    moving = crowd(mesh, count, np.random.default_rng([seed, len(mesh.faces), count]))
    fair = [m for m in racing if _affordable(costs.get(m.name, (0.0, 0.0)), count, budget)]
    record: Record = {"bodies": count, "triangles": len(mesh.faces), "peers": {}}
    held: dict[str, Bodies] = {}
    for manager in fair:
        _make(manager, mesh, moving, held, record["peers"])
    for name, seconds in _race(held, moving, steps, budget).items():
        found = record["peers"][name]
        found["step"] = seconds
        costs[name] = seconds / count, (found["bytes"] or 0.0) / count
    for name in [m.name for m in racing if m.name not in held]:
        costs[name] = np.inf, np.inf  # what fails with few bodies fails with more
    record |= _verdicts(mesh, held, moving, record["peers"], budget)
    return record


def _affordable(cost: Cost, count: int, budget: float) -> bool:
    seconds, size = cost
    return 3.0 * count * seconds < budget and count * size < MOST_BYTES


def _make(
    manager: Manager, mesh: Mesh, moving: Crowd, held: dict[str, Bodies], out: Record
) -> None:
    """Make a library's bodies; the record holds the error of a library that refuses so many."""
    found: Record = {"truth": manager.truth}
    out[manager.name] = found

    def build() -> None:
        held[manager.name] = manager.make(mesh, moving.poses(0))
        held[manager.name].step(moving.poses(1))  # some fail only now

    began = process_time()
    try:
        found["bytes"] = kept_bytes(build)  # of the bodies, which outlive the call
    except Exception as error:  # any library's own
        found["refused"] = str(error).partition("\n")[0]
        held.pop(manager.name, None)
    found["build"] = process_time() - began


def _race(held: dict[str, Bodies], moving: Crowd, steps: int, budget: float) -> dict[str, float]:
    """Median CPU-seconds per step of each; all get the same poses, and their order rotates."""
    taken: dict[str, list[float]] = {name: [] for name in held}
    names = list(held)
    for step in range(steps + 1):
        poses, first = moving.poses(step + 1), step % len(names)
        for name in names[first:] + names[:first]:
            if sum(taken[name]) + (taken[name] or [0.0])[-1] < budget:
                taken[name].append(_once(held[name], poses))
    return {name: float(np.median(times[1:] or times)) for name, times in taken.items()}


def _once(bodies: Bodies, poses: Poses) -> float:
    gc.disable()
    try:
        began = process_time()
        bodies.step(poses)
        return process_time() - began
    finally:
        gc.enable()


def _verdicts(
    mesh: Mesh, held: dict[str, Bodies], moving: Crowd, out: Record, budget: float
) -> Record:
    """Pairs of each library against those of the judge; pairs that fgenv disputes, decided."""
    met, near, right, wrong, asked, spent = [], [], 0, 0, 0, 0.0
    while asked < CHECKED and spent < budget:
        began, asked = process_time(), asked + 1
        poses = moving.poses(1000 + 7 * asked)
        found = {name: bodies.pairs(poses) for name, bodies in held.items()}
        judge = found.get(JUDGE) or found["fgenv"]
        for name, pairs in found.items():
            out[name]["differ"] = out[name].get("differ", 0) + len(pairs ^ judge)
        truth = decided(mesh, poses, found["fgenv"] ^ judge)
        right += len(truth[True] & found["fgenv"]) + len(truth[False] - found["fgenv"])
        wrong += len(truth[True] - found["fgenv"]) + len(truth[False] & found["fgenv"])
        met.append(len(found["fgenv"]))
        near.append(_near_pairs(held["fgenv"]))
        spent += process_time() - began
    return {
        "compared_steps": asked,
        "colliding": float(np.mean(met)),
        "near": float(np.mean(near)),
        "disputed": {"fgenv_right": right, "fgenv_wrong": wrong},
    }


def decided(mesh: Mesh, poses: Poses, pairs: Pairs) -> dict[bool, Pairs]:
    """Pairs that collide, and those that do not: by python-fcl on the pair and winding numbers."""
    said: dict[bool, Pairs] = {True: set(), False: set()}
    for i, j in pairs:
        said[Truth(mesh, mesh, poses[i]).collides(poses[j])].add((i, j))
    return said


def _near_pairs(bodies: Any) -> int:
    """Pairs with overlapping boxes: the pairs that fgenv tests in one step."""
    before = bodies.world.tests
    bodies.world.contact_pairs(threads=1)
    return int(bodies.world.tests - before)


def growth(records: Sequence[Record], name: str = "fgenv") -> dict[str, float]:
    """How the step grows from the smallest to the largest crowd, and what N log N would give.

    Only where there are 100 bodies and more: below, most of them stand at the cube's walls.
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
