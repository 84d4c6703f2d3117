"""Built-in scenarios: laws that hold for all, and what each promises."""

from __future__ import annotations

import copy
import itertools
import json
import pickle
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import fcl
import numpy as np
import pytest
from support import ROOT
from typer.testing import CliRunner

from fgenv.arrays import Floats
from fgenv.cli import app
from fgenv.collision import Shape
from fgenv.robots import Robot
from fgenv.scenarios import Built, Scenario, ScenarioError
from fgenv.scenarios.library import ENTRIES
from fgenv.scenarios.library.random import PITCH
from fgenv.scenarios.rng import Dice, micro
from fgenv.scenarios.yaml_io import dump

MANY = [name for name, e in ENTRIES.items() if "n" in e.parameters and e.most > 2]
WAYS: list[tuple[str, dict[str, Any]]] = [
    ("three_tanks", {}),
    *((name, {"n": n}) for name in MANY for n in (1, 2, 5, 12)),
    *((name, {"n": 64}) for name in MANY if name != "cell"),
    *(("swap", {"n": 9, "body": body, "jitter": 0.15}) for body in ("disc", "long", "l")),
    ("corridor", {"n": 6, "bays": 0}),
    ("doorway", {"n": 3, "size": 4.0, "gap": 0.6}),
    ("warehouse", {"n": 10, "size": 8.0}),
    ("forest", {"n": 4, "trees": 0}),
    ("random", {"n": 5, "fill": 1.0}),
]
IDS = [f"{name}-{'-'.join(map(str, ways.values()))}" for name, ways in WAYS]


def made(name: str, ways: dict[str, Any], seed: int = 0) -> Scenario:
    return Scenario.load(name, seed=seed, **ways)


def peers(shapes: Sequence[Shape], poses: Iterable[Floats]) -> list[Any]:
    """The bodies in python-fcl."""
    objects = []
    for shape, pose in zip(shapes, poses, strict=True):
        model = fcl.BVHModel()
        model.beginModel(len(shape.vertices), len(shape.faces))
        model.addSubModel(shape.vertices, shape.faces)
        model.endModel()
        objects.append(fcl.CollisionObject(model, fcl.Transform(pose[:3, :3], pose[:3, 3])))
    return objects


def robots_in_fcl(built: Built, at: Sequence[Floats]) -> list[list[Any]]:
    def places(robot: Robot, q: Floats) -> list[Floats]:
        return [robot.forward(q, part.link) @ part.origin for part in robot.parts]

    return [
        peers([part.shape for part in robot.parts], places(robot, q))
        for robot, q in zip(built.robots, at, strict=True)
    ]


@pytest.mark.parametrize(("name", "ways"), WAYS, ids=IDS)
def test_all_starts_and_goals_are_free_by_the_core_and_as_many_as_asked(
    name: str, ways: dict[str, Any]
) -> None:
    scenario = made(name, ways, seed=5)
    built = scenario.build()
    assert len(scenario.robots) == ways.get("n", 1)
    assert scenario.problems() == ()
    assert len(scenario.world().contact_pairs()) == 0
    assert len(built.world(built.goals).contact_pairs()) == 0
    assert scenario.dimension == ENTRIES[name].dimension
    for robot, start, goal in zip(built.robots, built.starts, built.goals, strict=True):
        assert robot.drive is not None
        assert robot.valid([start, goal]).all()
        assert robot.displacement_bound(start, goal) > 0.1 or name in ("random", "warehouse")


@pytest.mark.parametrize("name", ENTRIES)
def test_starts_and_goals_are_free_by_fcl(name: str) -> None:
    built = made(name, {}, seed=2).build()
    standing = peers(built.shapes, built.poses)
    for at in (built.starts, built.goals):
        robots = robots_in_fcl(built, at)
        others = [part for robot in robots for part in robot]
        for robot in robots:
            for part in robot:
                strangers = [p for p in others if p not in robot]
                assert not any(fcl.collide(part, other) for other in (*standing, *strangers))


@pytest.mark.parametrize(("name", "ways"), WAYS[::3], ids=IDS[::3])
def test_a_scenario_comes_back_from_its_file(
    name: str, ways: dict[str, Any], tmp_path: Path
) -> None:
    scenario = made(name, ways)
    scenario.save(tmp_path / "s.yaml")
    again = Scenario.load(tmp_path / "s.yaml")
    assert again.at(scenario.folder) == scenario
    assert dump(again) == dump(scenario)
    one, two = scenario.build(), again.build()
    np.testing.assert_array_equal(one.poses, two.poses)
    for a, b in zip(one.robots, two.robots, strict=True):
        np.testing.assert_array_equal(a.mount, b.mount)
        assert a.drive == b.drive
        assert a.coordinates == b.coordinates


