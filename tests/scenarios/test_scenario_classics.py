"""The classics for planners of free rigid bodies: sizes, free ends, no straight way."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import trimesh
from pydantic import TypeAdapter

from fgenv.scenarios import Built, Scenario, frozen
from fgenv.scenarios.library import ENTRIES, maze
from fgenv.scenarios.rng import Dice
from fgenv.scenarios.shapes.bodies import AnyForm
from fgenv.scenarios.yaml_io import dump

TRIANGLES = {  # triangles of the obstacles, and of the robot
    "cubicles": (324, 20),
    "twist": (120, 100),
    "home": (384, 60),
    "bug_trap": (800, 60),
    "rings": (460, 460),
}
GOLDEN = {
    "cubicles": "e36b406353995b44",
    "twist": "9456b047f49de115",
    "home": "ed25ec50c21386e2",
    "bug_trap": "6d89d1f86da69c8b",
    "rings": "d10b622ebb36136b",
}
WAYS: list[tuple[str, dict[str, Any]]] = [
    *((name, {}) for name in TRIANGLES),
    ("cubicles", {"n": 2, "layout": 4}),
    ("cubicles", {"layout": 5}),
    ("twist", {"clear": 0.1}),
    ("home", {"door": 1.2}),
    ("bug_trap", {"throat": 0.2}),
    ("rings", {"gap": 0.3}),
]
IDS = [f"{name}-{'-'.join(map(str, ways.values()))}" for name, ways in WAYS]


def form(**sizes: Any) -> trimesh.Trimesh:
    """The mesh of a kind of shape."""
    adapter: TypeAdapter[Any] = TypeAdapter(AnyForm)
    shape = adapter.validate_python(sizes).shape()
    return trimesh.Trimesh(shape.vertices, shape.faces, process=False)


@pytest.mark.parametrize(("name", "ways"), WAYS, ids=IDS)
@pytest.mark.parametrize("seed", [0, 1, 7])
def test_ends_are_free_and_the_straight_way_is_not(
    name: str, ways: dict[str, Any], seed: int
) -> None:
    scenario = Scenario.load(name, seed=seed, **ways)
    assert scenario.problems() == ()
    assert scenario.dimension == ENTRIES[name].dimension == 3
    built = scenario.build()
    assert len(built.robots) == ways.get("n", 1)
    for i, robot in enumerate(built.robots):
        assert robot.base == "free"
        assert robot.workspace is not None
        assert np.isfinite(robot.workspace).all()
        alone = built.world(robots=False)
        mover = built.add_robot(alone, i, built.starts[i])
        motion = alone.check_motion(mover, built.starts[i], built.goals[i])
        assert not motion.free
        assert np.isfinite(motion.contact_by)


@pytest.mark.parametrize("name", TRIANGLES)
def test_triangles(name: str) -> None:
    built = Scenario.load(name).build()
    stand = sum(len(shape.faces) for shape in built.shapes)
    assert (stand, len(built.robots[0].parts[0].shape.faces)) == TRIANGLES[name]


@pytest.mark.parametrize("name", TRIANGLES)
def test_same_seed_same_bits_and_another_seed_another(name: str) -> None:
    one, same, other = (Scenario.load(name, seed=seed) for seed in (3, 3, 4))
    assert dump(one) == dump(same)
    assert one.robots != other.robots
    assert frozen(name, cases=3, seed=0).id[:16] == GOLDEN[name]


@pytest.mark.parametrize(
    ("name", "ways", "told"),
    [
        ("cubicles", {"n": 3}, "n: is 3"),
        ("twist", {"clear": 0.001}, "clear: is 0.001"),
        ("home", {"door": 0.5}, "door: is 0.5"),
        ("bug_trap", {"throat": 0.6}, "throat: is 0.6"),
        ("rings", {"gap": 0.01}, "gap: is 0.01"),
        ("rings", {"n": 2}, "n: is no known override"),
    ],
)
def test_what_cannot_be_made_is_one_clear_error(name: str, ways: dict[str, Any], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        Scenario.load(name, **ways)


@pytest.mark.parametrize(
    "sizes",
    [
        {"kind": "cone", "radius": 0.3, "height": 0.5},
        {"kind": "twisted_bar", "length": 1.0, "width": 0.4, "height": 0.1, "turn": -1.5},
        *(
            {"kind": "twisted_wall", "thickness": 0.5, "side": 2.0, "width": 0.8, "height": 0.3,
             "turn": turn}
            for turn in (-3.1, -1.6, -0.7, 0.0, 0.7, 1.6, 3.1)
        ),
        {"kind": "bug_trap", "radius": 1.0, "wall": 0.05, "throat": 0.1},
        {"kind": "bug_trap", "radius": 1.0, "wall": 0.03, "throat": 0.4},
        {"kind": "open_ring", "radius": 0.5, "thickness": 0.1, "turn": 3.0},
        {"kind": "open_ring", "radius": 0.5, "thickness": 0.1, "turn": 7.0, "rise": 0.2},
    ],
    ids=lambda sizes: f"{sizes['kind']} {sizes.get('turn', '')}",
)  # fmt: skip
def test_shapes_are_one_closed_shell_that_looks_out(sizes: dict[str, Any]) -> None:
    mesh = form(**sizes)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.body_count == 1
    assert mesh.volume > 0
    igl = pytest.importorskip("igl.copyleft.cgal")
    *_, pairs = igl.remesh_self_intersections(np.array(mesh.vertices), np.array(mesh.faces))[:3]
    assert len(pairs) == 0


@pytest.mark.parametrize(
    ("sizes", "told"),
    [
        ({"kind": "chair", "seat": 1.0}, "seat: got 1, expected less than the height"),
        ({"kind": "bug_trap", "radius": 1.0, "wall": 0.3, "throat": 0.3}, "throat: 0.3"),
        ({"kind": "bug_trap", "radius": 1.0, "wall": 0.01, "throat": 0.3}, "wall: got 0.01"),
        ({"kind": "open_ring", "radius": 0.1, "thickness": 0.2, "turn": 3.0}, "thickness: got 0.2"),
        ({"kind": "open_ring", "radius": 1.0, "thickness": 0.2, "turn": 7.0}, "rise: expected"),
        (
            {"kind": "twisted_wall", "thickness": 1.0, "side": 1.0, "width": 0.8, "height": 0.3,
             "turn": 1.0},
            "side: got 1, expected more than 1.5 diagonals",
        ),
    ],
)  # fmt: skip
def test_sizes_that_make_no_shape_are_errors(sizes: dict[str, Any], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        form(**sizes)


def screw(built: Built, n: int = 300) -> Any:
    """Poses of the bar on its way through the channel, turning as that does."""
    wall, bar = (built.scenario.shapes[name] for name in ("wall", "bar"))
    x = np.linspace(-0.8, 0.8, n)
    half = 0.5 * wall.turn * (x / wall.thickness + 0.5)  # type: ignore[union-attr]
    assert np.isclose(bar.turn / bar.length, wall.turn / wall.thickness)  # type: ignore[union-attr]
    return along_y(x, half)


def along_y(y: Any, half: Any) -> Any:
    """Poses of the bar along y: turned about its axis by twice `half`, and with that to y."""
    zero, s = np.zeros_like(y), np.sqrt(0.5)
    sine, cosine = np.sin(half), np.cos(half)
    return np.column_stack([zero, y, zero, s * sine, s * sine, s * cosine, s * cosine])


@pytest.mark.parametrize("clear", [0.03, 0.2])
def test_twist_has_a_way_and_none_without_a_turn(clear: float) -> None:
    built = Scenario.load("twist", clear=clear).build()
    world = built.world()
    way = screw(built)
    assert not world.collides("robot 1", way).any()
    for angle in np.linspace(0, np.pi, 60):
        still = along_y(way[:, 1], np.full(len(way), angle / 2))
        assert world.collides("robot 1", still).any()


def test_a_bug_trap_is_left_by_its_throat() -> None:
    world = Scenario.load("bug_trap", throat=0.05).world()
    level = [0.0, 0.0, 0.0, 1.0]
    assert world.check_motion("robot 1", [0, 0, -0.3, *level], [0, 0, 1.9, *level]).free
    aside = world.check_motion("robot 1", [0.02, 0, -0.3, *level], [0.02, 0, 1.9, *level])
    assert not aside.free


def test_rings_are_linked_at_the_start_and_apart_at_the_goal() -> None:
    """The fill of the standing ring is crossed an odd number of times only where linked."""
    built = Scenario.load("rings", seed=2).build()
    t = np.linspace(0, 2 * np.pi, 400)
    line = 0.5 * np.column_stack([np.cos(t), np.sin(t), 0 * t])
    for q, linked in ((built.starts[0], True), (built.goals[0], False)):
        pose = built.robots[0].forward(q)[0]
        points = line @ pose[:3, :3].T + pose[:3, 3]
        up = points[:, 2] > 0
        at = np.flatnonzero(up[:-1] != up[1:])
        crossings = (np.hypot(*points[at, :2].T) < 0.5).sum()
        assert (crossings % 2 == 1) == linked


def test_no_way_leads_over_the_walls() -> None:
    """A mover as high as it may be is nowhere over a wall."""
    for name in ("cubicles", "home"):
        built = Scenario.load(name).build()
        robot = built.robots[0]
        high = built.scenario.workspace.high[2]  # type: ignore[union-attr]
        reach = np.linalg.norm(robot.parts[0].shape.vertices, axis=1).max()
        tops = [p[2, 3] + s.bounds[1, 2] for p, s in zip(built.poses, built.shapes, strict=True)]
        assert high + reach <= max(tops) + 1e-9, name


@pytest.mark.parametrize("seed", range(5))
def test_every_cubicle_is_reached_by_doors(seed: int) -> None:
    doors = maze.opened(4, 3, Dice(seed))
    assert len(doors) == 11
    reached = {(0, 0)}
    for _ in doors:
        for i, j, axis in doors:
            pair = {(i, j), (i + (axis == 0), j + (axis == 1))}
            reached |= pair if pair & reached else set()
    assert len(reached) == 12


def test_two_bodies_swap_places() -> None:
    one, two = Scenario.load("cubicles", n=2).robots
    assert (one.start, one.goal) == (two.goal, two.start)
    assert Scenario.load("cubicles").robots[0].start == one.start


def test_furniture_stands_on_the_floor_apart() -> None:
    built = Scenario.load("home").build()
    for name in ("bed", "sofa", "chair", "wardrobe"):
        i = built.names.index(name)
        assert built.poses[i][2, 3] + built.shapes[i].bounds[0, 2] == 0.0
