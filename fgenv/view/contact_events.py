"""Who met whom in an episode, when and where."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fgenv.envs import Record


@dataclass(frozen=True)
class Meeting:
    """A robot in contact with something in one step after the other; told once of two robots.

    Attributes:
        begin, end: seconds.
        point: of the first contact, world, meters.
    """

    robot: int
    begin: float
    end: float
    text: str
    point: tuple[float, float, float]


def meetings(record: Record) -> list[Meeting]:
    """Who met whom, when and where, in the order of time."""
    hits, robots, names = record["hits"], record["hit_robots"], record.about["names"]
    found = []
    for i, name in enumerate(record.names):
        for k, last in runs(hits[:, i]):
            at, other = int(robots[k, i]), int(hits[k, i])
            begin = k * record.dt + float(record["hit_times"][k, i])
            if 0 <= at < i and is_met_by(record, k, at, i):
                continue  # told of the other one
            whom = record.names[at] if at >= 0 else names.get(str(other), f"body {other}")
            x, y, z = record["hit_points"][k, i].tolist()
            text = f"{name} meets {whom}"
            found.append(Meeting(i, begin, (last + 1) * record.dt, text, (x, y, z)))
    return sorted(found, key=lambda meeting: meeting.begin)


def is_met_by(record: Record, step: int, robot: int, other: int) -> bool:
    """Whether in a step a robot begins to meet another one."""
    met = record["hit_robots"][:, robot]
    return bool(met[step] == other and (step == 0 or met[step - 1] != other))


def runs(hits: np.ndarray[tuple[int, ...], np.dtype[np.int32]]) -> Iterator[tuple[int, int]]:
    """First and last step (both met) of each stretch in which the same body was met."""
    ends = [*np.flatnonzero(np.diff(hits)).tolist(), len(hits) - 1]
    begin = 0
    for end in ends if len(hits) else []:
        if hits[begin] >= 0:
            yield begin, end
        begin = end + 1
