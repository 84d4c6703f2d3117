"""A table on its way through a furnished home."""

from __future__ import annotations

import math
from typing import Annotated, Any

from pydantic import Field

from fgenv.scenarios.registry import Seed, builtin
from fgenv.scenarios.rng import Dice, micro
from fgenv.scenarios.scenario import Scenario
from fgenv.scenarios.schema import Body

from .placing import Q, bare, block, body, scatter, sent, team
from .quaternion import about, pose

LENGTH, WIDTH = 9.0, 7.0  # meters, of the home along x and y
TALL, THICK, LINTEL = 2.6, 0.12, 2.1  # meters, of walls; where a door ends
TABLE = {"kind": "table", "length": 1.1, "width": 0.95, "height": 0.72}
REACH = 1.03  # meters from the table's origin to its farthest point
BEFORE, BEHIND = ((-4.0, -0.8), (-3.0, -0.9)), ((0.7, 3.2), (0.7, 2.8))  # living room, bedroom
DOORS = {"kitchen": -1.0, "bedroom": 1.0, "study": -1.2, "back": 2.4}  # meters along their walls

SHAPES: dict[str, dict[str, Any]] = {
    "bed": block(2.0, 1.5, 0.5),
    "sofa": block(2.0, 0.8, 0.45),
    "wardrobe": block(0.6, 1.6, 2.1),
    "bookcase": block(0.35, 2.2, 2.0),
    "counter": block(2.4, 0.6, 0.9),
    "dining table": {"kind": "table", "length": 1.4, "width": 0.8, "height": 0.74},
    "chair": {"kind": "chair"},
}
FURNITURE = {  # x, y (m), yaw (rad)
    "bed": (3.45, 2.7, 0.0),
    "sofa": (-3.4, -3.0, 0.0),
    "wardrobe": (4.15, 0.95, 0.0),
    "bookcase": (4.3, -2.0, 0.0),
    "counter": (-3.2, 3.1, 0.0),
    "dining table": (-2.6, 1.6, 0.0),
    "chair": (-3.0, 0.8, math.pi / 2),
}
Door = Annotated[float, Field(ge=0.78, le=1.5, strict=True)]


@builtin(dimension=3, most=1, driven=False)
def home(seed: Seed = 0, door: Door = 0.85) -> Scenario:
    """A table has to be carried through a furnished home, turned on its side in every door.

    For planners: a body that turns any way has no drive.

    Args:
        seed: of start and goal.
        door: width of the doors, meters, 0.78 to 1.5; the table is 0.72 at its narrowest.
    """
    x, y = LENGTH / 2, WIDTH / 2
    shapes, walls = _walls(door)
    scenario = bare(
        "home",
        description="A table goes from living room to bedroom, by the study or the kitchen.",
        seed=seed,
        workspace={"low": (-x, -y, 0.0), "high": (x, y, micro(TALL - REACH))},  # not over walls
        shapes={"table": TABLE, **SHAPES, **shapes},
        models={"table": {"shape": "table", "base": "free"}},
        robots=team(1, "table", 7, goal_tolerance={"position": 0.05, "angle": 0.1}),
        bodies=[*walls, *(body(name, *at, name=name) for name, at in FURNITURE.items())],
    )
    dice = Dice(seed, 12)

    def place(room: tuple[tuple[float, float], tuple[float, float]]) -> Q:
        """Upright in a room, 2 cm over the floor."""
        u, v = (dice.between(*ends) for ends in room)
        return pose(u, v, 0.02, about(2, dice.between(-math.pi, math.pi)))

    starts = scatter(scenario, lambda _: place(BEFORE))
    return sent(scenario, starts, scatter(scenario, lambda _: place(BEHIND)))


def _walls(door: float) -> tuple[dict[str, Any], list[Body]]:
    """Floor, outer walls, and four rooms with four doors."""
    x, y, t, h = LENGTH / 2, WIDTH / 2, THICK, THICK / 2
    low, high = (side * door / 2 for side in (-1, 1))
    walls = {  # least and greatest x, y (m), bottom (m)
        "south": (-x - t, -y - t, x + t, -y, 0.0),
        "north": (-x - t, y, x + t, y + t, 0.0),
        "west": (-x - t, -y, -x, y, 0.0),
        "east": (x, -y, x + t, y, 0.0),
        "kitchen left": (-x, -h, DOORS["kitchen"] + low, h, 0.0),
        "kitchen right": (DOORS["kitchen"] + high, -h, -h, h, 0.0),
        "kitchen lintel": (DOORS["kitchen"] + low, -h, DOORS["kitchen"] + high, h, LINTEL),
        "bedroom left": (h, -h, DOORS["bedroom"] + low, h, 0.0),
        "bedroom right": (DOORS["bedroom"] + high, -h, x, h, 0.0),
        "bedroom lintel": (DOORS["bedroom"] + low, -h, DOORS["bedroom"] + high, h, LINTEL),
        "middle south": (-h, -y, h, DOORS["study"] + low, 0.0),
        "middle": (-h, DOORS["study"] + high, h, DOORS["back"] + low, 0.0),
        "middle north": (-h, DOORS["back"] + high, h, y, 0.0),
        "study lintel": (-h, DOORS["study"] + low, h, DOORS["study"] + high, LINTEL),
        "back lintel": (-h, DOORS["back"] + low, h, DOORS["back"] + high, LINTEL),
    }
    shapes: dict[str, Any] = {"floor": {"kind": "box", "size": (LENGTH, WIDTH, 0.1)}}
    bodies = [Body(name="floor", shape="floor", position=(0.0, 0.0, -0.05))]
    for name, (x0, y0, x1, y1, bottom) in walls.items():
        shapes[name] = block(x1 - x0, y1 - y0, TALL - bottom)
        at = micro((x0 + x1) / 2), micro((y0 + y1) / 2), bottom
        groups = ("glass",) if name in ("south", "west") else ()  # seen through in pictures
        bodies.append(Body(name=name, shape=name, position=at, groups=groups))
    return shapes, bodies
