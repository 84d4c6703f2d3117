"""``fgenv bench files``: readers of files against independent ones."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fgenv.cli.bench_report import BenchReport
from fgenv.cli.errors import FAILED_CHECK
from fgenv.cli.options import Json

if TYPE_CHECKING:
    from rich.console import Console

PACKAGES = ("fgenv", "trimesh", "assimp-py", "meshio", "pin", "mujoco")
Quick = Annotated[
    bool, typer.Option("--quick", help="Read a hundred files and a smaller STL file.")
]


def files(quick: Quick = False, as_json: Json = False) -> None:
    """Read all files in pip packages, and compare with independent readers.

    Meshes: extents, area and volume against assimp, meshio and trimesh.
    Robots: forward kinematics, origins and scales of meshes of URDF files
    against pinocchio, poses of bodies and geoms of MJCF files against MuJoCo.
    Each difference and each refusal has a reason, or is listed as unexplained.
    Then time and memory of loading STL files of one and five million triangles.

    Exit code 1 if a difference is unexplained.
    Needs the bench extra: pip install "fgenv\\[bench]".
    """
    from fgenv.bench.common.machine import package_versions

    report = BenchReport(as_json)
    report.machine(package_versions(PACKAGES))
    rows = report.collect(lambda progress: all_parts(quick, progress), show, "reading")
    report.finish(settings={"quick": quick}, **rows)
    if any(row.get("unexplained") for part in rows.values() for row in part):
        raise typer.Exit(FAILED_CHECK)


def all_parts(quick: bool, progress: Callable[[str], None]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield part and row of all measurements."""
    from fgenv.bench.files.load_times import bench_load_times
    from fgenv.bench.files.meshes import bench_meshes
    from fgenv.bench.files.mjcf import bench_mjcf
    from fgenv.bench.files.robots import bench_robots

    for row in bench_meshes(quick, progress):
        yield "meshes", row
    for row in bench_robots(quick, progress):
        yield "robots", row
    for row in bench_mjcf(quick, progress):
        yield "mjcf", row
    for row in bench_load_times(quick, progress):
        yield "loading", row


def show(console: Console, part: str, rows: list[dict[str, Any]]) -> None:
    """Print the table of one part, its note, refusals and unexplained differences."""
    from fgenv.bench.files.report import NOTES, table_of

    console.print(table_of(part, rows))
    console.print(NOTES[part], "", sep="\n")
    for row in rows:
        for line in row.get("refused", ()):
            console.print(f"refused: {line}", markup=False)
        for line in row.get("unexplained", ()):
            console.print(f"unexplained: {line}", markup=False)
