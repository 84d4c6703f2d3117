"""Problems of MotionBenchMaker for the Franka Panda; their origin and license are in NOTICE."""

from __future__ import annotations

import tarfile
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from fgenv.robots import JointVelocity
from fgenv.scenarios.drive_specs import DriveSpec
from fgenv.scenarios.io.moveit import problem_of, scene_of
from fgenv.scenarios.io.yaml_node import Node
from fgenv.scenarios.registry import builtin
from fgenv.scenarios.scenario import Scenario
from fgenv.scenarios.schema import Model

FOLDER = Path(__file__).parent
HERE = "package://fgenv/scenarios/library/mbm"
PROBLEMS = 100  # of a family
ACCELERATION = 7.5  # rad/s^2, the lowest of the limits that Franka publishes, that of joint 2
Family = Literal[
    "bookshelf_small",
    "bookshelf_tall",
    "bookshelf_thin",
    "box",
    "cage",
    "table_pick",
    "table_under_pick",
]
Number = Annotated[int, Field(ge=1, le=PROBLEMS, strict=True)]


@builtin(dimension=3, most=1)
def mbm(family: Family = "bookshelf_small", problem: Number = 1) -> Scenario:
    """A Panda arm reaches into shelves, boxes, a cage: 700 problems of MotionBenchMaker, URDF.

    The fingers are fixed, open; the seven joints of the arm are planned for. On the exact meshes
    all starts and goals are free, and 29 of the 700 straight motions. Needs the extra urdf.

    Args:
        family: bookshelf_small, bookshelf_tall, bookshelf_thin, box, cage, table_pick or
            table_under_pick.
        problem: 1 to 100.
    """
    scene, request = (_file(family, f"{what}{problem:04}.yaml") for what in ("scene", "request"))
    drive = DriveSpec.of(JointVelocity(acceleration=ACCELERATION))
    arm = Model(urdf=f"{HERE}/panda.urdf", srdf=f"{HERE}/panda.srdf", drive=drive)
    objects = replace(scene_of(scene), matrix=None)  # the pairs of the SRDF, which lists more
    scenario = problem_of(objects, request, arm, "mbm")
    told = f"MotionBenchMaker: {family}, problem {problem}; a Panda reaches its goal."
    return scenario.replace(description=told)


def _file(family: str, name: str) -> Node:
    """The top of a file in the archive."""
    inside = f"problems/{family}_panda/{name}"
    return Node.parsed(_archive()[inside].decode(), f"{FOLDER.name}/{inside}")


@cache
def _archive() -> dict[str, bytes]:
    """All files in the archive by their names; 3 MB."""
    with tarfile.open(FOLDER / "problems.tar.bz2") as archive:
        files = ((item.name, archive.extractfile(item)) for item in archive)
        return {name: file.read() for name, file in files if file is not None}
