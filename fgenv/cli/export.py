"""``fgenv export``: a mesh, a robot or a scenario written in another format."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fgenv.cli.completion import export_formats, scenario_names
from fgenv.cli.files import check_target, echo_written
from fgenv.cli.numbers import numbers
from fgenv.cli.options import (
    Json,
    Robots,
    Seed,
    Settings,
    Size,
    choice_option,
    file_option,
    refuse_options,
)
from fgenv.cli.progress import status
from fgenv.cli.scenario_options import check_name, is_file, load_scenario, overrides_from

if TYPE_CHECKING:
    from fgenv.export import PlacedMesh

MESHES = ("glb", "obj", "stl")
FORMATS = {"mesh": MESHES, "robot": ("urdf", *MESHES), "scenario": ("yaml", *MESHES)}
ROBOT_SUFFIXES = (".urdf", ".xacro", ".sdf", ".xml")

Source = Annotated[
    str,
    typer.Argument(
        metavar="FILE",
        help="Mesh, robot, scenario file, or built-in scenario.",
        autocompletion=scenario_names,
    ),
]
Target = Annotated[
    str, choice_option("--to", "Format: glb, obj, stl, urdf or yaml.", export_formats)
]
Out = Annotated[
    Path | None, file_option("--out", "File to write.", show_default="the name with the format")
]
Scale = Annotated[
    float | None,
    typer.Option("--scale", help="Factor of a mesh or a robot to meters.", show_default="1"),
]
Configuration = Annotated[
    str | None,
    typer.Option("--q", help="Configuration of a robot, with commas.", show_default="rest"),
]
Goals = Annotated[bool, typer.Option("--goals", help="Robots of a scenario at their goals.")]
Srdf = Annotated[
    Path | None, typer.Option("--srdf", help="Allowed collisions of a robot.", dir_okay=False)
]


def export(
    context: typer.Context,
    file: Source,
    to: Target,
    out: Out = None,
    scale: Scale = None,
    q: Configuration = None,
    srdf: Srdf = None,
    goals: Goals = False,
    n: Robots = None,
    size: Size = None,
    set: Settings = None,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Write a mesh, a robot or a scenario in another format.

    glb and obj keep each body as an object of its name; stl joins them. obj,
    urdf and yaml keep every bit of a number, glb and stl have single precision.
    Lengths are in meters, z is up. urdf writes the meshes to NAME_meshes and
    the allowed collisions to NAME.srdf, beside the file.
    """
    kind = kind_of(context, file)
    if to not in FORMATS[kind]:
        expected = ", ".join(FORMATS[kind])
        raise ValueError(f"--to: got {to!r} for a {kind}, expected one of {expected}")
    refuse_others(context, kind, to)
    path = out or Path(Path(file).stem).with_suffix(f".{to}")
    check_target(path, "--out", f".{to}")
    factor = 1.0 if scale is None else scale
    with status(f"writing {path}"):
        if kind == "mesh":
            written = write_mesh(Path(file), path, factor)
        elif kind == "robot":
            written = write_robot(Path(file), path, factor, q, srdf)
        else:
            written = write_scenario(context, file, path, overrides_from(n, size, set), seed, goals)
    if as_json:
        names = [str(p) for p in written]
        typer.echo(json.dumps({"source": file, "kind": kind, "written": names}, indent=1))
    else:
        echo_written(written)


def kind_of(context: typer.Context, file: str) -> str:
    """Return whether a source is a mesh, a robot or a scenario."""
    from fgenv.collision.mesh_files import READERS

    suffixes = [suffix.lower() for suffix in Path(file).suffixes]
    if suffixes and suffixes[-1] in ROBOT_SUFFIXES:
        return "robot"
    if suffixes and suffixes[-1] in (*READERS, ".gz", ".zip"):
        return "mesh"
    if not is_file(file):
        check_name(context, file)
    return "scenario"


def refuse_others(context: typer.Context, kind: str, to: str) -> None:
    """Raise ValueError for options that have no effect on this kind of source or format."""
    own = {"mesh": ("scale",), "robot": ("scale", "q", "srdf")}
    own["scenario"] = ("goals", "n", "size", "set", "seed")
    others = [name for names in own.values() for name in names if name not in own[kind]]
    refuse_options(context, others, f"has no effect on a {kind}")
    if to in ("urdf", "yaml"):
        refuse_options(context, ("q", "goals"), f"has no effect with --to {to}")


def write_mesh(file: Path, path: Path, scale: float) -> list[Path]:
    """Write a mesh file."""
    from fgenv.collision import Shape
    from fgenv.export import mesh_parts

    return written_meshes(mesh_parts(Shape.load(file, scale=scale)), path)


def write_robot(
    file: Path, path: Path, scale: float, q: str | None, srdf: Path | None
) -> list[Path]:
    """Write a robot, or its shapes at a configuration."""
    from fgenv.export import robot_parts, write_urdf
    from fgenv.robots import Robot

    robot = Robot.load(file, scale=scale, srdf=srdf)
    if path.suffix == ".urdf":
        return write_urdf(robot, path)
    return written_meshes(robot_parts(robot, None if q is None else numbers(q)), path)


def write_scenario(
    context: typer.Context,
    name: str,
    path: Path,
    overrides: dict[str, Any],
    seed: int,
    goals: bool,
) -> list[Path]:
    """Write a scenario as YAML, or its bodies with the robots at their starts or goals."""
    from fgenv.export import scenario_parts

    scenario = load_scenario(context, name, overrides, seed)
    if path.suffix == ".yaml":
        scenario.save(path)
        return [path]
    configurations = scenario.build().goals if goals else None
    return written_meshes(scenario_parts(scenario, configurations), path)


def written_meshes(meshes: Iterable[PlacedMesh], path: Path) -> list[Path]:
    """Write meshes; return the file."""
    from fgenv.export import write_meshes

    write_meshes(list(meshes), path)
    return [path]
