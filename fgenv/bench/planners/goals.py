"""Goals of ``fgenv bench planners``, with the measured values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from fgenv.bench.common.records import Record, at_least, at_most

from .arm_run import family_statistics
from .methods import CERTIFIED


def goals(parts: Mapping[str, Sequence[Record]]) -> Record:
    """Return each goal with its measured value; times in seconds."""
    result = dict(goal for record in parts["problems"] for goal in _of_problem(record))
    hidden = [record["ways"][CERTIFIED]["hidden"] for part in parts.values() for record in part]
    if hidden:
        result["hidden collisions"] = at_most(0, sum(hidden))
    if parts["mbm"]:
        own = family_statistics(parts["mbm"])[CERTIFIED]
        result["mbm: share solved"] = at_least(0.99, own["solved"])
        if own["median"] is not None:
            result["mbm: median, s"] = at_most(0.02, own["median"])
    return result


def _of_problem(record: Record) -> Iterator[tuple[str, Record]]:
    name, ratio = record["problem"], record["ratio"]
    if "solution" in ratio:
        expected = 10.0 if record["robots"] > 1 else 5.0
        yield f"{name}: first solution, ×FCL", at_least(expected, ratio["solution"])
    if "check_all" in ratio:
        seconds = record["edges"]["all"]
        plug_in = seconds[CERTIFIED] - seconds["native"]
        yield f"{name}: equal edges, ×FCL", at_least(10.0, ratio["check_all"])
        yield f"{name}: certified edge, µs", at_most(10.0, 1e6 * seconds["native"])
        yield f"{name}: plug-in, µs", at_most(1.0, 1e6 * plug_in)
    if "floor" in record:
        yield f"{name}: × OMPL's floor", at_most(2.0, record["floor"]["times"])
