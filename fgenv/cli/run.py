"""``fgenv run``: an episode of a scenario, or the published experiment."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fgenv.cli.completion import policy_names
from fgenv.cli.options import (
    FPS_HELP,
    POLICY_HELP,
    ROBOTS_HELP,
    SET_HELP,
    SIZE_HELP,
    Json,
    ScenarioName,
    Seed,
    Trust,
    check_trust,
    file_option,
    refuse_options,
)
from fgenv.cli.scenario_options import overrides_from

PUBLISHED = "three_tanks"  # without --policy
EXPERIMENT_OPTIONS = ("mesh", "scale", "step", "out", "pictures")
EPISODE_OPTIONS = ("n", "size", "set", "steps", "record", "movie", "fps", "trust")
EPISODE = {"rich_help_panel": "An episode"}
EXPERIMENT = {"rich_help_panel": "The published experiment"}

RunPolicy = Annotated[
    str | None,
    typer.Option(
        "--policy",
        help=f"{POLICY_HELP}.",
        show_default="goto; three_tanks: the published experiment",
        autocompletion=policy_names,
    ),
]
Robots = Annotated[int | None, typer.Option("--n", min=1, help=ROBOTS_HELP, **EPISODE)]
Size = Annotated[float | None, typer.Option("--size", help=SIZE_HELP, **EPISODE)]
Settings = Annotated[
    list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help=SET_HELP, **EPISODE)
]
Steps = Annotated[
    int | None,
    typer.Option(
        "--steps", min=1, help="Maximum number of steps.", show_default="the horizon", **EPISODE
    ),
]
RecordFile = Annotated[
    Path | None,
    file_option("--record", "Write a record that can be replayed (.npz).", "An episode"),
]
MovieFile = Annotated[
    Path | None, file_option("--movie", "Write a movie in real time (.gif, .mp4).", "An episode")
]
Fps = Annotated[
    float | None,
    typer.Option("--fps", min=0.1, max=100.0, help=FPS_HELP, show_default="25 at most", **EPISODE),
]
Mesh = Annotated[
    Path | None,
    typer.Option(
        "--mesh",
        show_default="the built-in robot",
        help="Mesh of your own robot: STL, OBJ, PLY, OFF, GLB or DAE, z up, x forward.",
        **EXPERIMENT,
    ),
]
Scale = Annotated[
    float,
    typer.Option(
        "--scale", help="Factor of the mesh to meters; 0.001 for millimeters.", **EXPERIMENT
    ),
]
Step = Annotated[
    float,
    typer.Option(
        "--step", help="Distance that the robot moves between two tests, meters.", **EXPERIMENT
    ),
]
Folder = Annotated[
    Path,
    typer.Option(
        "--out", file_okay=False, help="Folder for the figures; made if missing.", **EXPERIMENT
    ),
]
Pictures = Annotated[
    bool,
    typer.Option("--pictures/--no-pictures", help="Draw the paper's figures.", **EXPERIMENT),
]


def run(
    context: typer.Context,
    scenario: ScenarioName,
    policy: RunPolicy = None,
    n: Robots = None,
    size: Size = None,
    set: Settings = None,
    steps: Steps = None,
    record: RecordFile = None,
    movie: MovieFile = None,
    fps: Fps = None,
    mesh: Mesh = None,
    scale: Scale = 1.0,
    step: Step = 0.01,
    out: Folder = Path("out/three_tanks"),
    pictures: Pictures = True,
    seed: Seed = 0,
    trust: Trust = False,
    as_json: Json = False,
) -> None:
    """Run an episode of a scenario and report the result of each robot.

    A robot succeeds if it reaches its goal without a collision. --record keeps
    the run, to be shown and replayed bit for bit; --movie shows it. Ctrl-C
    ends the episode early; the part until then is reported and recorded.

    The policy plan plans all robots (see fgenv plan) and follows the plan,
    waiting for delayed robots; replan also plans again where robots leave
    their plan. The largest tracking error is reported.

    three_tanks without --policy is the published experiment: the robot takes
    the straight path to its goal. Its motion box sets the collision masks. The
    collision with tank 2 is found by its feature graph and reported as it
    happens; the masks return to 0. Then OMPL's RRTConnect plans a path around
    it, which the robot follows to the goal.

    Exit code of an episode: 0, or 1 if there is no plan. Of the experiment: 0
    if everything came out as published, else 1.
    """
    if scenario == PUBLISHED and policy is None:
        refuse_options(context, EPISODE_OPTIONS, "expected with --policy, such as --policy goto")
        from fgenv.cli.experiment import run_published

        run_published(mesh, scale, step, out, pictures, seed, as_json)
        return
    refuse_options(context, EXPERIMENT_OPTIONS, "is of fgenv run three_tanks, without --policy")
    from fgenv.cli.episode import EpisodeOptions, run_scenario

    overrides = overrides_from(n, size, set)
    files = (record, movie, fps, trust)
    options = EpisodeOptions(scenario, policy or "goto", overrides, seed, steps, *files)
    check_trust(trust, [options.policy])
    run_scenario(context, options, as_json)
