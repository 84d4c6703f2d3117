"""Options and arguments that several commands share."""

from pathlib import Path
from typing import Annotated, Any

import typer

from fgenv.cli.completion import policy_names, scenario_names


def file_option(name: str, text: str, panel: str | None = None, **more: Any) -> Any:
    """Return an option for a file to write."""
    return typer.Option(name, dir_okay=False, help=text, rich_help_panel=panel, **more)


PLOT_SUFFIXES = "(.png, .svg, .pdf)"
ROBOTS_HELP = "Number of robots."
SIZE_HELP = "Size of the scenario in meters; see fgenv scenarios NAME."
SET_HELP = "Set an option of the scenario, such as jitter=0.1."
FPS_HELP = "Frames per second of a movie, at most one per step."

ScenarioName = Annotated[
    str,
    typer.Argument(
        help="Built-in scenario (see fgenv scenarios), scenario file, or frozen set.",
        autocompletion=scenario_names,
    ),
]
Recorded = Annotated[
    Path,
    typer.Argument(
        metavar="RECORD", help="Record of fgenv run --record, or plan of fgenv plan --out (.npz)."
    ),
]
Robots = Annotated[int | None, typer.Option("--n", min=1, help=ROBOTS_HELP)]
Size = Annotated[float | None, typer.Option("--size", help=SIZE_HELP)]
Settings = Annotated[list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help=SET_HELP)]
PolicyName = Annotated[
    str,
    typer.Option("--policy", help="Policy, as in fgenv run.", autocompletion=policy_names),
]
Seed = Annotated[
    int,
    typer.Option("--seed", min=0, help="Seed of all random numbers; same seed, same result."),
]
Json = Annotated[
    bool,
    typer.Option("--json", help="Print one JSON document on stdout and nothing else there."),
]
OpenBrowser = Annotated[bool, typer.Option("--open", help="Open the page in the default browser.")]
Jobs = Annotated[
    int,
    typer.Option(
        "--jobs", min=1, max=256, help="Number of processes; results do not depend on it."
    ),
]
SetCases = Annotated[
    int, typer.Option("--cases", min=1, help="Number of cases of each frozen set.")
]
RatioPlot = Annotated[
    Path | None,
    file_option("--plot", f"Plot how many times faster fgenv is, as bars {PLOT_SUFFIXES}."),
]
SharePlot = Annotated[
    Path | None,
    file_option("--plot", f"Plot the shares with 95 % intervals {PLOT_SUFFIXES}."),
]
