"""``fgenv scenarios``: list the built-in ones; draw, save or freeze one; print the schema."""

from __future__ import annotations

import inspect
import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fgenv.cli.files import check_target, echo_written
from fgenv.cli.options import Json, Robots, Seed, Settings, Size, file_option, refuse_options
from fgenv.cli.scenario_options import is_file, overrides_from
from fgenv.saving import atomic

if TYPE_CHECKING:
    from fgenv.scenarios import Scenario
    from fgenv.scenarios.registry import FileFormat

Name = Annotated[
    str | None, typer.Argument(help="Built-in scenario, or scenario file; all if left out.")
]
Save = Annotated[Path | None, file_option("--save", "Write the scenario as YAML.")]
PictureFile = Annotated[Path | None, file_option("--picture", "Draw the scenario to this PNG.")]
Freeze = Annotated[Path | None, file_option("--freeze", "Write an evaluation set (.npz).")]
Cases = Annotated[int, typer.Option("--cases", min=1, help="Number of cases for --freeze.")]
OF_A_SCENARIO = ("n", "seed", "size", "set", "save", "picture", "freeze", "cases")
Schema = Annotated[bool, typer.Option("--schema", help="Print the JSON Schema.")]


def scenarios(
    context: typer.Context,
    name: Name = None,
    n: Robots = None,
    seed: Seed = 0,
    size: Size = None,
    set: Settings = None,
    save: Save = None,
    picture: PictureFile = None,
    freeze: Freeze = None,
    cases: Cases = 500,
    schema: Schema = False,
    as_json: Json = False,
) -> None:
    """List the built-in scenarios, or show, save, draw or freeze one of them.

    Case i of an evaluation set is the scenario with seed SEED + i; its id is a hash of all cases.
    """
    from fgenv.scenarios import Scenario
    from fgenv.scenarios.json_schema import json_schema

    if schema:
        refuse_options(context, ("name", *OF_A_SCENARIO), "has no effect with --schema")
        typer.echo(json.dumps(json_schema(), indent=1))
        return
    if name is None:
        reason = "expected with the NAME of a scenario; see fgenv scenarios"
        refuse_options(context, OF_A_SCENARIO, reason)
        print_list(as_json)
        return
    check_target(save, "--save", ".yaml", ".yml")
    check_target(picture, "--picture", ".png")
    check_target(freeze, "--freeze", ".npz")
    overrides = overrides_from(n, size, set)
    if freeze is not None:
        refuse_options(context, ("save", "picture"), "has no effect with --freeze")
        freeze_scenario(name, freeze, cases, seed, overrides, as_json)
        return
    refuse_options(context, ("cases",), "expected with --freeze")
    seeded = {} if seed == 0 and is_file(name) else {"seed": seed}
    scenario = Scenario.load(name, **seeded, **overrides)
    if save is not None:
        scenario.save(save)
    if picture is not None:
        from fgenv.view.figures.scenario_picture import draw_scenario

        with atomic(picture) as partial:
            draw_scenario(scenario).save(partial, optimize=True)
    written = [str(path) for path in (save, picture) if path is not None]
    print_scenario(name, scenario, written, as_json)


def print_list(as_json: bool) -> None:
    """Print the built-in scenarios."""
    from rich.console import Console
    from rich.table import Table

    from fgenv.scenarios.library import ENTRIES

    if as_json:
        typer.echo(json.dumps([entry.facts for entry in ENTRIES.values()], indent=1))
        return
    table = Table(box=None, pad_edge=False)
    for title in ("name", "robots", "", "about"):
        table.add_column(title, no_wrap=title != "about")
    for e in ENTRIES.values():
        table.add_row(e.name, e.robots, f"{e.dimension}D", e.about)
    Console(highlight=False, markup=False).print(table)


def print_scenario(name: str, scenario: Scenario, written: list[str], as_json: bool) -> None:
    """Print a scenario, its options and the written files."""
    from fgenv.scenarios.library import ENTRIES

    known = ENTRIES.get(name) or format_of(name)
    options = {} if known is None else known.parameters
    if as_json:
        data = {
            "name": scenario.name,
            "about": scenario.description,
            "robots": len(scenario.robots),
            "bodies": len(scenario.bodies),
            "dimension": scenario.dimension,
            "seed": scenario.seed,
            "takes": options,
            "written": written,
        }
        typer.echo(json.dumps(data, indent=1))
        return
    typer.echo(f"{scenario.name}: {scenario.description}")
    if known is not None and options:
        typer.echo(f"\n{inspect.getdoc(known.make)}")
        typer.echo("\nDefaults: " + ", ".join(f"{key}={value}" for key, value in options.items()))
    for path in written:
        typer.echo(f"written: {path}")


def format_of(name: str) -> FileFormat | None:
    """Return the format of a file of another program; None for a scenario file."""
    from fgenv.scenarios.load import file_format_of
    from fgenv.scenarios.registry import FileFormat

    found = file_format_of(Path(name))
    return found if isinstance(found, FileFormat) else None


def freeze_scenario(
    name: str, path: Path, cases: int, seed: int, overrides: dict[str, Any], as_json: bool
) -> None:
    """Write an evaluation set of a scenario."""
    from fgenv.cli.progress import progress
    from fgenv.scenarios import frozen

    with progress() as bar:
        task = bar.add_task("making cases", total=cases)
        frozen_set = frozen(
            name,
            cases=cases,
            seed=seed,
            progress=lambda done: bar.update(task, completed=done),
            **overrides,
        )
    frozen_set.save(path)
    if as_json:
        robots = len(frozen_set.template.robots)
        data = {"name": name, "cases": cases, "seed": seed, "robots": robots}
        typer.echo(json.dumps({**data, "id": frozen_set.id, "written": [str(path)]}, indent=1))
    else:
        typer.echo(f"{frozen_set!r}\nid {frozen_set.id}")
        echo_written([path])
