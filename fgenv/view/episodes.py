"""What can be looked at again: records of episodes, and plans as if they had been driven."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fgenv.envs import Record
from fgenv.envs.record import ARRAYS, INITIAL, Arrays

if TYPE_CHECKING:
    from fgenv.planners import Plan

MOVING, PARKED, GONE = 0, 1, 2  # of a record's status


def load_episode(path: str | Path) -> Record:
    """The record in a file; of a plan file one as if the plan had been driven exactly.

    Raises:
        RecordError, PlanError: neither, damaged, or of another version.
        FileNotFoundError: no such file.
    """
    if format_of(Path(path)).startswith("fgenv plan "):
        from fgenv.planners import Plan

        return driven(Plan.load(path))
    return Record.load(path)


def format_of(path: Path) -> str:
    """What a file says that it is; empty where it says nothing."""
    try:
        with np.load(path, allow_pickle=False) as file:
            return str(file["format"])
    except (FileNotFoundError, IsADirectoryError, PermissionError):
        raise
    except Exception:  # zip, zlib and NumPy each have their own; the loader says what is wrong
        return ""


def driven(plan: Plan) -> Record:
    """A record of a plan's steps: nobody meets anybody, clearances are not measured.

    It has no actions, so `Record.replay` refuses it.
    """
    steps, n = plan.steps, len(plan.configurations)
    wide = max(q.shape[1] for q in plan.configurations)
    rows = np.zeros((steps + 1, n, wide))
    for i, q in enumerate(plan.configurations):
        rows[:, i, : q.shape[1]] = q
    there = np.array([round(arrival / plan.dt) for arrival in plan.arrivals])
    status = np.where(np.arange(steps + 1)[:, None] >= there, PARKED, MOVING)
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
