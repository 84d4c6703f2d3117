"""Occupied cells of maps, octrees and point clouds as one body of a scenario."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from fgenv.scenarios.errors import Problem, ScenarioError, cut
from fgenv.scenarios.scenario import Scenario
from fgenv.scenarios.schema import Body, Workspace
from fgenv.scenarios.shapes.base import LONGEST
from fgenv.scenarios.shapes.bodies import AnyForm
from fgenv.scenarios.shapes.boxes import MAX_BOXES, Boxes

MAX_CELLS = 1 << 26  # of a map, 8192 x 8192


def fail(path: Path, text: str, remedy: str, line: int | None = None) -> NoReturn:
    """Raise a ScenarioError about a file."""
    raise file_error(path, text, remedy, line)


def file_error(path: Path, text: str, remedy: str, line: int | None = None) -> ScenarioError:
    """The error about a file."""
    return ScenarioError(path, [Problem(text, remedy, line=line)])


def read_bytes(path: Path, most: int = 1 << 30) -> bytes:
    """The content of a regular file of bounded size (bytes).

    Raises:
        ScenarioError: not a regular file, or too large.
        FileNotFoundError: no such file.
    """
    if path.exists() and not path.is_file():
        fail(path, "is no regular file", "expected a file")
    if path.stat().st_size > most:
        fail(path, f"has {path.stat().st_size} bytes", f"expected at most {most}")
    return path.read_bytes()


def read_lines(path: Path, most: int = 1 << 28) -> list[str]:
    """The lines of a text file, UTF-8."""
    try:
        return read_bytes(path, most).decode("utf-8").splitlines()
    except UnicodeDecodeError:
        fail(path, "is no text", "expected UTF-8")


def number_in(path: Path, text: str, line: int, most: float = 1e6) -> float:
    """The finite number of a text of up to a magnitude."""
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not abs(value) <= most or "_" in text:
        fail(path, f"got {cut(text, 40)!r}", f"expected a number up to {most:g}", line)
    return value


def count_in(path: Path, text: str, line: int, most: int = MAX_CELLS) -> int:
    """The whole number, from 0, of a text."""
    if not (text.isascii() and text.isdigit() and len(text) < 12 and int(text) <= most):
        fail(path, f"got {cut(text, 40)!r}", f"expected a whole number up to {most}", line)
    return int(text)


def body_of_boxes(
    path: Path, boxes: NDArray[np.floating[Any]], name: str, **placement: Any
) -> tuple[dict[str, AnyForm], tuple[Body, ...]]:
    """Shapes and bodies for boxes (n, 6), lower then upper corners (m); none for no boxes."""
    if not len(boxes):
        return {}, ()
    if len(boxes) > MAX_BOXES:
        fail(path, f"has {len(boxes)} boxes", f"expected at most {MAX_BOXES}: use larger cells")
    if float(np.abs(boxes).max()) > LONGEST:
        fail(path, f"goes beyond {LONGEST:g} m", "use another unit or a smaller map")
    shape = Boxes(kind="boxes", boxes=tuple(map(tuple, boxes.tolist())))
    return {name: shape}, (Body(name=name, shape=name, **placement),)


def scenario_of_boxes(
    path: Path,
    boxes: NDArray[np.floating[Any]],
    name: str,
    *,
    description: str,
    workspace: Sequence[Sequence[float]] | None = None,
    **placement: Any,
) -> Scenario:
    """A scenario without robots, of one body."""
    shapes, bodies = body_of_boxes(path, boxes, name, **placement)
    space = None
    if workspace is not None:
        space = Workspace(low=tuple(workspace[0]), high=tuple(workspace[1]))
    made = Scenario(
        version=1,
        name=path.stem[:100] or "map",
        description=description,
        workspace=space,
        shapes=shapes,
        bodies=bodies,
    )
    return made.at(path.parent)
