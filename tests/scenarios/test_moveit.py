"""MoveIt scenes and problems, and the included problems of MotionBenchMaker."""

from __future__ import annotations

import itertools
import warnings
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
import yaml

from fgenv.robots import Robot
from fgenv.scenarios import Scenario, ScenarioError, validate
from fgenv.scenarios.io.moveit import load_problem, load_scene
from fgenv.scenarios.library import mbm

pytestmark = pytest.mark.filterwarnings("ignore:mesh 'link6' is not watertight")
FAMILIES = get_args(mbm.Family)
FOLDER = mbm.FOLDER
TURNS = [(0, 0, 0, 1), (0.5, 0.5, 0.5, 0.5), (0, 0.70710678, 0, 0.70710678), (0.1, -0.2, 0.3, 0.9)]


def test_all_problems_are_there() -> None:
    names = {f"problems/{family}_panda/{what}{k:04}.yaml" for family in FAMILIES
             for k in range(1, 101) for what in ("scene", "request")}  # fmt: skip
    assert set(mbm._archive()) == names


@pytest.fixture(scope="module")
def panda() -> Robot:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return Robot.load(FOLDER / "panda.urdf", srdf=FOLDER / "panda.srdf")


def written(path: Path, data: Any) -> Path:
    path.write_text(yaml.safe_dump(data), encoding="utf-8")
    return path


def thing(kind: Any, dimensions: Any, at: Any = None, **fields: Any) -> dict[str, Any]:
    """A collision object of one primitive."""
    at = {"position": [0, 0, 0], "orientation": [0, 0, 0, 1]} if at is None else at
    part = {"type": kind, "dimensions": dimensions}
    return {"id": "thing", "primitives": [part], "primitive_poses": [at], **fields}


def scene(*objects: Any, **fields: Any) -> dict[str, Any]:
    return {"world": {"collision_objects": list(objects)}, **fields}


def request(names: list[str], start: list[float], goal: list[float]) -> dict[str, Any]:
    expected = [{"joint_name": n, "position": v} for n, v in zip(names, goal, strict=True)]
    state = {"joint_state": {"name": names, "position": start}}
    return {"start_state": state, "goal_constraints": [{"joint_constraints": expected}]}


# MotionBenchMaker --------------------------------------------------------------------------------


@pytest.mark.parametrize("family", FAMILIES)
def test_problems_are_free_by_the_core_and_seldom_straight(family: str) -> None:
    straight = 0
    for problem in (1, 50, 100):
        scenario = Scenario.load("mbm", family=family, problem=problem)
        assert scenario.problems() == ()
        built = scenario.build()
        (start,), (goal,) = built.starts, built.goals
        assert start.shape == goal.shape == (7,)
        straight += built.world().check_motion("panda", start, goal).free
    assert straight < 3


def test_problems_are_within_limits(panda: Robot) -> None:
    for family, problem in itertools.product(FAMILIES, range(1, 101, 4)):
        scenario = Scenario.load("mbm", family=family, problem=problem)
        (robot,) = scenario.robots
        assert panda.valid([robot.start, robot.goal]).all()
        assert 7 <= len(scenario.bodies) <= 21


def test_the_panda_is_as_the_problems_mean_it() -> None:
    scenario = Scenario.load("mbm")
    (arm,) = scenario.build().robots
    assert arm.coordinates == tuple(f"panda_joint{i}" for i in range(1, 8))
    assert ("panda_link0", "panda_link4") in arm.allowed  # by its SRDF
    assert np.all(arm.acceleration == 7.5) or arm.drive is not None
    gap = arm.forward(arm.rest, "panda_leftfinger") - arm.forward(arm.rest, "panda_rightfinger")
    assert np.linalg.norm(gap[:3, 3]) == pytest.approx(0.13)
    assert scenario.robots[0].goal_tolerance.angle <= 0.01


