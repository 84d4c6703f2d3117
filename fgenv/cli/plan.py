"""``fgenv plan``: certified paths for all robots of a scenario, to a file."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fgenv.cli.completion import methods, objectives, planners, scenario_names
from fgenv.cli.errors import fail_check
from fgenv.cli.files import check_target
from fgenv.cli.options import (
    Json,
    Robots,
    Seed,
    Settings,
    Size,
    choice_option,
    file_option,
    refuse_options,
)
from fgenv.cli.plan_statistics import compare_planners, seed_range
from fgenv.cli.progress import status
from fgenv.cli.scenario_options import load_scenario, overrides_from

if TYPE_CHECKING:
    from fgenv.scenarios import Scenario

OWN = {"rich_help_panel": "Your own mesh"}

OptionalScenario = Annotated[
    str | None,
    typer.Argument(
        help="Built-in scenario (see fgenv scenarios), or scenario file.",
        autocompletion=scenario_names,
    ),
]
Method = Annotated[
    str | None,
    choice_option(
        "--method",
        "Method: composite, prioritized or conflict_based.",
        methods,
        show_default="composite for one robot, prioritized for more",
    ),
]
Planners = Annotated[
    list[str] | None,
    choice_option(
        "--planner",
        "Planner of OMPL, for the method composite: RRT, RRTConnect, RRTstar, InformedRRTstar,"
        " SORRTstar, AORRTC, BITstar, PRM, PRMstar, FMT, BFMT, KPIECE1, BKPIECE1 or LBKPIECE1;"
        " several with --seeds.",
        planners,
        show_default="RRTConnect",
    ),
]
TimeLimit = Annotated[float, typer.Option("--time-limit", help="Time limit in seconds.")]
Margin = Annotated[
    float, typer.Option("--margin", help="Minimum distance of robots from all bodies, meters.")
]
Objective = Annotated[
    str | None,
    choice_option(
        "--objective",
        "Objective of an optimizing planner: length, clearance or time.",
        objectives,
        show_default="none",
    ),
]
Simplify = Annotated[bool, typer.Option("--simplify/--no-simplify", help="Shorten the paths.")]
Seeds = Annotated[
    str | None, typer.Option("--seeds", metavar="FIRST:END", help="Compare over these seeds.")
]
Csv = Annotated[Path | None, file_option("--csv", "With --seeds: a row for each result.")]
Out = Annotated[Path | None, file_option("--out", "Write the plan (.npz).")]
Mesh = Annotated[
    Path | None, typer.Option("--mesh", help="Mesh of the robot, in place of a scenario.", **OWN)
]
WorldMesh = Annotated[Path | None, typer.Option("--world", help="Mesh of the obstacles.", **OWN)]
Start = Annotated[
    str | None,
    typer.Option("--start", help="Start configuration, x,y,yaw or x,y,z,qx,qy,qz,qw.", **OWN),
]
Goal = Annotated[
    str | None, typer.Option("--goal", help="Goal configuration, as for --start.", **OWN)
]
Scale = Annotated[float, typer.Option("--scale", help="Factor of meshes to meters.", **OWN)]
Up = Annotated[
    str,
    typer.Option(
        "--up",
        help="Axis of the meshes that becomes z: z, y or x. y turns (x, y, z) to (x, -z, y),"
        " the frame of --start and --goal.",
        **OWN,
    ),
]


def plan(
    context: typer.Context,
    scenario: OptionalScenario = None,
    method: Method = None,
    planner: Planners = None,
    n: Robots = None,
    size: Size = None,
    set: Settings = None,
    time_limit: TimeLimit = 10.0,
    margin: Margin = 0.0,
    objective: Objective = None,
    simplify: Simplify = True,
    out: Out = None,
    mesh: Mesh = None,
    world: WorldMesh = None,
    start: Start = None,
    goal: Goal = None,
    scale: Scale = 1.0,
    up: Up = "z",
    seed: Seed = 0,
    seeds: Seeds = None,
    csv: Csv = None,
    as_json: Json = False,
) -> None:
    """Plan all robots of a scenario to their goals, and certify the plan.

    Robots move straight within a step of the scenario; the motion of all
    robots at once is proved collision-free, with --margin meters to spare.
    --out keeps the plan: fgenv verify certifies it again, fgenv run SCENARIO
    --policy plan:FILE.npz executes it. Exit code 1 if there is no plan; stderr
    has the reason. After Ctrl-C the best plan so far, if any, is reported and
    kept.

    With --seeds 0:20 each planner plans with each of these seeds: success,
    median time and costs are reported with 95 % intervals. --csv keeps each
    result as it comes; the same command then goes on where it stopped.
    """
    from fgenv.cli.plan_report import print_plan
    from fgenv.planners import PlanningError
    from fgenv.planners.planning import plan as plan_all

    check_target(out, "--out", ".npz")
    overrides = overrides_from(n, size, set)
    if mesh is None:
        refuse_options(context, ("world", "start", "goal", "scale", "up"), "expected with --mesh")
        problem = load_scenario(context, scenario, overrides, seed)
    else:
        if scenario or overrides:
            raise ValueError("--mesh: expected with --start and --goal, and without a scenario")
        problem = scenario_of_mesh(mesh, world, start, goal, scale, up)
    options: dict[str, Any] = {"method": method, "margin": margin, "objective": objective}
    if seeds is not None:
        refuse_options(context, ("out", "seed"), "has no effect with --seeds")
        names = planner or [method or "prioritized" if len(problem.robots) > 1 else "RRTConnect"]
        options |= {"time_limit": time_limit, "simplify": simplify}
        compare_planners(problem, names, seed_range(seeds), options, csv, as_json)
        return
    refuse_options(context, ("csv",), "expected with --seeds")
    if planner is not None and len(planner) > 1:
        raise ValueError("--planner: got several, expected one, or --seeds to compare them")
    name = planner[0] if planner else None
    with recorded_interrupts() as interrupts, status(f"planning, at most {time_limit:g} s"):
        try:
            result = plan_all(problem, name, time_limit, seed, simplify, **options)
        except PlanningError as error:
            fail_check(error)
    if out is not None:
        result.save(out)
        result = type(result).load(out)  # with the hashes of its files
    print_plan(result, [str(out)] if out else [], as_json)
    if interrupts:
        raise KeyboardInterrupt


def scenario_of_mesh(
    mesh: Path,
    world: Path | None,
    start: str | None,
    goal: str | None,
    scale: float,
    up: str,
) -> Scenario:
    """Return the scenario of a robot's mesh."""
    from fgenv.cli.mesh_scenario import scenario_of_meshes

    if start is None or goal is None:
        raise ValueError("--mesh: expected with --start and --goal, and without a scenario")
    return scenario_of_meshes(mesh, world, start, goal, scale, up)


@contextmanager
def recorded_interrupts() -> Iterator[list[int]]:
    """Record Ctrl-C in the yielded list; it raises KeyboardInterrupt as usual."""
    signals: list[int] = []

    def handle(number: int, frame: Any) -> None:
        signals.append(number)
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGINT, handle)
    try:
        yield signals
    finally:
        signal.signal(signal.SIGINT, before)
