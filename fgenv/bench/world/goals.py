"""Goals of ``fgenv bench world``, with the measured values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from fgenv.bench.common.records import Record, at_least, at_most
from fgenv.bench.world.steps import growth

Goals = Iterator[tuple[str, Record]]


def goals(parts: Mapping[str, Sequence[Record]]) -> Record:
    """Return each goal with its measured value."""
    return {
        **dict(_of_steps(parts["steps"])),
        **dict(_of_growth(parts["steps"])),
        **dict(_of_movers(parts["movers"])),
        **{
            f"two threads, {job}": at_least(1.7, speed_up)
            for record in parts["threads"]
            for job, speed_up in record.items()
        },
        **dict(_of_motions(parts["motions"])),
    }


def _of_steps(records: Sequence[Record]) -> Goals:
    for row in records:
        peers = row["peers"]
        if row["bodies"] in (100, 1000) and "step" in peers.get("python-fcl", {}):
            speed_up = peers["python-fcl"]["step"] / peers["fgenv"]["step"]
            yield f"×FCL, {row['bodies']} bodies of {row['triangles']}", at_least(10.0, speed_up)


def _of_growth(records: Sequence[Record]) -> Goals:
    for triangles in dict.fromkeys(row["triangles"] for row in records):
        if grown := growth([row for row in records if row["triangles"] == triangles]):
            name = f"growth, {grown['from']} to {grown['to']} bodies of {triangles}"
            yield name, at_most(grown["n_log_n"], grown["times"])


def _of_movers(records: Sequence[Record]) -> Goals:
    for record in records:
        few, many = (record["rows"][k]["bodies"] for k in (0, -1))
        for job in ("collides", "check_motion"):
            name = f"{job}, {many} against {few} of {record['triangles']}"
            yield name, at_most(2.0, record["growth"][job])


def _of_motions(records: Sequence[Record]) -> Goals:
    for record in records:
        certified, discrete = (record["ways"][k]["free"] for k in ("continuous", "discrete 1 cm"))
        if certified and discrete:
            yield f"continuous / discrete, {record['name']}", at_most(1.0, certified / discrete)
