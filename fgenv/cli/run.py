"""``fgenv run``: an episode of a scenario; or the published experiment, told as it happens."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fgenv.cli.options import Json, Seed
from fgenv.cli.scenarios import given, target

PUBLISHED = "three_tanks"  # without --policy
OF_THE_EXPERIMENT = ("mesh", "scale", "step", "out", "pictures")
OF_AN_EPISODE = ("n", "size", "set", "steps", "record", "movie", "fps")
EPISODE, EXPERIMENT = "An episode", "The published experiment"  # panels of the help


def names(incomplete: str) -> list[str]:
    """Built-in scenarios, for tab completion."""
    from fgenv.scenarios.library import ENTRIES

    return [name for name in ENTRIES if name.startswith(incomplete)]


def policies(incomplete: str) -> list[str]:
    """Policies, for tab completion."""
    from fgenv.agents.policies.names import policy_names

    return [name for name in policy_names() if name.startswith(incomplete)]


def run(
    context: typer.Context,
    scenario: Annotated[
        str,
        typer.Argument(
            help="A built-in scenario (see fgenv scenarios), a scenario file, or a frozen set.",
            autocompletion=names,
        ),
    ],
    policy: Annotated[
        str | None,
        typer.Option(
            "--policy",
            help="What acts: goto, orca, random, rest, plan[:METHOD[:PLANNER]], plan:FILE.npz or"
            " replan[:METHOD[:PLANNER]], mlp:FILE, sb3:FILE.",
            show_default="goto; of three_tanks the published experiment",
            autocompletion=policies,
        ),
    ] = None,
    n: Annotated[
        int | None, typer.Option("--n", min=1, help="Robots.", rich_help_panel=EPISODE)
    ] = None,
    size: Annotated[
        float | None,
        typer.Option("--size", help="Meters; see the scenario.", rich_help_panel=EPISODE),
    ] = None,
    set: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="What is the scenario's own: jitter=0.1.",
            rich_help_panel=EPISODE,
        ),
    ] = None,
    steps: Annotated[
        int | None,
        typer.Option(
            "--steps", min=1, help="At most.", show_default="the horizon", rich_help_panel=EPISODE
        ),
    ] = None,
    record: Annotated[
        Path | None,
        target("--record", "Write what happened (.npz), to be run again.", EPISODE),
    ] = None,
    movie: Annotated[
        Path | None, target("--movie", "Write a movie in real time (.gif, .mp4).", EPISODE)
    ] = None,
    fps: Annotated[
        float | None,
        typer.Option(
            "--fps",
            min=0.1,
            max=100.0,
            help="Frames of the movie in a second, no more than there are steps.",
            show_default="25 at most",
            rich_help_panel=EPISODE,
        ),
    ] = None,
    mesh: Annotated[
        Path | None,
        typer.Option(
            "--mesh",
            show_default="the built-in robot",
            help="Your own robot: STL, OBJ, PLY, OFF, GLB or DAE, z up, x forward.",
            rich_help_panel=EXPERIMENT,
        ),
    ] = None,
    scale: Annotated[
        float,
        typer.Option(
            "--scale",
            help="Factor of the mesh to meters; 0.001 for millimeters.",
            rich_help_panel=EXPERIMENT,
        ),
    ] = 1.0,
    step: Annotated[
        float,
        typer.Option(
            "--step",
            help="Meters that the robot moves between two tests.",
            rich_help_panel=EXPERIMENT,
        ),
    ] = 0.01,
    out: Annotated[
        Path,
        typer.Option(
            "--out",
            file_okay=False,
            help="Folder for the figures; made if missing.",
            rich_help_panel=EXPERIMENT,
        ),
    ] = Path("out/three_tanks"),
    pictures: Annotated[
        bool,
        typer.Option(
            "--pictures/--no-pictures",
            help="Draw the paper's figures.",
            rich_help_panel=EXPERIMENT,
        ),
    ] = True,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Run an episode of a scenario and say how each robot did.

    plan plans all robots (see fgenv plan) and drives the plan; who is held up
    is waited for. replan looks ahead, and plans anew where robots do not do as
    they are told. How far robots were off their plan at most is told.

    A robot succeeds if it comes to its goal and meets nothing. --record keeps
    the run to be looked at and run again, bit for bit; --movie shows it.
    Interrupted by Ctrl-C, what there is by then is told and recorded.

    three_tanks without --policy is the published experiment: the robot takes
    the straight path to its goal. Its motion box sets the collision masks. The
    collision with tank 2 is found by its feature graph and announced as it
    happens; the masks return to 0. Then OMPL's RRTConnect plans a path around
    it, which is driven to the goal. Exit code 0 if all came out as published,
    1 if not; of an episode 0, however it ended, 1 where there is no plan.
    """
    if scenario == PUBLISHED and policy is None:
        refuse(context, OF_AN_EPISODE, "expected with --policy, such as --policy goto")
        from fgenv.cli.experiment import run_published

        run_published(mesh, scale, step, out, pictures, seed, as_json)
        return
    refuse(context, OF_THE_EXPERIMENT, "is of fgenv run three_tanks, without --policy")
    from fgenv.cli.episode import EpisodeOptions, run_scenario

    overrides = given(n, size, set or [])
    options = EpisodeOptions(scenario, policy or "goto", overrides, seed, steps, record, movie, fps)
    run_scenario(context, options, as_json)


def refuse(context: typer.Context, options: tuple[str, ...], why: str) -> None:
    """ValueError where one of these options was given."""
    for name in options:
        source = context.get_parameter_source(name)
        if source is not None and source.name == "COMMANDLINE":
            raise ValueError(f"--{name}: {why}")
