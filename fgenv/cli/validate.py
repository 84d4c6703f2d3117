"""``fgenv validate``: all that is wrong with a scenario file."""

from __future__ import annotations

import json
import warnings
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from fgenv.cli.errors import FAILED_CHECK
from fgenv.cli.options import Json


def validate(
    file: Annotated[Path, typer.Argument(help="A scenario file (YAML).")],
    as_json: Json = False,
) -> None:
    """Say all that is wrong with a scenario file, each with its line and the remedy.

    Schema, unknown keys, names, mesh files and their hashes, limits of joints and workspace, and
    by the exact collision check: starts and goals that overlap, or meet a wall.

    Exit code 0 if the file is sound, 1 if not, 2 if it cannot be read.
    """
    from fgenv.scenarios import validate as found_in

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        problems = found_in(file)
    notes = list(dict.fromkeys(str(warning.message) for warning in caught))
    if as_json:
        said = {"file": str(file), "valid": not problems, "notes": notes}
        typer.echo(json.dumps({**said, "problems": [asdict(p) for p in problems]}, indent=1))
    else:
        tell(file, [str(problem) for problem in problems], notes)
    if problems:
        raise typer.Exit(FAILED_CHECK)


def tell(file: Path, problems: list[str], notes: list[str]) -> None:
    """A line each, on stdout; they may be long, and are for editors and pipes as well."""
    for note in notes:
        typer.echo(f"{file}: note: {note}")
    for problem in problems:
        typer.echo(f"{file}: {problem}")
    typer.echo(f"{len(problems)} {'problem' if len(problems) == 1 else 'problems'} in {file}")