def test_links_are_where_pinocchio_puts_them(panda: Robot) -> None:
    pin = pytest.importorskip("pinocchio")
    model = pin.buildModelFromUrdf(str(FOLDER / "panda.urdf"))
    data = model.createData()
    goal = np.array(Scenario.load("mbm", family="cage", problem=3).robots[0].goal)
    pin.framesForwardKinematics(model, data, goal)
    for link in ("panda_link4", "panda_hand", "panda_leftfinger"):
        expected = data.oMf[model.getFrameId(link)].homogeneous
        np.testing.assert_allclose(panda.forward(goal, link), expected, atol=1e-9)


@pytest.mark.parametrize("family", ["box", "table_pick"])
def test_bodies_are_where_the_archive_says(family: str) -> None:
    pin = pytest.importorskip("pinocchio")
    scenario = Scenario.load("mbm", family=family, problem=7)
    built = scenario.build()
    data = yaml.safe_load(mbm._archive()[f"problems/{family}_panda/scene0007.yaml"])
    objects = {item["id"]: item for item in data["world"]["collision_objects"]}
    assert set(built.names) == set(objects)
    for name, pose, shape in zip(built.names, built.poses, built.shapes, strict=True):
        (at,), (part,) = objects[name]["primitive_poses"], objects[name]["primitives"]
        expected = pin.XYZQUATToSE3(np.array([*at["position"], *at["orientation"]])).homogeneous
        np.testing.assert_allclose(pose, expected, atol=1e-9)
        sizes = np.array(part["dimensions"])
        if part["type"] == "cylinder":
            sizes = np.array([2 * sizes[1], 2 * sizes[1], sizes[0]])
        excess = np.ptp(shape.bounds, axis=0) - sizes
        assert (excess > -1e-9).all()
        assert (excess < 2.1e-3).all()


def test_a_problem_comes_back_from_its_file(tmp_path: Path) -> None:
    scenario = Scenario.load("mbm", family="cage", problem=12)
    scenario.save(tmp_path / "cage.yaml")
    assert Scenario.load(tmp_path / "cage.yaml").at(None) == scenario
    assert validate(tmp_path / "cage.yaml") == []


@pytest.mark.parametrize(
    ("ways", "told"),
    [
        ({"family": "kitchen"}, "family: is 'kitchen'; expected one of: bookshelf_small, .*cage"),
        ({"family": "bookshelf_smal"}, "did you mean 'bookshelf_small'"),
        ({"problem": 0}, "problem: is 0"),
        ({"problem": 101}, "problem: is 101"),
        ({"problem": 1.5}, "problem: is 1.5"),
        ({"n": 2}, "n: is no known override"),
    ],
)
def test_what_is_no_problem_is_one_clear_error(ways: dict[str, Any], told: str) -> None:
    with pytest.raises(ScenarioError, match=told):
        Scenario.load("mbm", **ways)


# Files of others ---------------------------------------------------------------------------------


@pytest.mark.parametrize("turn", TURNS)
def test_poses_are_kept_whatever_their_turn(turn: tuple[float, ...], tmp_path: Path) -> None:
    pin = pytest.importorskip("pinocchio")
    unit = np.array(turn) / np.linalg.norm(turn)
    pose = {"position": [0.1, 0.2, 0.3], "orientation": unit.tolist()}
    found = load_scene(written(tmp_path / "s.yaml", scene(thing("box", [1, 2, 3], pose))))
    expected = pin.XYZQUATToSE3(np.array([0.1, 0.2, 0.3, *unit])).homogeneous
    np.testing.assert_allclose(found.bodies[0].pose, expected, atol=1e-9)


