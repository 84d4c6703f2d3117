"""Running a record again, and comparing each bit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fgenv import __version__
from fgenv.scenarios.hashes import urdf_hashes
from fgenv.scenarios.validation import files

from .observations import Observation
from .recorder import SEEN
from .simulator import Simulator

if TYPE_CHECKING:
    from .record import Record

BLIND = Observation(velocity=False, lidar=False, neighbors=0)  # nobody looks: less to work out


def replayed(record: Record, threads: int | None) -> Simulator:
    """See `Record.replay`."""
    check_files(record)
    simulator = Simulator(
        record.scenario,
        observation=BLIND,
        actions=record.about["actions"],
        way_point_seconds=record.about["way_point_seconds"],
        clearance=bool(np.isfinite(record["clearances"]).any()),
        autoreset=False,
        threads=threads,
    )
    simulator.reset(seed=record.about["seed"])
    compare(record, simulator, 0, ("configurations", "status"))
    for k, action in enumerate(record["actions"]):
        simulator.step(action[None])
        compare(record, simulator, k + 1, SEEN)
    return simulator


def check_files(record: Record) -> None:
    """RecordError where mesh or URDF files are missing, or others than when it was recorded."""
    from .record import RecordError

    for found in files(record.scenario):
        raise RecordError(f"record: {found.problem}")
    for model, found_hash in urdf_hashes(record.scenario).items():
        if found_hash != record.about["urdf"].get(model):
            raise RecordError(
                f"record: the URDF file of {model!r} is another one; get the one it was made with"
            )


def compare(record: Record, simulator: Simulator, step: int, names: tuple[str, ...]) -> None:
    """RecordError where the simulator is not where the record says after a step."""
    from .record import BEFORE, RecordError

    for name in names:
        found, said = getattr(simulator, name)[0], record[name][step - (name not in BEFORE)]
        pairs = zip(record.names, found.astype(said.dtype), said, strict=True)
        for robot in (robot for robot, a, b in pairs if a.tobytes() != b.tobytes()):
            made = record.about["versions"]["fgenv"]
            raise RecordError(
                f"record: step {step}: {name} of {robot!r} come out otherwise"
                f" (recorded by fgenv {made}, this is {__version__})"
            )