@pytest.mark.parametrize("name", MANY)
def test_same_seed_same_scenario_and_another_seed_another(name: str) -> None:
    ways = {"jitter": 0.1} if name == "swap" else {}
    one, same, other = (made(name, ways, seed) for seed in (7, 7, 8))
    assert dump(one) == dump(same)
    starts = [r.start for r in one.robots] + [r.goal for r in one.robots]
    assert starts != [r.start for r in other.robots] + [r.goal for r in other.robots]
    values = [x for q in starts for x in q] + [x for b in one.bodies for x in (*b.position, *b.rpy)]
    assert values == [micro(x) for x in values]


def test_dice_are_golden() -> None:
    """NumPy keeps PCG64's bits for good, and nothing else is made of them."""
    dice = Dice(3, 1)
    assert [dice.unit() for _ in range(2)] == [0.25325307785026463, 0.40719719128199483]
    assert dice.shuffled(range(8)) == [0, 6, 5, 1, 4, 3, 7, 2]
    assert all(0 <= dice.below(3) < 3 for _ in range(100))


def test_swap_is_symmetric_without_jitter() -> None:
    scenario = Scenario.load("swap", n=6)
    for a, b in zip(scenario.robots, scenario.robots[3:] + scenario.robots[:3], strict=True):
        assert a.start[:2] == b.goal[:2]
        np.testing.assert_allclose(np.add(a.start[:2], b.start[:2]), 0, atol=1e-6)
        assert a.start[2] == a.goal[2]


def test_every_lane_of_random_is_free_for_its_robots() -> None:
    """What makes it solvable by construction: see its module."""
    scenario = Scenario.load("random", n=12, seed=4, fill=1.0)
    built = scenario.build()
    world = built.world(robots=False)
    robot = built.add_robot(world, 0, built.starts[0])
    crossings = sorted({q[:2] for r in scenario.robots for q in (r.start, r.goal)})
    cells = round((scenario.workspace.high[0] * 2 - 1.0) / PITCH)  # type: ignore[union-attr]
    lines = (np.arange(cells + 1) - cells / 2) * PITCH
    assert all(x in lines and y in lines for x, y in crossings)
    assert len(lines) ** 2 >= 12 + 2
    for fixed, (a, b) in itertools.product(lines, itertools.pairwise(lines)):
        for ends in (((fixed, a), (fixed, b)), ((a, fixed), (b, fixed))):
            assert world.check_motion(robot, *([*end, 0.0] for end in ends)).free


def test_carts_start_or_end_under_racks() -> None:
    scenario = Scenario.load("warehouse", n=24, seed=1)
    racks = {body.position[:2] for body in scenario.bodies if body.shape == "rack"}
    under = [q[:2] in racks for r in scenario.robots for q in (r.start, r.goal)]
    assert 2 < sum(under) < len(under)


def test_overrides_of_the_schema_go_with_those_of_the_generator() -> None:
    scenario = Scenario.load("swap", n=3, horizon=9.0, on_collision="pass", at_goal="vanish")
    assert (scenario.horizon, scenario.on_collision, scenario.at_goal) == (9.0, "pass", "vanish")
    assert Scenario.load("three_tanks", seed=4).seed == 4


