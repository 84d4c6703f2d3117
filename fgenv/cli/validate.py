"""``fgenv validate``: all errors of a scenario file."""

from __future__ import annotations

import json
import warnings
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from fgenv.cli.errors import FAILED_CHECK
from fgenv.cli.options import Json

ScenarioFile = Annotated[Path, typer.Argument(help="Scenario file (YAML).")]


def validate(file: ScenarioFile, as_json: Json = False) -> None:
    """Report all errors of a scenario file, each with its line and the remedy.

    Schema, unknown keys, names, mesh files and their hashes, limits of joints and workspace, and
    by the exact collision check: starts and goals that collide with each other or with bodies.

    Exit code 0 if the file is valid, 1 if not, 2 if it cannot be read.
    """
    from fgenv.scenarios import validate as errors_of

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        problems = errors_of(file)
    notes = list(dict.fromkeys(str(warning.message) for warning in caught))
    if as_json:
        data = {"file": str(file), "valid": not problems, "notes": notes}
        typer.echo(json.dumps({**data, "problems": [asdict(p) for p in problems]}, indent=1))
    else:
        print_report(file, [str(problem) for problem in problems], notes)
    if problems:
        raise typer.Exit(FAILED_CHECK)


def print_report(file: Path, problems: list[str], notes: list[str]) -> None:
    """Print one line per problem on stdout, unwrapped: editors and pipes parse them."""
    for note in notes:
        typer.echo(f"{file}: note: {note}")
    for problem in problems:
        typer.echo(f"{file}: {problem}")
    typer.echo(f"{len(problems)} {'problem' if len(problems) == 1 else 'problems'} in {file}")
