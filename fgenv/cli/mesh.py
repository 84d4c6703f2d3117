"""``fgenv mesh``: what a mesh file specifies, and the shape that is made of it."""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import Annotated

import typer

from fgenv.cli.completion import methods_of_shapes
from fgenv.cli.files import check_target, echo_written
from fgenv.cli.options import Json, choice_option, file_option
from fgenv.cli.progress import status
from fgenv.saving import atomic

MeshFile = Annotated[
    Path,
    typer.Argument(
        metavar="FILE", help="Mesh: STL, OBJ, PLY, OFF, GLB, glTF, DAE, 3MF, also as .gz or .zip."
    ),
]
Scale = Annotated[
    float, typer.Option("--scale", help="Factor after the file's unit; 0.001 for millimeters.")
]
Method = Annotated[
    str, choice_option("--method", "Feature graph: exact, crease or loop.", methods_of_shapes)
]
Tolerance = Annotated[
    float | None,
    typer.Option(
        "--tolerance", help="Keep the borders of patches this thick, meters.", show_default="none"
    ),
]
PictureFile = Annotated[Path | None, file_option("--picture", "Draw the mesh to this PNG.")]


def mesh(
    file: MeshFile,
    scale: Scale = 1.0,
    method: Method = "exact",
    tolerance: Tolerance = None,
    picture: PictureFile = None,
    as_json: Json = False,
) -> None:
    """Print what a mesh file specifies, and what was read from it.

    Format, unit and scale, polygons that were cut into triangles, vertices and
    faces in the file and in the shape, repairs, area, volume, extents, whether
    it is watertight, shells, and the size of its feature graph. Anything that
    the file has and the shape does not is a note. Lengths are in meters; axes
    are never converted.

    Exit code 2 if the file cannot be read; stderr has the reason.
    """
    from fgenv.collision import Shape

    check_target(picture, "--picture", ".png")
    with warnings.catch_warnings(record=True) as caught, status(f"reading {file}") as update:
        warnings.simplefilter("always")
        shape = Shape.load(file, scale=scale, method=method, tolerance=tolerance)
        update("measuring")
        report = shape.report
        if picture is not None:
            from fgenv.view.figures.mesh_picture import draw_mesh

            update("drawing")
            drawn = draw_mesh(shape)
            with atomic(picture) as partial:
                drawn.save(partial, "png", optimize=True)
    messages = [str(warning.message) for warning in caught]
    written = [] if picture is None else [str(picture)]
    if as_json:
        data = {"file": str(file), **report.as_dict(), "warnings": messages, "written": written}
        typer.echo(json.dumps(data, indent=1))
        return
    typer.echo(str(report))
    for message in messages:
        typer.echo(f"warning: {message}")
    echo_written(written)
