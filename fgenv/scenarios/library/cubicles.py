"""A two-storey office of cubicles, and an L-shaped body on its way through."""

from __future__ import annotations

import math
from typing import Annotated, Any

from pydantic import Field

from fgenv.scenarios.registry import Seed, builtin
from fgenv.scenarios.rng import Dice, micro
from fgenv.scenarios.scenario import Scenario
from fgenv.scenarios.schema import Body

from .maze import Boxes, Corner, Wall, around_window, beside_door, opened, walls
from .placing import Q, bare, scatter, sent, team
from .quaternion import about, pose

COLUMNS, ROWS, CELL = 3, 2, 2.6  # cubicles of a storey along x and y, meters of each
X, Y = COLUMNS * CELL / 2, ROWS * CELL / 2  # meters, half of the office
TALL, THICK = 2.5, 0.1  # meters: from floor to floor; of floors and walls
DOOR, WINDOW, SILL = 1.2, (1.0, 0.9), 0.8  # meters: widths, height, and height over the floor
MOVER = {"kind": "l", "length": 1.2, "width": 0.9, "arm": 0.25, "height": 0.25}
REACH = 0.8  # meters from the mover's origin to its farthest point
SEEN_THROUGH = ("west", "east", "south", "north", "storey")  # in pictures


@builtin(dimension=3, most=2, driven=False)
def cubicles(
    n: Annotated[int, Field(ge=1, le=2, strict=True)] = 1, seed: Seed = 0, layout: Seed = 0
) -> Scenario:
    """An L-shaped body goes through doors and windows to the other storey of an office.

    For planners: a body that turns any way has no drive.

    Args:
        n: bodies; two swap places.
        seed: of starts and goals.
        layout: seed of doors, windows, and the hole between the storeys.
    """
    dice = Dice(seed, 13)
    shapes, bodies = _office(Dice(layout, 14))
    top = micro(2 * TALL - THICK - REACH)  # no way leads over the walls
    scenario = bare(
        "cubicles",
        description=f"{n} L-shaped bodies go from one storey of an office to the other.",
        seed=seed,
        workspace={"low": (micro(-X), micro(-Y), 0.0), "high": (micro(X), micro(Y), top)},
        shapes={"mover": MOVER, **shapes},
        models={"mover": {"shape": "mover", "base": "free"}},
        robots=team(2, "mover", 7, goal_tolerance={"position": 0.05, "angle": 0.1}),
        bodies=bodies,
    )

    def place(storey: int) -> Q:
        """Level, in the first column of a storey."""
        x, y = dice.between(-X, CELL - X), dice.between(-Y, Y)
        z = storey * TALL + dice.between(0.1, 1.2)
        return pose(x, y, z, about(2, dice.between(-math.pi, math.pi)))

    ends = scatter(scenario, place, margin=0.05)
    few = scenario.model_copy(update={"robots": scenario.robots[:n]})
    return sent(few, ends[:n], ends[::-1][:n])


def _office(dice: Dice) -> tuple[dict[str, Any], list[Body]]:
    """All that stands: shapes by their sizes, and bodies."""
    boxes = _shell(dice.below(ROWS))
    for storey in (0, 1):
        doors = opened(COLUMNS, ROWS, dice)
        window = dice.pick([wall for wall in walls(COLUMNS, ROWS) if wall not in doors])
        for wall in walls(COLUMNS, ROWS):
            (low, high), along = _wall(wall, storey), 1 - wall[2]
            parts: Boxes = {"": (low, high)}
            if wall in doors:
                parts = beside_door(low, high, along, DOOR, dice)
            elif wall == window:
                parts = around_window(low, high, along, WINDOW, SILL)
            label = f"wall {storey}{wall[0]}{wall[1]}{'xy'[wall[2]]}"
            boxes |= {label + part: ends for part, ends in parts.items()}
    shapes, bodies = {}, []
    for name, (low, high) in boxes.items():
        size = [micro(b - a) for a, b in zip(low, high, strict=True)]
        x, y, z = (micro((a + b) / 2) for a, b in zip(low, high, strict=True))
        kind = " x ".join(f"{s:g}" for s in size)
        shapes[kind] = {"kind": "box", "size": size}
        groups = ("glass",) if name.split()[0] in SEEN_THROUGH else ()
        bodies.append(Body(name=name, shape=kind, position=(x, y, z), groups=groups))
    return shapes, bodies


def _shell(hole: int) -> Boxes:
    """Floor, outer walls, and the upper floor with a hole in the last column, in either row."""
    t, top = THICK, 2 * TALL - THICK
    last, side = X - CELL, (-Y, 0.0) if hole else (0.0, Y)
    return {
        "floor": ((-X - t, -Y - t, -t), (X + t, Y + t, 0.0)),
        "west": ((-X - t, -Y, 0.0), (-X, Y, top)),
        "east": ((X, -Y, 0.0), (X + t, Y, top)),
        "south": ((-X - t, -Y - t, 0.0), (X + t, -Y, top)),
        "north": ((-X - t, Y, 0.0), (X + t, Y + t, top)),
        "storey": ((-X, -Y, TALL - t), (last, Y, TALL)),
        "storey beside": ((last, side[0], TALL - t), (X, side[1], TALL)),
    }


def _wall(wall: Wall, storey: int) -> tuple[Corner, Corner]:
    """Corners of a wall between two cubicles, meters."""
    i, j, axis = wall
    x, y, z, half = i * CELL - X, j * CELL - Y, storey * TALL, THICK / 2
    top = z + TALL - THICK
    if axis == 0:
        return (x + CELL - half, y, z), (x + CELL + half, y + CELL, top)
    return (x, y + CELL - half, z), (x + CELL, y + CELL + half, top)
