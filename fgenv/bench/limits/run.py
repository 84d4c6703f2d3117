"""Worst times of hard inputs: flush motions, coincident faces, grazing rays, limits, interrupts."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import warnings
from collections.abc import Callable, Iterator
from time import perf_counter

import numpy as np
import trimesh

import fgenv
from fgenv.arrays import Floats
from fgenv.bench.common.poses import random_rotations
from fgenv.bench.common.records import Record
from fgenv.bench.common.solids import at, box, turned
from fgenv.bench.common.timing import timed
from fgenv.collision import MeshWarning, Shape, World, distance
from fgenv.planners import PlanningError
from fgenv.scenarios import Scenario

from .flush_motions import FlushMotion, flush_motions

GAPS = (1e-4, 1e-7, 1e-9, 1e-11, 1e-13)  # m
MOTIONS = 500
APART = 0.32  # m; of the shapes with nearly coincident faces
JITTER = 1e-9  # m
PLANNING_SECONDS = (0.2, 1.0)
Job = Callable[[], object]

# Prints a line when it begins, and then works until it is interrupted.
INTERRUPTED = {
    "Shape of a million triangles": """
import numpy as np, trimesh
from fgenv.collision import Shape
ball = trimesh.creation.icosphere(subdivisions=8)
print("begun", flush=True)
Shape(ball.vertices, ball.faces)
""",
    "distances of many poses": """
import numpy as np, trimesh
from fgenv.collision import Shape, distance
ball = Shape(*(lambda m: (m.vertices, m.faces))(trimesh.creation.icosphere(subdivisions=6)))
poses = np.tile(np.eye(4), (1_000_000, 1, 1))
poses[:, 0, 3] = 2.5
print("begun", flush=True)
distance(ball, np.eye(4), ball, poses)
""",
}


def flush_slides(rng: np.random.Generator) -> Iterator[tuple[str, Job]]:
    """Yield motions of a box that slides and turns on another one, one per gap."""
    shape = Shape(*box())
    for gap in GAPS:
        world = World()
        world.add(shape, np.eye(4))
        start = at(-0.5, 0.0, 1 + gap)
        end = at(0.5, 0.0, 1 + gap) @ turned(float(rng.uniform(1, 3)))
        part = world.add(shape, start)
        yield (
            f"gap {gap:g} m",
            lambda w=world, p=part, s=start, e=end: w.check_motion(p, s, e),  # type: ignore[misc]
        )


def check(motion: FlushMotion) -> tuple[float, bool]:
    """Seconds of a motion's check, and whether it is unresolved."""
    world = World()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MeshWarning)
        world.add(Shape(*motion.table), motion.table_pose)
        part = world.add(Shape(*motion.part), motion.start)
    began = perf_counter()
    found = world.check_motion(part, motion.start, motion.end, tolerance=motion.tolerance)
    return perf_counter() - began, bool(found.unresolved)


def motions(seed: int, rounds: int) -> Iterator[Record]:
    """Yield the worst time of a mix of flush motions, and the share that is unresolved."""
    mix = flush_motions(seed, MOTIONS)
    runs = [[check(motion) for motion in mix] for _ in range(rounds)]
    best = np.min([[seconds for seconds, _ in run] for run in runs], axis=0)
    share = np.mean([unresolved for _, unresolved in runs[0]])
    name = f"{MOTIONS} motions, {100 * share:.1f} % unresolved"
    yield {"kind": "flush motions", "name": name, "worst": float(best.max())}


def triangle_soup(name: str, count: int, rng: np.random.Generator) -> Floats:
    """Vertices (count, 3, 3) of triangles that nearly coincide or overlap in one plane."""
    if name == "copies":
        corner = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]])
        return corner + rng.normal(0, JITTER, (count, 3, 3))
    if name == "coplanar":
        return np.concatenate([rng.random((count, 3, 2)), np.zeros((count, 3, 1))], axis=2)
    ends = rng.normal(size=(count, 1, 3)) * [1, 1e-6, 1e-6]
    return np.concatenate([-ends, ends, ends + rng.normal(0, 1e-6, (count, 1, 3))], axis=1)


