"""``fgenv robot``: what a robot file specifies, and the robot that is made of it."""

from __future__ import annotations

import json
import math
import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fgenv.cli.files import check_target, echo_written
from fgenv.cli.numbers import numbers
from fgenv.cli.options import Json, file_option
from fgenv.cli.progress import status
from fgenv.saving import atomic

if TYPE_CHECKING:
    from PIL import Image

    from fgenv.robots import Robot

RobotFile = Annotated[Path, typer.Argument(metavar="FILE", help="Robot: URDF, xacro, MJCF or SDF.")]
Srdf = Annotated[
    Path | None,
    typer.Option(
        "--srdf", help="Allowed collisions, groups and states of a robot.", dir_okay=False
    ),
]
Packages = Annotated[
    list[str] | None,
    typer.Option(
        "--package",
        metavar="[NAME=]FOLDER",
        help="Folder of packages, or of the package NAME; may be repeated.",
    ),
]
XacroArguments = Annotated[
    list[str] | None,
    typer.Option("--arg", metavar="NAME=VALUE", help="Argument of a xacro file; may be repeated."),
]
Root = Annotated[
    str | None, typer.Option("--root", help="First body of the robot, in MJCF with several.")
]
Scale = Annotated[float, typer.Option("--scale", help="Factor of all lengths.")]
Visual = Annotated[bool, typer.Option("--visual", help="Use the visual geometry.")]
Configuration = Annotated[
    str | None,
    typer.Option("--q", help="Configuration, with commas, or a named state.", show_default="rest"),
]
PictureFile = Annotated[Path | None, file_option("--picture", "Draw the robot to this PNG.")]


def robot(
    file: RobotFile,
    srdf: Srdf = None,
    package: Packages = None,
    arg: XacroArguments = None,
    root: Root = None,
    scale: Scale = 1.0,
    visual: Visual = False,
    q: Configuration = None,
    picture: PictureFile = None,
    as_json: Json = False,
) -> None:
    """Print what a robot file specifies, and what was read from it.

    Links with their shapes, joints with their limits, planning groups and named
    states, links that collide at the configuration, and notes: what the file
    has and the robot does not, or has otherwise. Lengths are in meters, angles
    in radians.

    Exit code 2 if the file cannot be read; stderr has the reason.
    """
    from fgenv.robots import Robot

    check_target(picture, "--picture", ".png")
    with warnings.catch_warnings(record=True) as caught, status(f"reading {file}") as update:
        warnings.simplefilter("always")
        made = Robot.load(
            file,
            collision=not visual,
            package_dirs=packages(package or ()),
            srdf=srdf,
            scale=scale,
            xacro_args=dict(pairs("--arg", arg or ())),
            root=root,
        )
        configuration = configuration_of(made, q)
        update("checking")
        report = report_of(made, configuration)
        if picture is not None:
            update("drawing")
            drawn = draw_robot(made, configuration)
            with atomic(picture) as partial:
                drawn.save(partial, "png", optimize=True)
    messages = [str(warning.message) for warning in caught]
    written = [] if picture is None else [str(picture)]
    if as_json:
        data = {"file": str(file), **report, "warnings": messages, "written": written}
        typer.echo(json.dumps(data, indent=1))
        return
    typer.echo("\n".join(lines_of(report)))
    for message in messages:
        typer.echo(f"warning: {message}")
    echo_written(written)


def packages(given: Iterable[str]) -> Any:
    """Return folders, or folders by name, of values of --package.

    Raises:
        ValueError: values of both kinds, or no folder.
    """
    values = list(given)
    for value in values:
        folder = value.partition("=")[2] or value
        if not Path(folder).is_dir():
            raise ValueError(f"--package: got {value!r}, expected a folder that exists")
    named = [value for value in values if "=" in value]
    if named and len(named) < len(values):
        raise ValueError("--package: got folders with and without names, expected one kind")
    return dict(pairs("--package", named)) if named else values


def pairs(option: str, values: Iterable[str]) -> list[tuple[str, str]]:
    """Return names and values of NAME=VALUE.

    Raises:
        ValueError: no equals sign, or a name twice.
    """
    rows: list[tuple[str, str]] = []
    for value in values:
        name, equals, text = value.partition("=")
        if not equals or not name:
            raise ValueError(f"{option}: got {value!r}, expected NAME=VALUE")
        if name in dict(rows):
            raise ValueError(f"{option}: got {name!r} twice, expected it once")
        rows.append((name, text))
    return rows


