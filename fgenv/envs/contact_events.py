"""Contacts of a recorded episode as events: bodies, time and point."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fgenv.arrays import Ints32
from fgenv.envs import Record


@dataclass(frozen=True)
class ContactEvent:
    """A robot in contact with the same body over consecutive steps.

    A contact between two robots is one event, of the robot with the lower index.

    Attributes:
        begin, end: seconds.
        text: names of both bodies.
        point: of the first contact, world frame, meters.
    """

    robot: int
    begin: float
    end: float
    text: str
    point: tuple[float, float, float]


def contact_events(record: Record) -> list[ContactEvent]:
    """Return all contacts of a record in chronological order."""
    hits, robots, names = record["hits"], record["hit_robots"], record.about["names"]
    events = []
    for i, name in enumerate(record.names):
        for first, last in runs(hits[:, i]):
            other, body = int(robots[first, i]), int(hits[first, i])
            if 0 <= other < i and begins_contact(record, first, other, i):
                continue  # the event belongs to the other robot
            begin = first * record.dt + float(record["hit_times"][first, i])
            partner = record.names[other] if other >= 0 else names.get(str(body), f"body {body}")
            x, y, z = record["hit_points"][first, i].tolist()
            end, text = (last + 1) * record.dt, f"{name} meets {partner}"
            events.append(ContactEvent(i, begin, end, text, (x, y, z)))
    return sorted(events, key=lambda event: event.begin)


def begins_contact(record: Record, step: int, robot: int, other: int) -> bool:
    """Return whether a robot begins to touch another robot in a step."""
    partners = record["hit_robots"][:, robot]
    return bool(partners[step] == other and (step == 0 or partners[step - 1] != other))


def runs(hits: Ints32) -> Iterator[tuple[int, int]]:
    """Yield the first and last step of each run of contacts with the same body."""
    ends = [*np.flatnonzero(np.diff(hits)).tolist(), len(hits) - 1]
    begin = 0
    for end in ends if len(hits) else []:
        if hits[begin] >= 0:
            yield begin, end
        begin = end + 1