@pytest.mark.parametrize(
    ("name", "ways", "told"),
    [
        ("swp", {}, "did you mean 'swap'"),
        ("", {}, "expected one of: bug_trap"),
        ("swap", {"jiter": 1}, "jiter: is no known override; did you mean 'jitter'"),
        ("swap", {"n": 0}, "n: is 0, should be greater than or equal to 1"),
        ("swap", {"n": 65}, "n: is 65"),
        ("swap", {"n": 2.5}, "n: is 2.5"),
        ("swap", {"n": "many", "body": "cube"}, "2 problems"),
        ("swap", {"jitter": float("nan")}, "jitter"),
        ("swap", {"seed": -1}, "seed: is -1"),
        ("swap", {"n": 40, "size": 3.0}, "no room is left .* larger size"),
        ("swap", {"horizon": -1}, "horizon: is -1"),
        ("cell", {"n": 13}, "n: is 13"),
        ("three_tanks", {"n": 2}, "n: is no known override"),
        ("intersection", {"n": 16, "size": 10.0}, "a queue of 4 cars does not fit"),
        ("random", {"n": 60, "size": 6.0}, "crossings are too few"),
        ("forest", {"trees": 2000, "size": 6.0, "n": 1}, "trees do not fit"),
        ("doorway", {"gap": 9.0}, "narrower door"),
        ("corridor", {"bays": 9, "size": 5.0}, "do not fit along"),
        ("warehouse", {"n": 1, "size": 2.0}, "no rack fits"),
    ],
)
def test_what_cannot_be_made_is_one_clear_error(name: str, ways: dict[str, Any], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        Scenario.load(name, **ways)


def test_cell_needs_the_extra_and_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "yourdfpy", None)
    with pytest.raises(ModuleNotFoundError, match=r"pip install 'fgenv\[urdf\]'"):
        Scenario.load("cell")


def test_a_scenario_is_a_value() -> None:
    scenario = Scenario.load("forest", n=2)
    for other in (
        copy.deepcopy(scenario),
        pickle.loads(pickle.dumps(scenario)),
        scenario.replace(),
    ):
        assert other == scenario
    with pytest.raises(ValueError, match="frozen"):
        scenario.seed = 3
    error = ScenarioError("s", scenario.problems())
    assert pickle.loads(pickle.dumps(error)).args == error.args


def test_built_is_plain_arrays() -> None:
    built = Scenario.load("cell", n=3).build()
    assert built.poses.shape == (len(built.shapes), 4, 4)
    assert [q.shape for q in built.starts] == [(6,)] * 3
    assert built.groups[0] == ("robot 1", "robots")
    assert built.body_groups[0] == ("table", "static")
    assert len({id(p.shape) for robot in built.robots for p in robot.parts}) == 11  # shared
    world = built.world()
    assert world.record(world.parts("robot 1")[1]).name == "robot 1/shoulder"


# The command -------------------------------------------------------------------------------------


def fgenv(*arguments: str) -> tuple[int, str]:
    done = CliRunner().invoke(app, ["scenarios", *arguments])
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        raise done.exception
    return done.exit_code, done.stdout


def test_list_names_all_with_dimension_and_number() -> None:
    code, out = fgenv()
    assert code == 0
    assert all(name in out for name in ENTRIES)
    facts = {row["name"]: row for row in json.loads(fgenv("--json")[1])}
    assert list(facts) == list(ENTRIES)
    assert facts["forest"]["dimension"] == 3
    assert facts["swap"]["takes"]["jitter"] == 0.0


def test_schema_is_the_committed_one_and_holds_all_built_in() -> None:
    jsonschema = pytest.importorskip("jsonschema")
    _, out = fgenv("--schema")
    file = ROOT / "fgenv" / "scenarios" / "schema.json"
    assert out == file.read_text(encoding="utf-8"), "fgenv scenarios --schema > the file"
    check = jsonschema.Draft202012Validator(json.loads(out))
    for name in ENTRIES:
        data = Scenario.load(name).model_dump(mode="json", exclude_none=True)
        assert check.is_valid(data), next(check.iter_errors(data))
        assert not check.is_valid({**data, "nonsense": 1})


def test_one_is_saved_and_drawn(tmp_path: Path) -> None:
    file, picture = tmp_path / "s.yaml", tmp_path / "s.png"
    ways = ("--n", "4", "--seed", "3", "--size", "6", "--set", "jitter=0.1", "--set", "body=l")
    code, out = fgenv("swap", *ways, "--save", str(file), "--picture", str(picture), "--json")
    assert code == 0
    assert json.loads(out)["written"] == [str(file), str(picture)]
    expected = Scenario.load("swap", n=4, seed=3, size=6.0, jitter=0.1, body="l")
    assert Scenario.load(file) == expected.at(tmp_path)
    assert picture.stat().st_size < 40_000
    assert "on a circle" in fgenv(str(file))[1]


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("swap", "--set", "jitter"), "KEY=VALUE"),
        (("swap", "--set", "jitter=[1"), "expected a number"),
        (("--save", "x.yaml"), "NAME"),
        (("swap", "--freeze", "x.zip"), r"\.npz"),
    ],
)
def test_wrong_use_is_one_clear_error(arguments: tuple[str, ...], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        fgenv(*arguments)