def configuration_of(robot: Robot, text: str | None) -> Any:
    """Return the configuration of --q: numbers, or the name of a state."""
    if text is None:
        return robot.rest
    if any(text == name for _, name in robot.semantics.states):
        return robot.named_state(text)
    q = numbers(text)
    if len(q) != robot.nq:
        expected = ", ".join(robot.coordinates) or "none"
        raise ValueError(f"--q: got {len(q)} numbers, expected {robot.nq}: {expected}")
    return q


def report_of(robot: Robot, q: Any) -> dict[str, Any]:
    """Return the parts of a robot as plain data."""
    bounds = zip(robot.coordinates, robot.lower, robot.upper, strict=True)
    limits = {name: [limit(low), limit(high)] for name, low, high in bounds}
    semantics = robot.semantics
    return {
        "name": robot.name,
        "base": robot.base,
        "dof": robot.dof,
        "links": [
            {
                "name": link.name,
                "shapes": len(link.shapes),
                "faces": sum(len(item.shape.faces) for item in link.shapes),
            }
            for link in robot.links
        ],
        "joints": [
            {
                "name": joint.name,
                "kind": joint.kind,
                "parent": joint.parent,
                "child": joint.child,
                "limits": limits.get(joint.name),
                "velocity": limit(joint.velocity) if joint.moves else None,
                "mimics": None if joint.mimic is None else joint.mimic.joint,
            }
            for joint in robot.joints
        ],
        "groups": {name: list(joints) for name, joints in semantics.groups.items()},
        "states": [{"group": g, "name": n, **v} for (g, n), v in semantics.states.items()],
        "end_effectors": list(semantics.end_effectors),
        "self_collisions": [list(pair) for pair in robot.self_collisions(q)],
        "notes": list(robot.notes),
    }


def limit(value: float) -> float | None:
    """Return a limit, or None for an infinite one."""
    return float(value) if math.isfinite(value) else None


def lines_of(report: dict[str, Any]) -> Iterable[str]:
    """Yield the lines of a report."""
    shapes = sum(link["shapes"] for link in report["links"])
    faces = sum(link["faces"] for link in report["links"])
    yield f"{report['name']}: {report['base']} base, {report['dof']} degrees of freedom"
    yield f"{len(report['links'])} links, {shapes} shapes, {faces:,} faces"
    for joint in report["joints"]:
        if joint["kind"] != "fixed":
            yield f"  {joint['name']}: {joint['kind']}{joint_text(joint)}"
    for name, joints in report["groups"].items():
        yield f"group {name}: {', '.join(joints) if len(joints) < 8 else f'{len(joints)} joints'}"
    for state in report["states"]:
        yield f"state {state['name']} of group {state['group']}"
    for a, b in report["self_collisions"]:
        yield f"colliding: {a} and {b}"
    for note in report["notes"]:
        yield f"note: {note}"


def joint_text(joint: dict[str, Any]) -> str:
    """Return the limits of a joint, or the joint that it mimics."""
    if joint["mimics"]:
        return f", mimics {joint['mimics']}"
    low, high = joint["limits"]
    if joint["kind"] == "continuous" or (low is None and high is None):
        return ", no limits"
    ends = ("none" if end is None else f"{end:g}" for end in (low, high))
    return f", {' to '.join(ends)}"


def draw_robot(robot: Robot, q: Any) -> Image.Image:
    """Return the picture of a robot at a configuration."""
    import numpy as np

    from fgenv.collision import Shape
    from fgenv.export import robot_parts
    from fgenv.view.figures.mesh_picture import draw_mesh

    parts = robot_parts(robot, q)
    if not parts:
        raise ValueError("--picture: got a robot without shapes, expected one with")
    first = np.cumsum([0, *(len(part.vertices) for part in parts)])
    vertices = [part.vertices @ part.pose[:3, :3].T + part.pose[:3, 3] for part in parts]
    faces = [part.faces + k for part, k in zip(parts, first, strict=False)]
    return draw_mesh(Shape(np.concatenate(vertices), np.concatenate(faces)))