def test_all_kinds_with_lists_tables_and_numbers(tmp_path: Path) -> None:
    at = {"position": {"x": 1, "y": 0, "z": 0}, "orientation": {"x": 0, "y": 0, "z": 0, "w": 1}}
    tetrahedron = {
        "vertices": [[0, 0, 0], {"x": 1, "y": 0, "z": 0}, [0, 1, 0], [0, 0, 1]],
        "triangles": [[0, 2, 1], {"vertex_indices": [0, 1, 3]}, [1, 2, 3], [0, 3, 2]],
    }
    objects = [
        thing("box", [1, 2, 3], at, id="box", header={"frame_id": "world"}),
        thing(2, [0.05], at, id="ball"),
        thing("cylinder", [0.4, 0.1], at, id="can"),
        thing(4, [0.4, 0.1], at, id="cone"),
        thing("box", [1, 2, 3], at, id="a/b", pose=at),
        {"id": "mesh", "meshes": [tetrahedron], "mesh_poses": [at]},
    ]
    found = load_scene(written(tmp_path / "s.yaml", scene(*objects)))
    kinds = [found.shapes[body.shape].kind for body in found.bodies]
    assert kinds == ["box", "sphere", "cylinder", "cone", "box", "triangles"]
    assert len(found.shapes) == 5  # equal boxes are one
    assert [body.position[0] for body in found.bodies] == [1, 1, 1, 1, 2, 1]
    assert found.bodies[4].name == "a:b"
    mesh = found.shapes[found.bodies[5].shape].shape()
    assert len(mesh.faces) == 4


def test_a_cone_is_enclosed_by_at_most_a_millimeter(tmp_path: Path) -> None:
    found = load_scene(written(tmp_path / "s.yaml", scene(thing("cone", [0.4, 0.1]))))
    shape = found.shapes[found.bodies[0].shape].shape()
    angles = np.linspace(0, 2 * np.pi, 1000)
    for part in (0.0, 0.5, 0.99):  # of the way up
        for radius, inside in ((0.9999, True), (1.02, False)):
            r = radius * 0.1 * (1 - part)
            z = np.full(1000, -0.2 + 0.4 * part + 1e-7)
            ring = np.column_stack([r * np.cos(angles), r * np.sin(angles), z])
            assert shape.contains(ring).all() == inside
    np.testing.assert_allclose(shape.bounds[:, 2], [-0.2, 0.2])
    assert np.abs(shape.bounds[:, :2]).max() <= 0.101


def test_a_problem_of_ones_own(tmp_path: Path) -> None:
    names, start, goal = ["elbow"], [0.0], [1.0]
    (tmp_path / "arm.urdf").write_text(
        '<robot name="arm"><link name="base"/><link name="fore"><collision><geometry>'
        '<box size="0.1 0.1 1"/></geometry></collision></link>'
        '<joint name="elbow" type="revolute"><parent link="base"/><child link="fore"/>'
        '<axis xyz="0 1 0"/><limit lower="-2" upper="2" velocity="1" effort="1"/></joint></robot>'
    )
    (tmp_path / "arm.srdf").write_text('<robot name="arm"/>')
    asked = request(names, start, goal)
    moved = {"translation": [0, 0, 2], "rotation": [0, 0, 0, 1]}
    asked["start_state"]["multi_dof_joint_state"] = {"transforms": [moved]}
    stands = written(tmp_path / "s.yaml", scene(thing("box", [0.1, 0.1, 0.1])))
    scenario = load_problem(
        stands,
        written(tmp_path / "r.yaml", asked),
        urdf=tmp_path / "arm.urdf",
        srdf=tmp_path / "arm.srdf",
    )
    assert scenario.problems() == ()
    (robot,) = scenario.robots
    assert (robot.start, robot.goal, robot.mount.position) == ((0.0,), (1.0,), (0.0, 0.0, 2.0))
    (tmp_path / "sub").mkdir()
    scenario.save(tmp_path / "sub" / "p.yaml")
    assert validate(tmp_path / "sub" / "p.yaml") == []
    asked["start_state"]["joint_state"]["name"] = ["knee"]
    with pytest.raises(ScenarioError, match=r"line \d+: start_state.joint_state: has no 'elbow'"):
        load_problem(stands, written(tmp_path / "r.yaml", asked), urdf=tmp_path / "arm.urdf")


def test_an_srdf_is_of_a_urdf() -> None:
    with pytest.raises(ValueError, match="has srdf but no urdf"):
        Scenario.model_validate(
            {"version": 1, "name": "s", "models": {"m": {"shape": "box", "srdf": "m.srdf"}}}
        )


