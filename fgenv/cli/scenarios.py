"""``fgenv scenarios``: list the built-in ones; draw, save or freeze one; print the schema."""

from __future__ import annotations

import inspect
import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fgenv.cli.options import Json, Seed

if TYPE_CHECKING:
    from fgenv.scenarios import Scenario

File = Path | None


def target(name: str, text: str, panel: str | None = None) -> Any:
    """An option that names a file to write."""
    return typer.Option(name, dir_okay=False, help=text, rich_help_panel=panel)


def scenarios(
    name: Annotated[
        str | None, typer.Argument(help="A built-in scenario, or a scenario file; all if left out.")
    ] = None,
    n: Annotated[int | None, typer.Option("--n", min=1, help="Robots.")] = None,
    seed: Seed = 0,
    size: Annotated[float | None, typer.Option("--size", help="Meters; see the scenario.")] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="What is the scenario's own: jitter=0.1."),
    ] = None,
    save: Annotated[File, target("--save", "Write the scenario as YAML.")] = None,
    picture: Annotated[File, target("--picture", "Draw it to this PNG.")] = None,
    freeze: Annotated[File, target("--freeze", "Write an evaluation set (.npz).")] = None,
    cases: Annotated[int, typer.Option("--cases", min=1, help="Of --freeze.")] = 500,
    schema: Annotated[bool, typer.Option("--schema", help="Print the JSON Schema.")] = False,
    as_json: Json = False,
) -> None:
    """List the built-in scenarios, or show, save, draw or freeze one of them.

    Case i of an evaluation set is the scenario with seed SEED + i; its id is a hash of all cases.
    """
    from fgenv.scenarios import Scenario
    from fgenv.scenarios.json_schema import json_schema

    if schema:
        typer.echo(json.dumps(json_schema(), indent=1))
        return
    if name is None:
        _no_target(save, picture, freeze)
        _list(as_json)
        return
    overrides = given(n, size, settings or [])
    if freeze is not None:
        _freeze(name, freeze, cases, seed, overrides, as_json)
        return
    context = {} if seed == 0 and is_file(name) else {"seed": seed}
    scenario = Scenario.load(name, **context, **overrides)
    if save is not None:
        scenario.save(save)
    if picture is not None:
        from fgenv.view.figures.scenario_picture import draw_scenario

        draw_scenario(scenario).save(picture, optimize=True)
    _show(name, scenario, [str(path) for path in (save, picture) if path is not None], as_json)


def is_file(name: str) -> bool:
    """Whether a scenario's name is that of a file."""
    from fgenv.scenarios.load import is_file_name

    return is_file_name(name)


def given(n: int | None, size: float | None, settings: list[str]) -> dict[str, Any]:
    """Overrides of the command line; values of --set are read as YAML."""
    import yaml

    found = {key: value for key, value in (("n", n), ("size", size)) if value is not None}
    for setting in settings:
        key, equals, text = setting.partition("=")
        if not equals:
            raise ValueError(f"--set: got {setting!r}, expected KEY=VALUE, such as jitter=0.1")
        try:
            found[key.strip()] = yaml.safe_load(text)
        except yaml.YAMLError:
            raise ValueError(
                f"--set: got {setting!r}, expected a number or a word as VALUE"
            ) from None
    return found


def _no_target(*files: Path | None) -> None:
    if any(file is not None for file in files):
        raise ValueError("expected the NAME of a scenario to write; see fgenv scenarios")


def _list(as_json: bool) -> None:
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


def _show(name: str, scenario: Scenario, written: list[str], as_json: bool) -> None:
    from fgenv.scenarios.library import ENTRIES

    own = {} if name not in ENTRIES else ENTRIES[name].parameters
    if as_json:
        robots, bodies = len(scenario.robots), len(scenario.bodies)
        said = {"name": scenario.name, "about": scenario.description, "robots": robots}
        more = {"bodies": bodies, "dimension": scenario.dimension, "seed": scenario.seed}
        typer.echo(json.dumps({**said, **more, "takes": own, "written": written}, indent=1))
        return
    typer.echo(f"{scenario.name}: {scenario.description}")
    if name in ENTRIES and own:
        typer.echo(f"\n{inspect.getdoc(ENTRIES[name].make)}")
        typer.echo("\nDefaults: " + ", ".join(f"{key}={value}" for key, value in own.items()))
    for path in written:
        typer.echo(f"written: {path}")


def _freeze(
    name: str, path: Path, cases: int, seed: int, overrides: dict[str, Any], as_json: bool
) -> None:
    from rich.console import Console

    from fgenv.scenarios import frozen

    if path.suffix != ".npz":
        raise ValueError(f"--freeze: got {path}, expected a name that ends in .npz")
    console = Console(stderr=True, highlight=False)
    with console.status("making cases") as status:
        made = frozen(
            name,
            cases=cases,
            seed=seed,
            progress=lambda done: status.update(f"{done} of {cases} cases made"),
            **overrides,
        )
    made.save(path)
    if as_json:
        said = {"name": name, "cases": cases, "seed": seed, "robots": len(made.template.robots)}
        typer.echo(json.dumps({**said, "id": made.id, "written": [str(path)]}, indent=1))
    else:
        typer.echo(f"{made!r}\nid {made.id}\nwritten: {path}, {path.stat().st_size:,} bytes")
