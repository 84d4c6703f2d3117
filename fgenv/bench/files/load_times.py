"""Time and memory of loading large STL files, against other libraries."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from time import process_time

import numpy as np

from fgenv.bench.common.records import Record
from fgenv.export import PlacedMesh, write_meshes

ROUNDS = 5
LOADERS = {
    "fgenv": "from fgenv.collision import Shape; Shape.load(r'{}')",  # reads and builds
    "trimesh": "import trimesh; trimesh.load(r'{}')",  # reads and merges vertices
    "meshio": "import meshio; meshio.read(r'{}')",  # reads
    "assimp": "import assimp_py; assimp_py.import_file(r'{}', assimp_py.Process_Triangulate)",
}
# The peak of the process itself: ru_maxrss of a new process begins with that of its parent.
MEMORY = "; print(open('/proc/self/status').read().partition('VmHWM:')[2].split()[0])"


def torus(triangles: int) -> PlacedMesh:
    """Return a closed surface of about so many triangles: a torus of 1 m."""
    n = round((triangles / 2) ** 0.5)
    u, v = (a.ravel() for a in np.meshgrid(*[np.arange(n)] * 2, indexing="ij"))
    angles = 2 * np.pi / n * np.stack([u, v])
    ring = 0.35 + 0.15 * np.cos(angles[1])
    points = [ring * np.cos(angles[0]), ring * np.sin(angles[0]), 0.15 * np.sin(angles[1])]
    next_u, next_v = (u + 1) % n, (v + 1) % n
    a, b, c, d = u * n + v, next_u * n + v, next_u * n + next_v, u * n + next_v
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    return PlacedMesh("torus", np.stack(points, axis=1), faces, np.eye(4))


def bench_load_times(quick: bool, progress: Callable[[str], None]) -> Iterator[Record]:
    """Yield a row per size: CPU seconds (median of alternating rounds) and peak MB by library."""
    with tempfile.TemporaryDirectory() as folder:
        for triangles in (100_000,) if quick else (1_000_000, 5_000_000):
            file = Path(folder) / "torus.stl"
            write_meshes([torus(triangles)], file)
            yield of_file(file, triangles, progress)


def of_file(file: Path, triangles: int, progress: Callable[[str], None]) -> Record:
    """Return the row of one file."""
    rounds = ROUNDS if triangles <= 1_000_000 else 1
    times: dict[str, list[float]] = {name: [] for name in LOADERS}
    for k in range(rounds):
        order = list(LOADERS) if k % 2 == 0 else list(LOADERS)[::-1]
        for name in order:
            progress(f"{triangles:,} triangles: {name}, round {k + 1} of {rounds}")
            times[name].append(seconds_of(name, file))
    seconds = {name: float(np.median(rows)) for name, rows in times.items()}
    peers = {name: {"seconds": seconds[name], "peak_mb": peak_of(name, file)} for name in LOADERS}
    ratio = seconds["fgenv"] / seconds["trimesh"]
    return {"triangles": triangles, "peers": peers, "ratio": ratio}


def seconds_of(name: str, file: Path) -> float:
    """Return the CPU seconds of a load, imports apart."""
    statement = LOADERS[name].format(file)
    imports, _, call = statement.partition("; ")
    scope: dict[str, object] = {}
    exec(imports, scope)
    began = process_time()
    exec(call, scope)
    return process_time() - began


def peak_of(name: str, file: Path) -> float | None:
    """Return the peak memory of a process that loads a file, MB; None if it is not on Linux."""
    if sys.platform != "linux":
        return None
    code = LOADERS[name].format(file) + MEMORY
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return float(done.stdout.split()[-1]) / 1024
