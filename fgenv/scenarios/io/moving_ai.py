"""Maps (.map) and scenarios (.scen) of the MovingAI benchmarks, as walls and disc robots.

N. Sturtevant: Benchmarks for grid-based pathfinding. IEEE Transactions on Computational
Intelligence and AI in Games 4 (2), 2012.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from fgenv.scenarios.errors import cut
from fgenv.scenarios.registry import Meters, file_format
from fgenv.scenarios.scenario import Scenario
from fgenv.scenarios.schema import Model, RobotSpec, Tolerance
from fgenv.scenarios.shapes.bodies import Disc
from fgenv.scenarios.shapes.boxes import boxes_of_cells

from .grids import MAX_CELLS, count_in, fail, file_error, number_in, read_lines, scenario_of_boxes

PASSABLE, BLOCKED = ".GS", "@OTW"  # water may be crossed only from water
Count = Annotated[int, Field(ge=1, le=10_000, strict=True)]
Place = Annotated[int, Field(ge=0, le=10_000_000, strict=True)]
Share = Annotated[float, Field(gt=0, le=0.45, strict=True, allow_inf_nan=False)]


@file_format("MovingAI map", ".map")
def moving_ai_map(path: Path, cell: Meters = 1.0, height: Meters = 1.0) -> Scenario:
    """Walls of a map: the cells `@`, `O`, `T` and `W`; x is the column, y runs up.

    Args:
        cell: edge of a cell (m).
        height: of the walls, which stand on z = 0 (m).

    Raises:
        ScenarioError: the problem with its line.
    """
    cells = read_map(path)
    flat = boxes_of_cells(cells[::-1].T).astype(np.float64) * cell
    zeros = np.zeros(len(flat))
    boxes = np.column_stack([flat[:, :2], zeros, flat[:, 2:], zeros + height])
    rows, columns = cells.shape
    return scenario_of_boxes(
        path,
        boxes,
        "walls",
        description=f"Map of {columns} x {rows} cells of {cell:g} m.",
        workspace=((0.0, 0.0), (columns * cell, rows * cell)),
    )


@file_format("MovingAI scenario", ".scen")
def moving_ai_scenario(
    path: Path,
    n: Count = 1,
    first: Place = 0,
    cell: Meters = 1.0,
    height: Meters = 1.0,
    radius: Share = 0.3,
) -> Scenario:
    """Robots of a scenario's rows, from cell to cell, among the walls of its map.

    The map is searched at its path from the scenario's folder, then in that folder.

    Args:
        n: number of robots.
        first: row of the first robot, from 0.
        cell, height: see `moving_ai_map`.
        radius: of the discs, in cells.

    Raises:
        ScenarioError: the problem with its line.
        FileNotFoundError: no such map.
    """
    lines = read_lines(path)
    rows = [(i + 1, line.split()) for i, line in enumerate(lines) if line.strip()]
    if not rows or rows[0][1][0] != "version":
        fail(path, "has no version", "expected 'version 1' in the first line", 1)
    if rows[0][1][1:] not in (["1"], ["1.0"]):
        fail(path, f"has version {cut(' '.join(rows[0][1][1:]), 30)}", "expected 1", 1)
    chosen = rows[1 + first : 1 + first + n]
    if len(chosen) < n:
        fail(path, f"has {len(rows) - 1} rows", f"expected {first + n}: choose first and n")
    file = map_file(path, chosen[0][1][1] if len(chosen[0][1]) > 1 else "", chosen[0][0])
    walls = moving_ai_map(file, cell, height)
    cells = read_map(file)
    robots = tuple(
        robot_of(path, i, line, words, cells, chosen[0][1][1], cell)
        for i, (line, words) in enumerate(chosen)
    )
    return walls.replace(
        name=path.stem[:100] or "scenario",
        shapes={**walls.shapes, "disc": Disc(kind="disc", radius=radius * cell)},
        models={"disc": Model(shape="disc")},
        robots=robots,
    )


def robot_of(
    path: Path,
    i: int,
    line: int,
    words: list[str],
    cells: NDArray[np.bool_],
    map_name: str,
    cell: float,
) -> RobotSpec:
    """The robot of a row: bucket, map, width, height, start x, y, goal x, y, optimal length."""
    if len(words) != 9:
        fail(path, f"has {len(words)} values", "expected 9", line)
    if words[1] != map_name:
        fail(path, "is on another map than the first row", "choose rows of one map", line)
    width, height, *ends = (count_in(path, word, line) for word in words[2:8])
    count_in(path, words[0], line)
    number_in(path, words[8], line, 1e9)
    if (height, width) != cells.shape:
        text = f"is for a map of {width} x {height} cells, which has {cells.shape[::-1]}"
        fail(path, text, "scaled maps are not supported", line)
    places = []
    for x, y in (ends[:2], ends[2:]):
        if not (x < width and y < height) or cells[y, x]:
            fail(path, f"has an end at {x}, {y}", "expected a free cell of the map", line)
        places.append(((x + 0.5) * cell, (height - y - 0.5) * cell, 0.0))
    tolerance = Tolerance(position=0.1 * cell, angle=10.0)  # a disc has no heading
    return RobotSpec(
        name=f"robot {i + 1}", model="disc", start=places[0], goal=places[1],
        goal_tolerance=tolerance,
    )  # fmt: skip


def map_file(path: Path, name: str, line: int) -> Path:
    """The map of a scenario."""
    relative = Path(name.replace("\\", "/"))
    places = [path.parent / relative, path.parent / relative.name]
    for place in places:
        if name and place.is_file():
            return place
    raise file_error(
        path, f"its map {cut(name, 60)!r} does not exist", "put it beside the scenario", line
    )


def read_map(path: Path) -> NDArray[np.bool_]:
    """Whether each cell is blocked, (rows, columns) from the top."""
    lines = read_lines(path)
    head: dict[str, str] = {}
    for i, line in enumerate(lines[:4]):
        key, _, value = line.strip().partition(" ")
        expected = ("type", "height", "width", "map")[i]
        if key != expected:
            fail(path, f"got {cut(line, 40)!r}", f"expected {expected}", i + 1)
        head[key] = value.strip()
    if len(head) < 4:
        fail(path, "has no header", "expected type, height, width and map, a line each", 1)
    rows = count_in(path, head["height"], 2)
    columns = count_in(path, head["width"], 3)
    if not 0 < rows * columns <= MAX_CELLS:
        fail(path, f"has {columns} x {rows} cells", f"expected 1 to {MAX_CELLS}", 2)
    body = lines[4:]
    while body and not body[-1].strip():
        body.pop()
    if len(body) != rows:
        fail(path, f"has {len(body)} rows", f"expected {rows}, its height", min(len(lines), 5))
    for i, line in enumerate(body):
        if len(line) != columns:
            fail(path, f"has {len(line)} cells", f"expected {columns}, the map's width", i + 5)
        if wrong := set(line) - set(PASSABLE + BLOCKED):
            text = f"got {sorted(wrong)[0]!r}"
            fail(path, text, f"expected cells of {PASSABLE}{BLOCKED}", i + 5)
    codes = np.frombuffer("".join(body).encode("ascii"), dtype=np.uint8).reshape(rows, columns)
    return np.isin(codes, np.frombuffer(BLOCKED.encode(), dtype=np.uint8))
