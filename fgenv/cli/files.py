"""Files that commands write: checks before the work, messages after it."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import typer


def check_target(path: Path | None, option: str, *suffixes: str) -> None:
    """Raise ValueError if a file to write has another suffix or its folder does not exist."""
    if path is None:
        return
    if suffixes and path.suffix not in suffixes:
        expected = f"a name that ends in {' or '.join(suffixes)}"
        raise ValueError(f"{option}: got {path}, expected {expected}")
    if not path.parent.is_dir():
        raise ValueError(f"{option}: {path}: there is no folder {path.parent}; make it first")


def echo_written(paths: Iterable[str | Path]) -> None:
    """Print the names and sizes of written files."""
    for path in map(Path, paths):
        typer.echo(f"written: {path}, {path.stat().st_size:,} bytes")
