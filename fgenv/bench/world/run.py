"""The parts of ``fgenv bench world`` in order."""

from __future__ import annotations

from collections.abc import Iterator

from fgenv.bench.common.records import Record
from fgenv.bench.world.crowd import MESHES
from fgenv.bench.world.goals import goals
from fgenv.bench.world.motions import bench_motions, bullets, real_motions
from fgenv.bench.world.movers import bench_movers, bench_threads
from fgenv.bench.world.peers import managers
from fgenv.bench.world.steps import Cost, Limits, bench_steps

SIZES, QUICK_SIZES = (10, 100, 1000, 10_000, 100_000), (10, 100, 1000)
STEPS = {10: 200, 100: 60, 1000: 20, 10_000: 7, 100_000: 3}


def bench_world(*, seed: int = 0, quick: bool = False) -> Iterator[tuple[str, Record]]:
    """Yield (kind, record): `steps` for each mesh and number of bodies, `movers` for each mesh,
    `threads`, `motions` for each pair of meshes; at last `goals`, the summary.

    Times are CPU seconds of the process, except for `threads`.
    """
    parts: dict[str, list[Record]] = {"steps": [], "movers": [], "threads": [], "motions": []}
    for kind, record in _parts(seed, quick):
        parts[kind].append(record)
        yield kind, record
    yield "goals", goals(parts)


def _parts(seed: int, quick: bool) -> Iterator[tuple[str, Record]]:
    sizes, budget, count = (QUICK_SIZES, 2.0, 60) if quick else (SIZES, 8.0, 300)
    meshes = {triangles: source.load() for triangles, source in MESHES.items()}
    for mesh in meshes.values():
        costs: dict[str, Cost] = {}
        for n in sizes:
            limits = Limits(STEPS[n], budget)
            yield "steps", bench_steps(mesh, n, managers(), seed, limits, costs)
    for mesh in meshes.values():
        yield "movers", bench_movers(mesh, sizes[1:], seed)
    yield "threads", bench_threads(meshes[188], sizes[-1] // 10, seed)
    for motions in real_motions(count, seed):
        yield "motions", bench_motions(motions)
    yield "motions", bench_motions(bullets(count, seed))
