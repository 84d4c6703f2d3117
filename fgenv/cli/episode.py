"""An episode of a scenario by a policy, with progress, a table, a record and a movie."""

from __future__ import annotations

import json
import time
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from fgenv.cli.movie import MOST_FPS, draw, progress
from fgenv.cli.plan import fail
from fgenv.cli.scenarios import is_file

if TYPE_CHECKING:
    from rich.console import Console

    from fgenv.envs import Record, Simulator


@dataclass(frozen=True)
class EpisodeOptions:
    """What the command line asks for."""

    scenario: str
    policy: str
    overrides: dict[str, Any]
    seed: int
    steps: int | None
    record: Path | None
    movie: Path | None
    fps: float | None


def run_scenario(context: typer.Context, options: EpisodeOptions, as_json: bool) -> None:
    """Run it, and say how it went.

    Raises:
        KeyboardInterrupt: it was interrupted; what there was by then is told and recorded.
    """
    from rich.console import Console

    from fgenv.cli.episode_report import facts, tell
    from fgenv.envs import policy_of
    from fgenv.metrics import Results

    console = Console(stderr=as_json, highlight=False)
    targets(options)
    policy = policy_of(options.policy, options.seed)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        simulator = simulator_of(context, options, policy)
    strictly(policy)
    began = time.perf_counter()
    record, interrupted = episode(simulator, policy, options, console)
    seconds = time.perf_counter() - began
    written = []
    if options.record is not None:
        record.save(options.record)
        written.append(str(options.record))
    results = Results.of(record)
    followed = following(policy)
    notes = list(dict.fromkeys(str(warning.message) for warning in caught))
    if not as_json:
        tell(console, record, results, seconds, notes)
        if followed:
            error, waited = followed["tracking_error"], followed["waited"]
            again = f", planned anew {followed['replans']} times" if "replans" in followed else ""
            console.print(f"tracking error {error:.2g} m, waited {waited:.1f} s{again}")
    if options.movie is not None and not interrupted:
        draw(record, options.movie, options.fps, console)
        written.append(str(options.movie))
    if as_json:
        said = {**facts(record, results, seconds, notes, written), **followed}
        typer.echo(json.dumps(said, indent=1))
    else:
        for path in written:
            typer.echo(f"written: {path}, {Path(path).stat().st_size:,} bytes")
    if interrupted:
        raise KeyboardInterrupt


def strictly(policy: Any) -> None:
    """A planning policy that finds no plan is to say so, rather than to rest."""
    if hasattr(policy, "strict"):
        policy.strict = True


def following(policy: Any) -> dict[str, Any]:
    """How a planning policy's plan was followed: meters, seconds; nothing of others."""
    names = ("tracking_error", "waited", "replans")
    return {name: getattr(policy, name) for name in names if hasattr(policy, name)}


def targets(options: EpisodeOptions) -> None:
    """What would only be told after the run is told now: files that cannot be written."""
    from fgenv.view.figures.movie import frame_seconds

    if options.record is not None and options.record.suffix != ".npz":
        raise ValueError(f"--record: got {options.record}, expected a name that ends in .npz")
    if options.movie is not None:
        frame_seconds(options.movie, options.fps or MOST_FPS)
    elif options.fps is not None:
        raise ValueError("--fps: is of a movie, expected with --movie")
    for path in (options.record, options.movie):
        if path is not None and not path.parent.is_dir():
            raise ValueError(f"{path}: there is no folder {path.parent}; make it first")


def is_planning_error(error: RuntimeError) -> bool:
    """Whether there is no plan."""
    from fgenv.planners import PlanningError

    return isinstance(error, PlanningError)


def simulator_of(context: typer.Context, options: EpisodeOptions, policy: Any) -> Simulator:
    """The simulator, with one world; robots observe and act as the policy wants it."""
    from fgenv.envs import Simulator
    from fgenv.scenarios.library import ENTRIES

    name, overrides = options.scenario, dict(options.overrides)
    of_file = is_file(name) or Path(name).suffix == ".npz"
    if not of_file and name not in ENTRIES:
        from fgenv.scenarios.errors import near

        told = f"{name!r} is no built-in scenario; {near(name, ENTRIES)} (a file ends in .yaml)"
        raise typer.BadParameter(told, ctx=context, param_hint="SCENARIO")
    if not of_file or (options.seed != 0 and Path(name).suffix != ".npz"):
        overrides.setdefault("seed", options.seed)
    for key in ("observation", "actions"):
        if getattr(policy, key, None) is not None:
            overrides.setdefault(key, getattr(policy, key))
    return Simulator(name, clearance=True, autoreset=False, **overrides)


def episode(
    simulator: Simulator, policy: Any, options: EpisodeOptions, console: Console
) -> tuple[Record, bool]:
    """The record, and whether it was interrupted."""
    from fgenv.agents import run_episode
    from fgenv.envs import Recorder

    recorder = Recorder(options.policy)
    most = min(options.steps or simulator.horizon, simulator.horizon)
    with progress(console) as bar:
        task = bar.add_task(f"{simulator.scenario.name}, {options.policy}", total=most)
        try:
            record = run_episode(
                simulator,
                policy,
                seed=options.seed,
                steps=most,
                recorder=recorder,
                progress=lambda done: bar.update(task, completed=done),
            )
            return record, False
        except RuntimeError as error:
            if not is_planning_error(error):
                raise
            fail(error)
        except KeyboardInterrupt:
            if not recorder.begun:
                raise
            return recorder.record(), True
