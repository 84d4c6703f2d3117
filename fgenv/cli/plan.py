"""``fgenv plan``: certified paths for all robots of a scenario, to a file."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fgenv.cli.completion import method_names, scenario_names
from fgenv.cli.errors import fail_check
from fgenv.cli.files import check_target
from fgenv.cli.options import Json, Robots, Seed, Settings, Size, file_option
from fgenv.cli.scenario_options import load_scenario, overrides_from

if TYPE_CHECKING:
    from fgenv.scenarios import Scenario

OBJECTIVES = ("length", "clearance", "time")
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
    typer.Option(
        "--method",
        help="Method: composite, prioritized or conflict_based.",
        show_default="composite for one robot, prioritized for more",
        autocompletion=method_names,
    ),
]
Planner = Annotated[
    str, typer.Option("--planner", help="Planner of OMPL: RRTConnect, PRM, BITstar...")
]
TimeLimit = Annotated[float, typer.Option("--time-limit", help="Time limit in seconds.")]
Margin = Annotated[
    float, typer.Option("--margin", help="Minimum distance of robots from all bodies, meters.")
]
Objective = Annotated[
    str | None,
    typer.Option("--objective", help="Objective: length, clearance or time.", show_default="none"),
]
Simplify = Annotated[bool, typer.Option("--simplify/--no-simplify", help="Shorten the paths.")]
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


def plan(
    context: typer.Context,
    scenario: OptionalScenario = None,
    method: Method = None,
    planner: Planner = "RRTConnect",
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
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Plan all robots of a scenario to their goals, and certify the plan.

    Robots move straight within a step of the scenario; the motion of all
    robots at once is proved collision-free, with --margin meters to spare.
    --out keeps the plan: fgenv verify certifies it again, fgenv run SCENARIO
    --policy plan:FILE.npz executes it. Exit code 1 if there is no plan; stderr
    has the reason. After Ctrl-C the best plan so far, if any, is reported and
    kept.
    """
    from fgenv.cli.plan_report import print_plan
    from fgenv.planners import PlanningError
    from fgenv.planners.planning import plan as plan_all

    check_target(out, "--out", ".npz")
    if objective is not None and objective not in OBJECTIVES:
        raise ValueError(f"--objective: got {objective!r}, expected {', '.join(OBJECTIVES)}")
    overrides = overrides_from(n, size, set)
    if mesh is None:
        if world or start or goal:
            raise ValueError("--world, --start and --goal: expected with --mesh")
        problem = load_scenario(context, scenario, overrides, seed)
    else:
        if scenario or overrides:
            raise ValueError("--mesh: expected with --start and --goal, and without a scenario")
        problem = scenario_of_mesh(mesh, world, start, goal, scale)
    options: dict[str, Any] = {"method": method, "margin": margin, "objective": objective}
    with recorded_interrupts() as interrupts:
        try:
            result = plan_all(problem, planner, time_limit, seed, simplify, **options)
        except PlanningError as error:
            fail_check(error)
    if out is not None:
        result.save(out)
        result = type(result).load(out)  # with the hashes of its files
    print_plan(result, [str(out)] if out else [], as_json)
    if interrupts:
        raise KeyboardInterrupt


def scenario_of_mesh(
    mesh: Path, world: Path | None, start: str | None, goal: str | None, scale: float
) -> Scenario:
    """Return the scenario of a robot's mesh."""
    from fgenv.cli.mesh_scenario import scenario_of_meshes

    if start is None or goal is None:
        raise ValueError("--mesh: expected with --start and --goal, and without a scenario")
    return scenario_of_meshes(mesh, world, start, goal, scale)


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
