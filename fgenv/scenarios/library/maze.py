"""Walls between the cells of a grid, some with a door or a window, as boxes from corner to corner.

A wall is (i, j, axis): between cell i, j and the next along x or y (axis 0 or 1).
"""

from __future__ import annotations

from fgenv.scenarios.rng import Dice

Wall = tuple[int, int, int]
Corner = tuple[float, float, float]  # meters
Boxes = dict[str, tuple[Corner, Corner]]  # by name: least and greatest x, y, z


def walls(columns: int, rows: int) -> list[Wall]:
    """All walls inside a grid."""
    across = [(i, j, 0) for i in range(columns - 1) for j in range(rows)]
    return across + [(i, j, 1) for i in range(columns) for j in range(rows - 1)]


def opened(columns: int, rows: int, dice: Dice) -> list[Wall]:
    """Walls that get a door, so that one way leads from any cell to any other (Kruskal 1956)."""
    group = {(i, j): (i, j) for i in range(columns) for j in range(rows)}
    found = []
    for i, j, axis in dice.shuffled(walls(columns, rows)):
        here, there = group[i, j], group[i + (axis == 0), j + (axis == 1)]
        if here != there:
            found.append((i, j, axis))
            group = {cell: here if g == there else g for cell, g in group.items()}
    return found


def beside_door(low: Corner, high: Corner, along: int, door: float, dice: Dice) -> Boxes:
    """The rest of a wall along axis 0 or 1 beside a door at either end."""
    first, last = list(low), list(high)
    if dice.below(2):
        first[along] += door
    else:
        last[along] -= door
    return {"": (_corner(first), _corner(last))}


def around_window(
    low: Corner, high: Corner, along: int, window: tuple[float, float], sill: float
) -> Boxes:
    """A wall along axis 0 or 1 around a window (width, height) in its middle, over a sill."""
    middle = 0.5 * (low[along] + high[along])
    a, b = middle - window[0] / 2, middle + window[0] / 2
    bottom, top = low[2] + sill, low[2] + sill + window[1]
    return {
        " below": (low, (high[0], high[1], bottom)),
        " above": ((low[0], low[1], top), high),
        " left": (_with(low, along, low[along], bottom), _with(high, along, a, top)),
        " right": (_with(low, along, b, bottom), _with(high, along, high[along], top)),
    }


def _with(corner: Corner, along: int, value: float, z: float) -> Corner:
    """A corner with other numbers along one axis and z."""
    other = [*corner[:2], z]
    other[along] = value
    return _corner(other)


def _corner(values: list[float]) -> Corner:
    x, y, z = values
    return x, y, z
