"""The parts of ``fgenv bench world`` in order, each yielded as it is done."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from fgenv.bench.world.crowd import MESHES
from fgenv.bench.world.motions import bench_motions, bullets, real_motions
from fgenv.bench.world.movers import bench_movers, bench_threads
from fgenv.bench.world.peers import managers
from fgenv.bench.world.steps import Cost, bench_steps, growth

Record = dict[str, Any]
SIZES, QUICK_SIZES = (10, 100, 1000, 10_000, 100_000), (10, 100, 1000)
STEPS = {10: 200, 100: 60, 1000: 20, 10_000: 7, 100_000: 3}


def bench_world(*, seed: int = 0, quick: bool = False) -> Iterator[tuple[str, Record]]:
    """Yield (kind, record): `steps` for each mesh and number of bodies, `movers` for each mesh,
    `threads`, `motions` for each pair of meshes; at last `goals`, the summary.

    Times in seconds: CPU of the process, but for `threads`.
    """
    sizes = QUICK_SIZES if quick else SIZES
    meshes = {triangles: source.load() for triangles, source in MESHES.items()}
    done: dict[str, list[Record]] = {"steps": [], "movers": [], "threads": [], "motions": []}

    def each() -> Iterator[tuple[str, Record]]:
        for mesh in meshes.values():
            costs: dict[str, Cost] = {}
            for count in sizes:
                steps, budget = STEPS[count], 2.0 if quick else 8.0
                yield (
                    "steps",
                    bench_steps(
                        mesh, count, managers(), seed, steps=steps, budget=budget, costs=costs
                    ),
                )
        for mesh in meshes.values():
            yield "movers", bench_movers(mesh, sizes[1:], seed)
        yield "threads", bench_threads(meshes[188], sizes[-1] // 10, seed)
        for motions in real_motions(60 if quick else 300, seed):
            yield "motions", bench_motions(motions)
        yield "motions", bench_motions(bullets(60 if quick else 300, seed))

    for kind, record in each():
        done[kind].append(record)
        yield kind, record
    yield "goals", goals(done)


def goals(done: dict[str, list[Record]]) -> Record:
    """Each goal with its measured value."""
    found: Record = {}
    for row in done["steps"]:
        if row["bodies"] in (100, 1000):
            peers, name = row["peers"], f"{row['bodies']} bodies of {row['triangles']}"
            if "step" in peers.get("python-fcl", {}):
                times = peers["python-fcl"]["step"] / peers["fgenv"]["step"]
                found[f"×FCL, {name}"] = {"expected": 10.0, "measured": times}
    for triangles in dict.fromkeys(row["triangles"] for row in done["steps"]):
        rows = [row for row in done["steps"] if row["triangles"] == triangles]
        if grown := growth(rows):
            found[f"growth, {grown['from']} to {grown['to']} bodies of {triangles}"] = {
                "expected": grown["n_log_n"],
                "measured": grown["times"],
                "at_most": True,
            }
    for record in done["movers"]:
        few, many = (record["rows"][k]["bodies"] for k in (0, -1))
        for job in ("collides", "check_motion"):
            found[f"{job}, {many} against {few} of {record['triangles']}"] = {
                "expected": 2.0,
                "measured": record["growth"][job],
                "at_most": True,
            }
    for record in done["threads"]:
        for job, times in record.items():
            found[f"two threads, {job}"] = {"expected": 1.7, "measured": times}
    for record in done["motions"]:
        ways = record["ways"]
        if ways["continuous"]["free"] and ways["discrete 1 cm"]["free"]:
            found[f"continuous / discrete, {record['name']}"] = {
                "expected": 1.0,
                "measured": ways["continuous"]["free"] / ways["discrete 1 cm"]["free"],
                "at_most": True,
            }
    return found
