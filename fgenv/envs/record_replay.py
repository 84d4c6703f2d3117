"""Replay of records: run an episode again and compare every bit."""

from __future__ import annotations

import numpy as np

from fgenv import __version__
from fgenv.scenarios.hashes import urdf_hashes
from fgenv.scenarios.validation import file_faults

from .observations import Observation
from .record import INITIAL, Record, RecordError
from .recorder import RECORDED
from .simulator import Simulator

UNOBSERVED = Observation(velocity=False, lidar=False, neighbors=0)  # the cheapest observation


def replay(record: Record, threads: int | None = None) -> Simulator:
    """Run a record again with its actions, and verify that all arrays are equal, bit for bit.

    Returns:
        A simulator at the end of the episode.

    Raises:
        RecordError: a mesh or URDF file has changed, or a step differs; the error names the first.
    """
    check_files(record)
    simulator = Simulator(
        record.scenario,
        observation=UNOBSERVED,
        actions=record.about["actions"],
        way_point_seconds=record.about["way_point_seconds"],
        clearance=bool(np.isfinite(record["clearances"]).any()),
        autoreset=False,
        threads=threads,
    )
    simulator.reset(seed=record.about["seed"])
    compare(record, simulator, 0, INITIAL)
    for k, action in enumerate(record["actions"]):
        simulator.step(action[None])
        compare(record, simulator, k + 1, RECORDED)
    return simulator


def check_files(record: Record) -> None:
    """Raise RecordError if mesh or URDF files are missing or have changed since the recording."""
    for invalid in file_faults(record.scenario):
        raise RecordError(f"record: {invalid.problem}")
    for model, current in urdf_hashes(record.scenario).items():
        if current != record.about["urdf"].get(model):
            raise RecordError(
                f"record: the URDF file of {model!r} has changed; restore the recorded version"
            )


def compare(record: Record, simulator: Simulator, step: int, names: tuple[str, ...]) -> None:
    """Raise RecordError if the simulator's state differs from the record after a step."""
    for name in names:
        recorded = record[name][step - (name not in INITIAL)]
        current = getattr(simulator, name)[0].astype(recorded.dtype)
        rows = zip(record.names, current, recorded, strict=True)
        for robot in (robot for robot, a, b in rows if a.tobytes() != b.tobytes()):
            version = record.about["versions"]["fgenv"]
            raise RecordError(
                f"record: step {step}: {name} of {robot!r} differ from the recorded ones"
                f" (recorded by fgenv {version}, this is {__version__})"
            )
