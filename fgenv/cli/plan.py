"""``fgenv plan``: paths for all robots of a scenario, timed and proved, to a file."""

from __future__ import annotations

import json
import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from fgenv.cli.errors import FAILED_CHECK
from fgenv.cli.options import Json, Seed
from fgenv.cli.scenarios import given, is_file, target

if TYPE_CHECKING:
    from fgenv.planners import Plan
    from fgenv.scenarios import Scenario

OWN = "Your own mesh"  # panel of the help
OBJECTIVES = ("length", "clearance", "time")


def names(incomplete: str) -> list[str]:
    """Built-in scenarios, for tab completion."""
    from fgenv.scenarios.library import ENTRIES

    return [name for name in ENTRIES if name.startswith(incomplete)]


def methods(incomplete: str) -> list[str]:
    """Methods, for tab completion."""
    from fgenv.planners.methods import METHODS

    return [name for name in METHODS if name.startswith(incomplete)]


def plan(
    context: typer.Context,
    scenario: Annotated[
        str | None,
        typer.Argument(
            help="A built-in scenario (see fgenv scenarios) or a scenario file.",
            autocompletion=names,
        ),
    ] = None,
    method: Annotated[
        str | None,
        typer.Option(
            "--method",
            help="composite, prioritized or conflict_based.",
            show_default="composite for one robot, prioritized for more",
            autocompletion=methods,
        ),
    ] = None,
    planner: Annotated[
        str, typer.Option("--planner", help="Of OMPL: RRTConnect, PRM, BITstar...")
    ] = "RRTConnect",
    n: Annotated[int | None, typer.Option("--n", min=1, help="Robots.")] = None,
    size: Annotated[float | None, typer.Option("--size", help="Meters; see the scenario.")] = None,
    set: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="What is the scenario's own: jitter=0.1."),
    ] = None,
    time_limit: Annotated[float, typer.Option("--time-limit", help="Seconds.")] = 10.0,
    margin: Annotated[
        float, typer.Option("--margin", help="Meters that robots keep from everything.")
    ] = 0.0,
    objective: Annotated[
        str | None,
        typer.Option("--objective", help="length, clearance or time.", show_default="none"),
    ] = None,
    simplify: Annotated[
        bool, typer.Option("--simplify/--no-simplify", help="Shorten what was found.")
    ] = True,
    out: Annotated[Path | None, target("--out", "Write the plan (.npz).")] = None,
    mesh: Annotated[
        Path | None,
        typer.Option("--mesh", help="The robot, in place of a scenario.", rich_help_panel=OWN),
    ] = None,
    world: Annotated[
        Path | None, typer.Option("--world", help="What stands around it.", rich_help_panel=OWN)
    ] = None,
    start: Annotated[
        str | None,
        typer.Option("--start", help="x,y,yaw or x,y,z,qx,qy,qz,qw.", rich_help_panel=OWN),
    ] = None,
    goal: Annotated[
        str | None, typer.Option("--goal", help="The same.", rich_help_panel=OWN)
    ] = None,
    scale: Annotated[
        float, typer.Option("--scale", help="Factor of meshes to meters.", rich_help_panel=OWN)
    ] = 1.0,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Plan all robots of a scenario to their goals, and prove the plan.

    In a step of the scenario every robot goes straight on; the motion of all
    robots at once is proved free, with --margin meters to spare. --out keeps
    the plan: fgenv verify proves it again, fgenv run SCENARIO --policy
    plan:FILE.npz drives it. Exit code 1 where there is no plan; stderr says why.
    Interrupted by Ctrl-C, the best by then is told and kept, if there is one.
    """
    from fgenv.planners import PlanningError
    from fgenv.planners.planning import plan as plan_all

    if out is not None and (out.suffix != ".npz" or not out.parent.is_dir()):
        folder = f"; there is no folder {out.parent}, make it first"
        wrong = ", expected a name that ends in .npz" if out.suffix != ".npz" else folder
        raise ValueError(f"--out: {out}{wrong}")
    if objective is not None and objective not in OBJECTIVES:
        raise ValueError(f"--objective: got {objective!r}, expected {', '.join(OBJECTIVES)}")
    given_scenario = given(n, size, set or [])
    if mesh is None:
        if world or start or goal:
            raise ValueError("--world, --start and --goal: expected with --mesh")
        problem = scenario_of(context, scenario, given_scenario, seed)
    else:
        if scenario or given_scenario or start is None or goal is None:
            raise ValueError("--mesh: expected with --start and --goal, and without a scenario")
        from fgenv.cli.meshes import scenario_of_meshes

        problem = scenario_of_meshes(mesh, world, start, goal, scale)
    options: dict[str, Any] = {"method": method, "margin": margin, "objective": objective}
    with interruptible() as interrupted:
        try:
            found = plan_all(problem, planner, time_limit, seed, simplify, **options)
        except PlanningError as error:
            fail(error)
    if out is not None:
        found.save(out)
        found = type(found).load(out)  # with the hashes of its files
    show(found, [str(out)] if out else [], as_json)
    if interrupted:
        raise KeyboardInterrupt


def scenario_of(
    context: typer.Context, name: str | None, overrides: dict[str, Any], seed: int
) -> Scenario:
    """The scenario meant."""
    from fgenv.scenarios import Scenario
    from fgenv.scenarios.errors import near
    from fgenv.scenarios.library import ENTRIES

    if name is None:
        raise typer.BadParameter("expected one, or --mesh", ctx=context, param_hint="SCENARIO")
    of_file = is_file(name)
    if not of_file and name not in ENTRIES:
        told = f"{name!r} is no built-in scenario; {near(name, ENTRIES)} (a file ends in .yaml)"
        raise typer.BadParameter(told, ctx=context, param_hint="SCENARIO")
    if not of_file or seed != 0:
        overrides.setdefault("seed", seed)
    return Scenario.load(name, **overrides)


@contextmanager
def interruptible() -> Iterator[list[int]]:
    """Ctrl-C raises KeyboardInterrupt, as ever, and is remembered in the list that is given."""
    came: list[int] = []

    def handle(number: int, frame: Any) -> None:
        came.append(number)
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGINT, handle)
    try:
        yield came
    finally:
        signal.signal(signal.SIGINT, before)


def fail(error: Exception) -> NoReturn:
    """What a user sees where there is no plan.

    Raises:
        typer.Exit: always; with FGENV_DEBUG=1 the error itself.
    """
    if os.environ.get("FGENV_DEBUG") == "1":
        raise error
    print(f"fgenv: {' '.join(str(error).split())}", file=sys.stderr)
    raise typer.Exit(FAILED_CHECK)


def show(plan: Plan, written: list[str], as_json: bool) -> None:
    """A row for each robot, and what is said of all."""
    if as_json:
        typer.echo(json.dumps(facts(plan, written), indent=1))
        return
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    title = f"{plan.scenario.name}, seed {plan.seed}, by {plan.method}"
    table = Table(title=escape(title), box=None, title_justify="left")
    table.add_column("robot")
    for column in ("arrives (s)", "path (m)"):
        table.add_column(column, justify="right", no_wrap=True)
    names = [robot.name for robot in plan.scenario.robots]
    for name, arrival, length in zip(names, plan.arrivals, plan.lengths, strict=True):
        table.add_row(escape(name), f"{arrival:.1f}", f"{length:.2f}")
    Console(highlight=False).print(table)
    typer.echo(
        f"makespan {plan.makespan:.1f} s, sum of costs {plan.sum_of_costs:.1f} s;"
        f" {plan.facts['seconds']:.2f} s to plan{checks(plan)}"
    )
    typer.echo(told(plan.certificate, plan.dt))
    for path in written:
        typer.echo(f"written: {path}, {Path(path).stat().st_size:,} bytes")


def checks(plan: Plan) -> str:
    """How many motions were checked, where the method counts them."""
    count = plan.facts.get("motions_checked", plan.facts.get("checks"))
    return "" if count is None else f", {count:,} motions checked"


def told(certificate: Any, dt: float) -> str:
    """A certificate in words."""
    if not certificate:
        step = certificate.failed_step
        return f"not proved: step {step} (at {step * dt:.1f} s) is not free"
    kept = f" with {certificate.margin:g} m to spare" if certificate.margin else ""
    text = f"proved free{kept}: {certificate.steps} steps"
    if certificate.nearest is None:
        return f"{text}, nobody is near anything"
    step, robot, other = certificate.nearest
    return (
        f"{text}, nobody comes nearer than {certificate.clearance:.4f} m"
        f" (nearest at {step * dt:.1f} s: {robot} to {other})"
    )


def facts(plan: Plan, written: list[str]) -> dict[str, Any]:
    """The same for JSON: meters and seconds of the plan; `seconds` in `facts` are of the clock."""
    names = [robot.name for robot in plan.scenario.robots]
    rows = zip(names, plan.arrivals, plan.lengths, strict=True)
    return {
        "scenario": plan.scenario.name,
        "seed": plan.seed,
        "method": plan.method,
        "planner": plan.planner,
        "robots": [{"name": n, "arrival": a, "path_length": length} for n, a, length in rows],
        "makespan": plan.makespan,
        "sum_of_costs": plan.sum_of_costs,
        "dt": plan.dt,
        "steps": plan.steps,
        "certificate": claims(plan.certificate),
        "facts": plan.facts,
        "id": plan.id,
        "written": written,
    }


def claims(certificate: Any) -> dict[str, Any]:
    """A certificate for JSON: what is infinite is None."""
    from dataclasses import asdict
    from math import isfinite

    found = asdict(certificate)
    found["clearance"] = found["clearance"] if isfinite(found["clearance"]) else None
    return found