@pytest.mark.parametrize(
    ("data", "told"),
    [
        (scene(thing("cube", [1, 1, 1])), r"primitives\[0\].type: is 'cube'; expected one of: box"),
        (scene(thing("box", [1, 1])), r"dimensions: has 2 numbers; expected 3: x, y, z"),
        (scene(thing("box", [1, 1, -1])), r"dimensions: cannot be a box; Input should be greater"),
        (scene(thing("box", [1, 1, "a"])), r"dimensions\[2\]: is 'a'; expected a number"),
        (scene(thing("box", [1, 1, 1], {"position": [0, 0]})), "position: has 2 numbers"),
        (
            scene(thing("box", [1, 1, 1], {"orientation": [0, 0, 0, 2]})),
            "orientation: has length 2",
        ),
        (scene({"primitives": [{"type": "box"}]}), r"primitives\[0\]: has no pose"),
        (scene({"id": "a"}), r"collision_objects\[0\]: has no primitives, meshes"),
        (scene(thing("box", [1, 1, 1], id=3)), "id: is 3; expected a name"),
        (scene(*[thing("box", [1, 1, 1])] * 2), "'thing' names two objects"),
        (scene(thing("box", [1, 1, 1], header={"frame_id": "hand"})), "frame_id: is 'hand'"),
        (
            scene(thing("box", [1, 1, 1], planes=[{"coef": [0, 0, 0, 1]}], plane_poses=[{}])),
            r"planes\[0\]: has a normal of length 0",
        ),
        (scene(robot_state={"attached_collision_objects": [{}]}), "attached_.*: needs the robot"),
        ({"world": {"octomap": {"octomap": {"data": [1]}}}}, "octomap.data: is not read"),
        ({"world": [1]}, r"world: is \[1\]; expected a table"),
        ([1], "expected a table with world"),
        (
            scene({"id": "m", "meshes": [{"vertices": [[0, 0, 0]], "triangles": [[0, 0, 1]]}],
                   "mesh_poses": [{}]}),
            r"triangles\[0\]: is .*; expected places in 1 vertices",
        ),
    ],
)  # fmt: skip
def test_what_is_wrong_in_a_scene_is_told_by_line_and_key(
    data: Any, told: str, tmp_path: Path
) -> None:
    with pytest.raises(ScenarioError, match=told) as caught:
        load_scene(written(tmp_path / "scene.yaml", data))
    assert str(caught.value).startswith(str(tmp_path / "scene.yaml"))
    assert all(problem.line for problem in caught.value.problems)


def test_files_that_are_missing_or_no_yaml(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        load_scene(tmp_path / "none.yaml")
    (tmp_path / "bad.yaml").write_text("a: [1")
    with pytest.raises(ScenarioError, match="is not YAML"):
        load_scene(tmp_path / "bad.yaml")
    asked = written(tmp_path / "r.yaml", {"start_state": {"joint_state": {"name": ["a"]}}})
    with pytest.raises(ScenarioError, match="has 1 names, 0 positions"):
        load_problem(written(tmp_path / "s.yaml", scene()), asked, urdf=FOLDER / "panda.urdf")


def test_goals_that_are_poses_are_refused(tmp_path: Path) -> None:
    asked = request(["panda_joint1"], [0.0], [1.0])
    stands = written(tmp_path / "s.yaml", scene())
    asked["goal_constraints"][0]["position_constraints"] = [{"link_name": "hand"}]
    with pytest.raises(ScenarioError, match="position_constraints: is not read; expected joint_"):
        load_problem(stands, written(tmp_path / "r.yaml", asked), urdf=FOLDER / "panda.urdf")
    del asked["goal_constraints"]
    with pytest.raises(ScenarioError, match="has no goal_constraints"):
        load_problem(stands, written(tmp_path / "r.yaml", asked), urdf=FOLDER / "panda.urdf")