def near_coincident(count: int, rng: np.random.Generator) -> Iterator[tuple[str, Job]]:
    """Yield distances between a shape and itself, one per kind of triangles."""
    for name in ("copies", "coplanar", "needles"):
        vertices = triangle_soup(name, count, rng).reshape(-1, 3)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", MeshWarning)
            shape = Shape(vertices, np.arange(len(vertices)).reshape(-1, 3))
        yield (
            f"{count} {name}",
            lambda s=shape: distance(s, np.eye(4), s, at(z=APART)),  # type: ignore[misc]
        )


def grazing_rays(rng: np.random.Generator) -> Iterator[tuple[str, Job]]:
    """Yield rays through the vertices of a sphere, from random directions."""
    ball = trimesh.creation.icosphere(subdivisions=4)
    shape = Shape(ball.vertices, ball.faces)
    directions = random_rotations(rng, len(ball.vertices))[:, 0]
    origins = ball.vertices - 3 * directions
    yield f"{len(origins)} rays", lambda: shape.raycast(origins, directions, threads=1)


def time_limits() -> Iterator[tuple[str, Job]]:
    """Yield planning problems that a time limit ends: around a long wall, and three arms."""
    scenes = {"around a wall of 400 m": around_a_wall(200.0), "3 arms": Scenario.load("cell", n=3)}
    for name, scenario in scenes.items():
        for limit in PLANNING_SECONDS:
            yield f"{name}, limit {limit:g} s", lambda s=scenario, t=limit: planned(s, t)  # type: ignore[misc]


def planned(scenario: Scenario, limit: float) -> None:
    """Plan within a time limit; a problem that is not solved in time is as good."""
    try:
        fgenv.plan(scenario, method="composite", time_limit=limit)
    except PlanningError:
        return


def around_a_wall(half: float) -> Scenario:
    """A box of 1 m with a wall of a half length (m) between start and goal."""
    robot = {"name": "box", "model": "box", "start": [-5, 0, 0], "goal": [5, 0, 0]}
    return Scenario.model_validate(
        {
            "version": 1,
            "name": "wall",
            "horizon": 1e4,
            "workspace": {"low": [-half - 10, -half - 10], "high": [half + 10, half + 10]},
            "shapes": {
                "box": {"kind": "box", "size": [1, 1, 1]},
                "wall": {"kind": "box", "size": [1, 2 * half, 1]},
            },
            "models": {
                "box": {
                    "shape": "box",
                    "drive": {"kind": "holonomic", "speed": 1.0, "turn_rate": 1.0},
                }
            },
            "robots": [robot],
            "bodies": [{"shape": "wall"}],
        }
    )


def interrupted(code: str) -> float:
    """Seconds from Ctrl-C to the end of a process that runs some code."""
    command = [sys.executable, "-W", "ignore", "-c", code]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as process:
        assert process.stdout is not None
        process.stdout.readline()
        try:
            process.wait(0.3)
        except subprocess.TimeoutExpired:
            began = perf_counter()
            os.kill(process.pid, signal.SIGINT)
            process.wait()
            return perf_counter() - began
    raise RuntimeError("the process ended before it was interrupted")


def bench_limits(*, count: int = 20_000, rounds: int = 3, seed: int = 0) -> Iterator[Record]:
    """Yield one record per input: its kind, its name, the worst time in seconds."""
    rng = np.random.default_rng(seed)
    kinds = {
        "flush slide": flush_slides(rng),
        "near-coincident faces": near_coincident(count, rng),
        "grazing rays": grazing_rays(rng),
        "time limit": time_limits(),
    }
    yield from motions(seed, rounds)
    for kind, jobs in kinds.items():
        for name, job in jobs:
            yield {"kind": kind, "name": name, "worst": max(timed(job) for _ in range(rounds))}
    for name, code in INTERRUPTED.items():
        worst = max(interrupted(code) for _ in range(rounds))
        yield {"kind": "Ctrl-C", "name": name, "worst": worst}
