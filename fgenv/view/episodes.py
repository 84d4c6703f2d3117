"""Files that can be shown: records of episodes, and plans as if they had been executed."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fgenv.envs import Record
from fgenv.envs.record import ARRAYS, INITIAL, Arrays
from fgenv.envs.state_readers import MOVING, PARKED
from fgenv.npz import open_npz
from fgenv.planners import Plan


def load_episode(path: str | Path) -> Record:
    """Load a record, or a plan file as the record of its exact execution.

    Raises:
        RecordError, PlanError: the file is neither, damaged, or of another version.
        FileNotFoundError: the file does not exist.
    """
    if format_of(Path(path)).startswith("fgenv plan "):
        return record_of_plan(Plan.load(path))
    return Record.load(path)


def format_of(path: Path) -> str:
    """Return the format that a file declares, or an empty string."""
    try:
        with open_npz(path) as file:
            return file.text("format")
    except (FileNotFoundError, IsADirectoryError, PermissionError):
        raise
    except Exception:  # errors of zip, zlib and NumPy; the loader reports them
        return ""


def record_of_plan(plan: Plan) -> Record:
    """Return a record of a plan's steps, without contacts and with infinite clearances.

    The record has no actions, so `Record.replay` refuses it.
    """
    steps, n = plan.steps, len(plan.configurations)
    width = max(q.shape[1] for q in plan.configurations)
    rows = np.zeros((steps + 1, n, width))
    for i, q in enumerate(plan.configurations):
        rows[:, i, : q.shape[1]] = q
    arrivals = np.array([round(arrival / plan.dt) for arrival in plan.arrivals])
    status = np.where(np.arange(steps + 1)[:, None] >= arrivals, PARKED, MOVING)
    arrays: Arrays = {"configurations": rows, "status": status}
    tails = {"actions": (1,), "hit_points": (3,)}
    for name in ARRAYS:
        if name not in INITIAL:
            arrays[name] = np.zeros((steps, n, *tails.get(name, ())))
    arrays["hits"] -= 1
    arrays["hit_robots"] -= 1
    arrays["clearances"] += np.inf
    about = {"policy": f"plan: {plan.method}", "seed": plan.seed, "dt": plan.dt, "names": {}}
    return Record(plan.scenario, {**about, "ended": "terminated", "actions": "none"}, arrays)
