"""Options that mean the same in every command."""

from pathlib import Path
from typing import Annotated

import typer

Seed = Annotated[
    int,
    typer.Option("--seed", min=0, help="Seed of everything random; same seed, same result."),
]
Json = Annotated[
    bool,
    typer.Option("--json", help="Print one JSON document on stdout and nothing else there."),
]
Threads = Annotated[
    int | None,
    typer.Option(
        "--threads",
        min=1,
        show_default="all cores",
        help="Threads for batched queries; results do not depend on it.",
    ),
]
Bars = Annotated[
    Path | None,
    typer.Option(
        "--plot",
        dir_okay=False,
        help="Draw how many times faster fgenv is, as bars (.png, .svg, .pdf).",
    ),
]
Shares = Annotated[
    Path | None,
    typer.Option(
        "--plot", dir_okay=False, help="Draw the shares with 95 % intervals (.png, .svg, .pdf)."
    ),
]
Out = Annotated[
    Path,
    typer.Option("--out", file_okay=False, help="Folder for the files written; made if missing."),
]
