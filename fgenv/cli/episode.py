"""An episode of a scenario with a policy: progress, table, record and movie."""

from __future__ import annotations

import json
import time
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from fgenv.cli.console import console_of
from fgenv.cli.errors import fail_check
from fgenv.cli.files import check_target, echo_written
from fgenv.cli.progress import MAX_FPS, progress, write_episode_movie
from fgenv.cli.scenario_options import check_name, is_file, is_frozen_set

if TYPE_CHECKING:
    from rich.console import Console

    from fgenv.envs import Record, Simulator


@dataclass(frozen=True)
class EpisodeOptions:
    """Options of the command line."""

    scenario: str
    policy: str
    overrides: dict[str, Any]
    seed: int = 0
    steps: int | None = None
    record: Path | None = None
    movie: Path | None = None
    fps: float | None = None
    trust: bool = False


def run_scenario(context: typer.Context, options: EpisodeOptions, as_json: bool) -> None:
    """Run an episode and report it.

    Raises:
        KeyboardInterrupt: the episode was interrupted; its finished part is reported and recorded.
    """

    from fgenv.cli.episode_report import as_data, print_report
    from fgenv.envs import policy_of
    from fgenv.metrics import Results

    console = console_of(as_json)
    check_targets(options)
    policy = policy_of(options.policy, options.seed, trust=options.trust)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        simulator = simulator_of(context, options, policy)
    require_plan(policy)
    began = time.perf_counter()
    record, interrupted = run_episode(simulator, policy, options)
    seconds = time.perf_counter() - began
    results, tracking = Results.of(record), tracking_of(policy)
    notes = list(dict.fromkeys(str(warning.message) for warning in caught))
    if options.record is not None:
        record.save(options.record)
    if not as_json:
        print_report(console, record, results, seconds, notes)
        print_tracking(console, tracking)
    if options.movie is not None and not interrupted:
        write_episode_movie(record, options.movie, options.fps)
    files = (options.record, None if interrupted else options.movie)
    written = [str(path) for path in files if path is not None]
    if as_json:
        data = {**as_data(record, results, seconds, notes, written), **tracking}
        typer.echo(json.dumps(data, indent=1))
    else:
        echo_written(written)
    if interrupted:
        raise KeyboardInterrupt


def require_plan(policy: Any) -> None:
    """Let a planning policy raise an error, instead of resting, if there is no plan."""
    if hasattr(policy, "strict"):
        policy.strict = True


def tracking_of(policy: Any) -> dict[str, Any]:
    """Return tracking error (m), waiting time (s) and replans of a planning policy."""
    names = ("tracking_error", "waited", "replans")
    return {name: getattr(policy, name) for name in names if hasattr(policy, name)}


def print_tracking(console: Console, tracking: dict[str, Any]) -> None:
    """Print how the plan of a planning policy was followed."""
    if tracking:
        error, waited = tracking["tracking_error"], tracking["waited"]
        replans = f", planned anew {tracking['replans']} times" if "replans" in tracking else ""
        console.print(f"tracking error {error:.2g} m, waited {waited:.1f} s{replans}")


def check_targets(options: EpisodeOptions) -> None:
    """Raise the errors of files that cannot be written, before the run."""
    from fgenv.view.figures.movie import frame_seconds

    check_target(options.record, "--record", ".npz")
    if options.movie is not None:
        frame_seconds(options.movie, options.fps or MAX_FPS)
    elif options.fps is not None:
        raise ValueError("--fps: is of a movie, expected with --movie")
    check_target(options.movie, "--movie")


def is_planning_error(error: RuntimeError) -> bool:
    """Return whether an error means that there is no plan."""
    from fgenv.planners import PlanningError

    return isinstance(error, PlanningError)


def simulator_of(context: typer.Context, options: EpisodeOptions, policy: Any) -> Simulator:
    """Return a simulator with one world, with the observations and actions of the policy."""
    from fgenv.envs import Simulator

    name, overrides = options.scenario, dict(options.overrides)
    check_name(context, name, frozen_sets=True)
    of_file = is_file(name) or is_frozen_set(name)
    if not of_file or (options.seed != 0 and not is_frozen_set(name)):
        overrides.setdefault("seed", options.seed)
    for key in ("observation", "actions"):
        if getattr(policy, key, None) is not None:
            overrides.setdefault(key, getattr(policy, key))
    return Simulator(name, clearance=True, autoreset=False, **overrides)


def run_episode(simulator: Simulator, policy: Any, options: EpisodeOptions) -> tuple[Record, bool]:
    """Return the record, and whether the episode was interrupted."""
    from fgenv import agents
    from fgenv.envs import Recorder

    recorder = Recorder(options.policy)
    steps = min(options.steps or simulator.horizon, simulator.horizon)
    with progress() as bar:
        task = bar.add_task(f"{simulator.scenario.name}, {options.policy}", total=steps)
        try:
            record = agents.run_episode(
                simulator,
                policy,
                seed=options.seed,
                steps=steps,
                recorder=recorder,
                progress=lambda done: bar.update(task, completed=done),
            )
            return record, False
        except RuntimeError as error:
            if not is_planning_error(error):
                raise
            fail_check(error)
        except KeyboardInterrupt:
            if not recorder.begun:
                raise
            return recorder.record(), True
