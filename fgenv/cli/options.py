"""Options and arguments that several commands share."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Annotated, Any

import typer

from fgenv.cli.completion import policy_names, scenario_names


def file_option(name: str, text: str, panel: str | None = None, **more: Any) -> Any:
    """Return an option for a file to write."""
    return typer.Option(name, dir_okay=False, help=text, rich_help_panel=panel, **more)


def choice_option(name: str, text: str, choices: Callable[[], Iterable[str]], **more: Any) -> Any:
    """Return an option with one of the choices: they are completed, and others are refused."""

    def complete(incomplete: str) -> list[str]:
        return [choice for choice in choices() if choice.startswith(incomplete)]

    def check(value: str | list[str] | None) -> str | list[str] | None:
        for choice in [value] if isinstance(value, str) else value or []:
            check_choice(name, choice, choices())
        return value

    more |= {"autocompletion": complete, "callback": check}
    return typer.Option(name, help=text, **more)


def check_choice(name: str, value: str, choices: Iterable[str]) -> None:
    """Raise ValueError, with the nearest choice, unless an option's value is one of them."""
    from fgenv.scenarios.errors import near

    names = list(choices)
    if value not in names:
        raise ValueError(f"{name}: got {value!r}; {near(value, names)}")


def is_given(context: typer.Context, parameter: str) -> bool:
    """Return whether the command line has an option, by the name of its parameter."""
    source = context.get_parameter_source(parameter)
    return source is not None and source.name == "COMMANDLINE"


def refuse_options(context: typer.Context, parameters: Iterable[str], reason: str) -> None:
    """Raise ValueError if the command line has one of these options."""
    for parameter in parameters:
        if is_given(context, parameter):
            option = parameter.removeprefix("as_").replace("_", "-")
            raise ValueError(f"--{option}: {reason}")


def check_trust(trust: bool, policies: Iterable[str]) -> None:
    """Raise ValueError if --trust has no effect on these policies."""
    if trust and not any("sb3:" in policy for policy in policies):
        raise ValueError("--trust: expected with a policy sb3:FILE; omit --trust")


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
POLICY_HELP = (
    "Policy: goto, random, rest, orca, orca:shortest, plan[:METHOD[:PLANNER]], plan:FILE.npz,"
    " replan[:METHOD[:PLANNER]], mlp:NAME (an included network), mlp:FILE.npz, sb3:FILE.zip,"
    " safe:POLICY (behind a safety filter), FILE.py:NAME (a class or function of your own)"
)
PolicyName = Annotated[
    str,
    typer.Option("--policy", help=f"{POLICY_HELP}.", autocompletion=policy_names),
]
Trust = Annotated[
    bool,
    typer.Option(
        "--trust",
        help="Load the pickles of sb3:FILE, which can run any code, also if fgenv did not write"
        " them on this machine.",
    ),
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
