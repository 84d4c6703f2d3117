"""Goals of ``fgenv bench planners``, with the measured values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from . import arm_run
from .rigid_run import Record
from .ways import CERTIFIED


def goals(done: Mapping[str, Sequence[Record]]) -> Record:
    """Each goal: `expected`, `measured`, and `at_most` where less is better. Seconds, and times."""
    found: Record = {}
    for record in done["problems"]:
        found |= _of_problem(record)
    certified = [record["ways"][CERTIFIED]["hidden"] for kind in done.values() for record in kind]
    if certified:
        found["hidden collisions"] = at_most(0, sum(certified))
    if done["mbm"]:
        own = arm_run.summed(done["mbm"])[CERTIFIED]
        found["mbm: share solved"] = {"expected": 0.99, "measured": own["solved"]}
        if own["median"] is not None:
            found["mbm: median, s"] = at_most(0.02, own["median"])
    return found


def _of_problem(record: Record) -> Record:
    name, ratio = record["problem"], record["ratio"]
    found: Record = {}
    if "solution" in ratio:
        expected = 10.0 if record["robots"] > 1 else 5.0
        title = f"{name}: first solution, ×FCL"
        found[title] = {"expected": expected, "measured": ratio["solution"]}
    if "check_all" in ratio:
        title = f"{name}: equal edges, ×FCL"
        found[title] = {"expected": 10.0, "measured": ratio["check_all"]}
        took = record["edges"]["all"]
        found[f"{name}: certified edge, µs"] = at_most(10.0, 1e6 * took["native"])
        plug_in = 1e6 * (took[CERTIFIED] - took["native"])
        found[f"{name}: plug-in, µs"] = at_most(1.0, plug_in)
    if "floor" in record:
        found[f"{name}: × OMPL's floor"] = at_most(2.0, record["floor"]["times"])
    return found


def at_most(expected: float, measured: float) -> Record:
    """A goal where less is better."""
    return {"expected": expected, "measured": measured, "at_most": True}
