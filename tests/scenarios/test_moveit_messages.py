"""MoveIt messages: unknown keys, frames, operations, allowed and attached objects, groups."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from fgenv.arrays import Floats
from fgenv.robots import Robot
from fgenv.scenarios import Scenario, ScenarioError, validate
from fgenv.scenarios.io.message_types import MESSAGES
from fgenv.scenarios.io.moveit import PlanningScene, load_problem, load_scene

UNIT = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
ARM = """\
<robot name="arm">
 <link name="base"/>
 <link name="upper"><collision><origin xyz="0 0 0.5"/>
  <geometry><box size="0.1 0.1 0.9"/></geometry></collision></link>
 <link name="fore"><collision><origin xyz="0 0 0.5"/>
  <geometry><box size="0.1 0.1 0.9"/></geometry></collision></link>
 <link name="hand"><collision><geometry><box size="0.2 0.2 0.05"/></geometry></collision></link>
 <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
  <axis xyz="0 1 0"/><limit lower="-2" upper="2" velocity="1" effort="1"/></joint>
 <joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/>
  <origin xyz="0 0 1"/><axis xyz="0 1 0"/><limit lower="-3" upper="3" velocity="1" effort="1"/>
 </joint>
 <joint name="lift" type="prismatic"><parent link="fore"/><child link="hand"/>
  <origin xyz="0 0 1"/><axis xyz="0 0 1"/><limit lower="0" upper="1" velocity="1" effort="1"/>
 </joint>
</robot>
"""
SRDF = """\
<robot name="arm">
 <virtual_joint name="world_joint" type="fixed" parent_frame="world" child_link="base"/>
 <group name="bend"><joint name="elbow"/></group>
 <group name="arm"><chain base_link="base" tip_link="fore"/></group>
 <group name="all"><group name="arm"/><link name="hand"/></group>
 <disable_collisions link1="upper" link2="hand"/>
</robot>
"""


def pose(*position: float, yaw: float = 0.0) -> dict[str, Any]:
    turn = {"x": 0.0, "y": 0.0, "z": float(np.sin(yaw / 2)), "w": float(np.cos(yaw / 2))}
    return {"position": dict(zip("xyz", map(float, position), strict=True)), "orientation": turn}


def box(name: str, at: dict[str, Any], frame: str = "world", **fields: Any) -> dict[str, Any]:
    return {
        "header": {"seq": 0, "stamp": {"secs": 0, "nsecs": 0}, "frame_id": frame},
        "id": name,
        "primitives": [{"type": 1, "dimensions": [0.1, 0.2, 0.3]}],
        "primitive_poses": [at],
        **fields,
    }


def scene(*objects: Any, **fields: Any) -> dict[str, Any]:
    return {"name": "s", "world": {"collision_objects": list(objects)}, "is_diff": False, **fields}


def request(start: dict[str, float], goal: dict[str, float], **fields: Any) -> dict[str, Any]:
    state = {"joint_state": {"name": list(start), "position": list(start.values())}}
    constraints = [{"joint_name": k, "position": v, "weight": 1.0} for k, v in goal.items()]
    return {
        "start_state": state,
        "goal_constraints": [{"joint_constraints": constraints}],
        **fields,
    }


START = {"shoulder": 0.0, "elbow": 0.5, "lift": 0.2}
FULL_SCENE = scene(
    box("a", pose(3, 0, 0), subframe_names=["top"], subframe_poses=[pose(0, 0, 1)], operation=0),
    {"id": "m", "pose": pose(5, 0, 0), "mesh_poses": [pose(0, 0, 0)], "meshes": [{
        "vertices": [{"x": 0.0, "y": 0.0}, {"x": 1.0, "y": 0.0}, {"x": 0.0, "y": 1.0, "z": 0.0}],
        "triangles": [{"vertex_indices": [0, 1, 2]}]}]},
    {"id": "p", "planes": [{"coef": [0, 0, 1, 4]}], "plane_poses": [pose(0, 0, 0)]},
    robot_state={"joint_state": {"name": ["elbow"], "position": [0.5]}, "is_diff": True},
    allowed_collision_matrix={
        "entry_names": ["a", "hand"],
        "entry_values": [{"enabled": [False, True]}, {"enabled": [True, False]}]},
    fixed_frame_transforms=[{"child_frame_id": "odom", "transform": {
        "translation": {"x": 0.0, "y": 0.0, "z": 0.0}, "rotation": UNIT}}],
)  # fmt: skip
FULL_REQUEST = request(
    START,
    {"elbow": -0.5},
    group_name="arm",
    planner_id="",
    num_planning_attempts=1,
    workspace_parameters={"min_corner": {"x": -1.0, "y": -1.0, "z": -1.0}},
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "arm.urdf").write_text(ARM)
    (tmp_path / "arm.srdf").write_text(SRDF)
    return tmp_path


def scene_in(folder: Path, data: Any, **options: Any) -> PlanningScene:
    (folder / "scene.yaml").write_text(yaml.safe_dump(data))
    return load_scene(folder / "scene.yaml", **options)


def problem_in(folder: Path, scene_data: Any, request_data: Any, srdf: bool = True) -> Scenario:
    (folder / "scene.yaml").write_text(yaml.safe_dump(scene_data))
    (folder / "request.yaml").write_text(yaml.safe_dump(request_data))
    return load_problem(
        folder / "scene.yaml",
        folder / "request.yaml",
        urdf=folder / "arm.urdf",
        srdf=folder / "arm.srdf" if srdf else None,
    )


def arm(folder: Path) -> Robot:
    return Robot.load(folder / "arm.urdf")


# Keys ---------------------------------------------------------------------------------------------


def key_places(data: Any) -> list[tuple[dict[str, Any], str]]:
    """All tables of a document with each of their keys."""
    if isinstance(data, dict):
        inner = [
            place for key, value in data.items() if key != "stamp" for place in key_places(value)
        ]
        return [(data, key) for key in data] + inner
    return [place for item in data for place in key_places(item)] if isinstance(data, list) else []


@st.composite
def misspelt(draw: st.DrawFn, word: str) -> str:
    i = draw(st.integers(0, len(word) - 1))
    ways = [word[:i] + word[i + 1 :], word[:i] + word[i] + word[i:], word[:i] + "q" + word[i + 1 :]]
    if i + 1 < len(word):
        ways.append(word[:i] + word[i + 1] + word[i] + word[i + 2 :])
    return draw(st.sampled_from(ways))


@given(st.data(), st.booleans())
def test_a_misspelt_key_anywhere_names_the_nearest(
    tmp_path_factory: pytest.TempPathFactory, draw: st.DataObject, of_request: bool
) -> None:
    folder = tmp_path_factory.mktemp("keys")
    (folder / "arm.urdf").write_text(ARM)
    (folder / "arm.srdf").write_text(SRDF)
    both = copy.deepcopy(FULL_SCENE), copy.deepcopy(FULL_REQUEST)
    places = [p for p in key_places(both[of_request]) if len(p[1]) > 3]
    table, key = draw.draw(st.sampled_from(places))
    other = draw.draw(misspelt(key))
    if other in {name for fields in MESSAGES.values() for name in fields}:
        return
    table[other] = table.pop(key)
    with pytest.raises(ScenarioError, match=rf"{other}: is no known key; did you mean .*'{key}'"):
        problem_in(folder, *both)


def test_the_whole_scene_and_request_are_read(folder: Path) -> None:
    scenario = problem_in(folder, FULL_SCENE, FULL_REQUEST)
    assert [body.name for body in scenario.bodies] == ["a", "m", "p"]
    assert scenario.models["arm"].locked == {"lift": 0.2}
    assert (scenario.robots[0].start, scenario.robots[0].goal) == ((0.0, 0.5), (0.0, -0.5))


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({"wrold": scene()["world"]}, "wrold: is no known key; did you mean 'world'"),
        ({}, "has no world; add world"),
        ({"name": "s", "is_diff": False}, "has no world"),
        ({"world": {"collision_object": []}}, "did you mean 'collision_objects'"),
        (scene(box("a", {"positon": [0, 0, 1]})), "did you mean 'position'"),
        (scene(box("a", {"orientaton": UNIT})), "did you mean 'orientation'"),
        (scene(box("a", pose(0, 0, 0), header="world")), "header: is 'world'; expected a table"),
        (scene(box("a", pose(0, 0, 0)), is_diff=3), "is_diff: is 3; expected true or false"),
        (scene({"id": "a", "primitives": 3}), "primitives: is 3; expected a list"),
    ],
)  # fmt: skip
def test_scenes_that_were_empty_are_errors(data: Any, message: str, tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=message) as caught:
        scene_in(tmp_path, data)
    assert all(problem.line for problem in caught.value.problems)


def test_all_unknown_keys_are_reported_at_once(tmp_path: Path) -> None:
    data = scene(box("a", {"positon": [0, 0, 1]}), nam="s")
    with pytest.raises(ScenarioError) as caught:
        scene_in(tmp_path, data)
    assert len(caught.value.problems) == 2


def test_a_repeated_key_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "s.yaml").write_text("world: {collision_objects: []}\nworld: {}\n")
    with pytest.raises(ScenarioError, match="line 2: world: stands twice, first in line 1"):
        load_scene(tmp_path / "s.yaml")


def test_a_file_may_end_as_rostopic_ends_it(tmp_path: Path) -> None:
    text = yaml.safe_dump(scene(box("a", pose(1, 2, 3))))
    (tmp_path / "s.yaml").write_text(text + "---\n")
    assert load_scene(tmp_path / "s.yaml").bodies[0].position == (1, 2, 3)
    (tmp_path / "s.yaml").write_text(text + "---\n" + text)
    with pytest.raises(ScenarioError, match="several documents"):
        load_scene(tmp_path / "s.yaml")


# Frames -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("frame", ["", "world", "/world", "base", "/base", "fore", "hand", "odom"])
def test_frames_are_links_at_the_start(frame: str, folder: Path) -> None:
    odom = {"child_frame_id": "odom", "transform": {"translation": {"x": 1.0}, "rotation": UNIT}}
    data = scene(box("a", pose(0.1, 0.2, 0.3, yaw=0.4), frame), fixed_frame_transforms=[odom])
    scenario = problem_in(folder, data, request(START, {"elbow": 0.0}))
    robot = arm(folder)
    name = frame.removeprefix("/")
    above = np.eye(4)
    if name == "odom":
        above[0, 3] = 1.0
    elif name not in ("", "world"):
        above = robot.forward([START[joint] for joint in robot.coordinates], name)
    own = np.eye(4)
    own[:3, :3] = [[np.cos(0.4), -np.sin(0.4), 0], [np.sin(0.4), np.cos(0.4), 0], [0, 0, 1]]
    own[:3, 3] = 0.1, 0.2, 0.3
    np.testing.assert_allclose(scenario.bodies[0].pose, above @ own, atol=1e-9)


def test_a_scene_alone_takes_a_robot(folder: Path) -> None:
    data = scene(box("a", pose(0, 0, 0), "hand"))
    with pytest.raises(ScenarioError, match=r"is 'hand', which is no known frame.*robot="):
        scene_in(folder, data)
    robot = arm(folder)
    found = scene_in(folder, data, robot=robot, q=[0.0, 0.0, 0.5])
    np.testing.assert_allclose(found.bodies[0].position, [0, 0, 2.5], atol=1e-9)
    data["robot_state"] = {"joint_state": {"name": ["lift"], "position": [0.25]}}
    np.testing.assert_allclose(scene_in(folder, data, robot=robot).bodies[0].position[2], 2.25)
    data["world"]["collision_objects"][0]["header"]["frame_id"] = "hnad"
    with pytest.raises(ScenarioError, match="did you mean 'hand'"):
        scene_in(folder, data, robot=robot)


def test_objects_and_their_subframes_are_frames(tmp_path: Path) -> None:
    first = box("a", pose(1, 0, 0), subframe_names=["top"], subframe_poses=[pose(0, 0, 2)])
    found = scene_in(
        tmp_path, scene(first, box("b", pose(0, 1, 0), "a"), box("c", pose(0, 1, 0), "a/top"))
    )
    assert [body.position for body in found.bodies] == [(1, 0, 0), (1, 1, 0), (1, 1, 2)]


# Operations ---------------------------------------------------------------------------------------

MODEL_OBJECT = tuple[Floats, list[Floats]]  # pose, and poses of the parts in the world
OPERATIONS = st.tuples(
    st.sampled_from(["ADD", "REMOVE", "APPEND", "MOVE"]),
    st.sampled_from("abc"),
    st.tuples(*[st.integers(-3, 3)] * 3),
    st.integers(0, 3),
)


def matrix(position: tuple[int, ...], quarters: int) -> Floats:
    made = np.eye(4)
    c, s = [(1, 0), (0, 1), (-1, 0), (0, -1)][quarters]
    made[:2, :2] = [[c, -s], [s, c]]
    made[:3, 3] = position
    return made


@given(st.lists(OPERATIONS, max_size=12), st.randoms())
def test_operations_in_sequence_do_as_a_plain_model(
    tmp_path_factory: pytest.TempPathFactory, steps: list[Any], random: Any
) -> None:
    model: dict[str, MODEL_OBJECT] = {}
    messages = []
    for operation, name, position, quarters in steps:
        at = matrix(position, quarters)
        code = ["ADD", "REMOVE", "APPEND", "MOVE"].index(operation)
        said = random.choice([operation, code, str(code), chr(code), operation.lower()])
        message = {"id": name, "pose": pose(*position, yaw=quarters * np.pi / 2), "operation": said}
        if operation in ("ADD", "APPEND"):
            half = matrix((0, 0, 1), 0)
            message |= {
                "primitives": [{"type": "box", "dimensions": [1, 1, 1]}] * 2,
                "primitive_poses": [pose(0, 0, 0), pose(0, 0, 1)],
            }
            parts = [at, at @ half]
            if operation == "ADD" or name not in model:
                model.pop(name, None)
                model[name] = at, parts
            else:
                model[name] = model[name][0], model[name][1] + parts
        elif name not in model:
            continue
        elif operation == "MOVE":
            change = at @ np.linalg.inv(model[name][0])
            model[name] = at, [change @ part for part in model[name][1]]
        else:
            model.pop(name)
        messages.append(message)
    found = scene_in(tmp_path_factory.getbasetemp(), scene(*messages))
    expected = [part for _, parts in model.values() for part in parts]
    assert len(found.bodies) == len(expected)
    for body, part in zip(found.bodies, expected, strict=True):
        np.testing.assert_allclose(body.pose, part, atol=1e-9)


def test_remove_without_an_id_removes_all(tmp_path: Path) -> None:
    objects = [box("a", pose(0, 0, 0)), box("b", pose(0, 0, 0)), {"id": "", "operation": 1}]
    assert scene_in(tmp_path, scene(*objects)).bodies == ()


def test_a_lone_shape_gives_its_pose_to_the_object(tmp_path: Path) -> None:
    """So that MOVE puts the shape itself where the message says."""
    moved = {"id": "a", "pose": pose(5, 0, 0), "operation": 3}
    (body,) = scene_in(tmp_path, scene(box("a", pose(1, 1, 1)), moved)).bodies
    assert body.position == (5, 0, 0)


@pytest.mark.parametrize(
    ("message", "expected"),
    [
        ({"id": "b", "operation": 1}, "'b' names no object"),
        ({"id": "b", "operation": "MOVE"}, "'b' names no object"),
        (box("a", pose(0, 0, 0), operation=3), "has shapes, which MOVE ignores"),
        (box("a", pose(0, 0, 0), operation=1), "has shapes, which REMOVE ignores"),
        (box("a", pose(0, 0, 0), operation=4), "operation: is 4"),
        (box("a", pose(0, 0, 0), operation="APPENDD"), "did you mean 'APPEND'"),
        (box("a", pose(0, 0, 0), operation=True), "operation: is True"),
        (box("a", pose(0, 0, 0)), "'a' names two objects; rename one, or write its operation"),
        ({"id": "c", "primitives": [{"type": 5}], "pose": pose(0, 0, 0)}, "type: is a prism"),
        ({"id": "c", "primitive_poses": [pose(0, 0, 0)], "operation": 0}, "has 1 poses for 0"),
        (box("c", pose(0, 0, 0), subframe_names=["t"]), "has 1 subframe_names, 0 subframe_poses"),
    ],
)  # fmt: skip
def test_operations_that_are_refused(message: Any, expected: str, tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=expected):
        scene_in(tmp_path, scene(box("a", pose(0, 0, 0)), message))


@given(
    st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda n: np.hypot(np.hypot(*n[:2]), n[2]) > 0.1),
    st.floats(-5, 5),
)
def test_a_plane_is_enclosed_by_half_a_millimeter(
    tmp_path_factory: pytest.TempPathFactory, normal: tuple[float, ...], d: float
) -> None:
    plane = {"id": "p", "planes": [{"coef": [*normal, d]}], "plane_poses": [pose(1, 2, 3, yaw=1.0)]}
    found = scene_in(tmp_path_factory.getbasetemp(), scene(plane))
    body = found.bodies[0]
    n = np.array(normal) / np.sqrt(np.sum(np.square(normal)))
    offset = d / np.sqrt(np.sum(np.square(normal)))
    points = np.random.default_rng(1).uniform(-500, 500, (200, 3))
    points -= (points @ n + offset)[:, None] * n  # on the plane, in its frame
    turn = np.array([[np.cos(1), -np.sin(1), 0], [np.sin(1), np.cos(1), 0], [0, 0, 1]])
    world = points @ turn.T + [1, 2, 3]
    local = (world - body.pose[:3, 3]) @ body.pose[:3, :3]
    assert np.abs(local[:, 2]).max() < 1e-6
    assert np.abs(local[:, :2]).max() <= 1000.0
    assert found.shapes[body.shape].size[2] == 0.001  # type: ignore[union-attr]


# Allowed and attached objects ---------------------------------------------------------------------


def matrix_message(names: list[str], pairs: set[tuple[str, str]], **fields: Any) -> dict[str, Any]:
    rows = [[(a, b) in pairs or (b, a) in pairs for b in names] for a in names]
    return {"entry_names": names, "entry_values": [{"enabled": row} for row in rows], **fields}


def hits(scenario: Scenario) -> set[frozenset[str]]:
    pairs = scenario.world().contact_pairs(return_names=True)
    return {frozenset(pair) for pair in pairs}


def test_the_matrix_allows_links_and_objects(folder: Path) -> None:
    """The hand is in an object of two parts, the upper arm in another."""
    names, at = (
        ["base", "upper", "fore", "hand", "in hand", "in arm"],
        request(START, {"elbow": 0.5}),
    )
    hand = arm(folder).forward([START[j] for j in ("shoulder", "elbow", "lift")], "hand")
    twice = {"primitives": [{"type": 1, "dimensions": [0.3, 0.3, 0.3]}] * 2}
    twice["primitive_poses"] = [pose(0, 0, 0), pose(0, 0, 0.05)]
    first = {"id": "in hand", "pose": pose(*hand[:3, 3]), **twice}
    data = scene(first, box("in arm", pose(0, 0, 0.3)))
    assert hits(problem_in(folder, data, at)) == {
        frozenset({"arm/hand", "in hand 1"}),
        frozenset({"arm/hand", "in hand 2"}),
        frozenset({"arm", "in arm"}),
    }
    data["allowed_collision_matrix"] = matrix_message(names, {("hand", "in hand")})
    scenario = problem_in(folder, data, at)
    assert hits(scenario) == {frozenset({"arm", "in arm"})}
    data["allowed_collision_matrix"] = matrix_message(
        names[:-1],
        {("hand", "in hand")},
        default_entry_names=["in arm"],
        default_entry_values=[True],
    )
    scenario = problem_in(folder, data, at)
    assert hits(scenario) == set()
    scenario.save(folder / "saved.yaml")
    assert validate(folder / "saved.yaml") == []
    assert hits(Scenario.load(folder / "saved.yaml")) == set()


def test_a_matrix_replaces_the_pairs_of_the_srdf(folder: Path) -> None:
    at = request(START, {"elbow": 0.5})
    (robot,) = problem_in(folder, scene(), at).build().robots
    assert ("hand", "upper") in robot.allowed
    data = scene(allowed_collision_matrix=matrix_message(["upper", "hand"], set()))
    (robot,) = problem_in(folder, data, at).build().robots
    assert ("hand", "upper") not in robot.allowed
    assert ("fore", "upper") in robot.allowed  # adjacent links may always touch


@pytest.mark.parametrize(
    ("entries", "message"),
    [
        (matrix_message(["upper", "hnad"], set()), "'hnad' is no link or object; did you mean"),
        ({"entry_names": ["a", "hand"], "entry_values": [[0 > 1, 1 > 0], [0 > 1] * 2]}, "differs"),
        ({"entry_names": ["hand"], "entry_values": []}, "has 1 entry_names, 0 entry_values"),
        ({"entry_names": ["hand"], "entry_values": [[True, False]]}, "has 2 values"),
        ({"entry_names": ["hand"], "entry_values": [[1]]}, "got 1; expected true or false"),
        ({"default_entry_names": ["hand"], "default_entry_values": []}, "has 1 default_entry_"),
    ],
)  # fmt: skip
def test_matrices_that_are_refused(entries: Any, message: str, folder: Path) -> None:
    data = scene(box("a", pose(3, 0, 0)), allowed_collision_matrix=entries)
    with pytest.raises(ScenarioError, match=message):
        problem_in(folder, data, request(START, {"elbow": 0.5}))


def test_names_of_links_in_allowed_are_checked(folder: Path) -> None:
    scenario = problem_in(folder, scene(box("a", pose(3, 0, 0))), request(START, {"elbow": 0.5}))
    for name, remedy in (("arm/hnad", "'arm/hand'"), ("amr/hand", "arm/...")):
        (problem,) = scenario.replace(allowed=((name, "a"),)).problems()
        assert remedy in problem.remedy
    with pytest.raises(ValueError, match="hnad"):
        scenario.replace(allowed=(("arm/hnad", "a"),)).world()


def attached(name: str, link: str, at: Any, frame: str, **fields: Any) -> dict[str, Any]:
    operation = fields.pop("operation", 0)
    return {"link_name": link, "object": box(name, at, frame, operation=operation), **fields}


def test_attached_objects_move_with_their_link(folder: Path) -> None:
    """A rod on the hand hits a wall at the goal, which the hand does not reach."""
    held = attached("rod", "hand", pose(0, 0, 0.4), "hand", touch_links=["fore"])
    wall = box("wall", pose(0, 0, 3.1))
    at = request({"shoulder": 0.0, "elbow": 0.0, "lift": 0.2}, {"lift": 0.7})
    state = {"attached_collision_objects": [held], "is_diff": True}
    scenario = problem_in(folder, scene(wall, robot_state=state), at)
    (item,) = scenario.models["arm"].attached
    assert (item.link, item.touch_links) == ("hand", ("fore",))
    np.testing.assert_allclose(item.position, [0, 0, 0.4], atol=1e-9)
    assert [problem.where for problem in scenario.problems()] == ["robots[0].goal"]
    assert problem_in(folder, scene(wall), at).problems() == ()
    at["start_state"]["attached_collision_objects"] = [held]
    assert len(problem_in(folder, scene(wall), at).problems()) == 1
    scenario.save(folder / "saved.yaml")
    assert len(validate(folder / "saved.yaml")) == 1


def test_attached_objects_replace_append_and_go_back(folder: Path) -> None:
    at = request({"shoulder": 0.0, "elbow": 0.0, "lift": 0.0}, {"lift": 0.5})
    body = box("rod", pose(0, 0, 4))
    taken = {"link_name": "hand", "object": {"id": "rod"}}
    state = {"attached_collision_objects": [taken]}
    scenario = problem_in(folder, scene(body, robot_state=state), at)
    assert scenario.bodies == ()
    np.testing.assert_allclose(scenario.models["arm"].attached[0].position, [0, 0, 2], atol=1e-9)
    state["attached_collision_objects"].append(
        attached("rod", "hand", pose(0, 0, 1), "hand", operation=2)
    )
    names = [
        a.name
        for a in problem_in(folder, scene(body, robot_state=state), at).models["arm"].attached
    ]
    assert names == ["rod 1", "rod 2"]
    state["attached_collision_objects"].append({"object": {"id": "rod", "operation": "REMOVE"}})
    scenario = problem_in(folder, scene(body, robot_state=state), at)
    assert scenario.models["arm"].attached == ()
    np.testing.assert_allclose([b.position[2] for b in scenario.bodies], [4, 3], atol=1e-9)


def test_a_start_state_that_is_no_difference_drops_attached_objects(folder: Path) -> None:
    at = request(START, {"elbow": 0.5})
    state = {"attached_collision_objects": [attached("rod", "hand", pose(0, 0, 1), "hand")]}
    for flag, count in ((None, 1), (True, 1), (False, 0)):
        at["start_state"]["is_diff"] = flag
        scenario = problem_in(folder, scene(robot_state=state), at)
        assert len(scenario.models["arm"].attached) == count


@pytest.mark.parametrize(
    ("item", "message"),
    [
        (attached("rod", "hnad", pose(0, 0, 1), "hand"), "'hnad' is no link of the robot; did you"),
        (attached("rod", "hand", pose(0, 0, 1), "hand", touch_links=["x"]), "'x' is no link"),
        (attached("rod", "hand", pose(0, 0, 1), "hand", operation=3), "is MOVE, which attached"),
        ({"link_name": "hand", "object": {"id": "rod"}}, "no object is named 'rod'"),
        ({"object": {"id": "rod", "operation": 1}}, "'rod' names no attached object"),
    ],
)
def test_attached_objects_that_are_refused(item: Any, message: str, folder: Path) -> None:
    state = {"attached_collision_objects": [item]}
    with pytest.raises(ScenarioError, match=message):
        problem_in(folder, scene(robot_state=state), request(START, {"elbow": 0.5}))


# Requests -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("group", "moving"),
    [("bend", ["elbow"]), ("arm", ["shoulder", "elbow"]), ("all", ["shoulder", "elbow", "lift"])],
)
def test_joints_outside_the_group_are_locked(group: str, moving: list[str], folder: Path) -> None:
    whole = arm(folder)
    scenario = problem_in(folder, scene(), request(START, {"elbow": -1.0}, group_name=group))
    (robot,) = scenario.build().robots
    assert list(robot.coordinates) == moving
    rng = np.random.default_rng(3)
    for values in rng.uniform(0, 1, (5, len(moving))):
        q = [
            {**START, **dict(zip(moving, values, strict=True))}[name] for name in whole.coordinates
        ]
        for link in ("upper", "fore", "hand"):
            expected = whole.forward(q, link)
            np.testing.assert_allclose(robot.forward(values, link), expected, atol=1e-12)
    scenario.save(folder / "saved.yaml")
    assert validate(folder / "saved.yaml") == []


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"group_name": "amr"}, "group_name: 'amr' is no group of arm.srdf; did you mean"),
        ({"path_constraints": {"joint_constraints": [{}]}}, "path_constraints.*is not supported"),
        ({"path_constraints": {"orientation_constraints": [{}]}}, "orientation_constraints: is"),
        ({"trajectory_constraints": {"constraints": [{"position_constraints": [{}]}]}},
         "trajectory_constraints.*is not supported"),
        ({"max_velocity_scaling_factor": 0.5}, "max_velocity_scaling_factor: is 0.5, which is not"),
        ({"max_acceleration_scaling_factor": 0.1}, "is 0.1, which is not supported"),
        ({"max_cartesian_speed": 0.1}, "max_cartesian_speed: is 0.1"),
        ({"reference_trajectories": [{}]}, "reference_trajectories: is not supported"),
        ({"start_state": {"joint_state": {"name": ["lift"], "position": [0], "velocity": [1]}}},
         "velocity: is not 0"),
        ({"start_state": {"joint_state": {"name": [*START, "elbwo"], "position": [0, 0, 0, 0]}}},
         "'elbwo' is no joint of 'arm'; did you mean 'elbow'"),
        ({"start_state": {"joint_state": {"name": [*START, "elbow"], "position": [0, 0, 0, 0]}}},
         "'elbow' stands twice"),
    ],
)  # fmt: skip
def test_requests_that_are_refused(fields: Any, message: str, folder: Path) -> None:
    with pytest.raises(ScenarioError, match=message):
        problem_in(folder, scene(), request(START, {"elbow": 0.0}) | fields)


@pytest.mark.parametrize(
    ("goal", "message"),
    [
        ({"elbwo": 1.0}, "'elbwo' is no joint that moves here; did you mean 'elbow'"),
        ({"elbow": 1.0, "lift": 0.5}, "'lift' is no joint that moves here"),
        ({}, "has no joint_constraints"),
    ],
)
def test_goals_name_joints_of_the_group(goal: Any, message: str, folder: Path) -> None:
    """A misspelt joint made the goal the start, and a plan of 0 s."""
    with pytest.raises(ScenarioError, match=message):
        problem_in(folder, scene(), request(START, goal, group_name="arm"))


def test_a_group_needs_its_srdf(folder: Path) -> None:
    with pytest.raises(ScenarioError, match="group_name: is 'arm'; expected srdf="):
        problem_in(folder, scene(), request(START, {"elbow": 0.0}, group_name="arm"), srdf=False)


@pytest.mark.parametrize(
    ("part", "message"),
    [
        ('<joint name="elbwo"/>', "got joint 'elbwo'"),
        ('<group name="none"/>', "'none' does not exist"),
        ('<group name="bend"/>', "contains itself"),
        ('<chain base_link="hand" tip_link="upper"/>', "chain from 'hand' to 'upper'"),
        ("<wheel/>", "got <wheel>"),
    ],
)
def test_groups_that_are_refused(part: str, message: str, folder: Path) -> None:
    (folder / "arm.srdf").write_text(SRDF.replace('<joint name="elbow"/>', part))
    with pytest.raises(ValueError, match=message):
        problem_in(folder, scene(), request(START, {"elbow": 0.0}, group_name="bend"))


def test_values_without_effect_are_accepted(folder: Path) -> None:
    neutral = {
        "path_constraints": {"name": "", "joint_constraints": [], "position_constraints": []},
        "trajectory_constraints": {"constraints": []},
        "max_velocity_scaling_factor": 1.0,
        "max_acceleration_scaling_factor": 0,
        "group_name": "",
    }
    padding = {
        "link_padding": [{"link_name": "hand", "padding": 0.0}],
        "link_scale": [{"link_name": "hand", "scale": 1.0}],
    }
    problem_in(folder, scene(**padding), request(START, {"elbow": 0.0}) | neutral)
    for key, value in (("padding", 0.01), ("scale", 1.1)):
        padding[f"link_{key}"] = [{"link_name": "hand", key: value}]
        with pytest.raises(ScenarioError, match=f"{key}: is {value}, which is not supported"):
            problem_in(folder, scene(**{f"link_{key}": padding[f"link_{key}"]}), request(START, {}))


def test_a_mimicking_joint_is_where_its_joint_puts_it(folder: Path) -> None:
    finger = (
        '<link name="tip"/><joint name="finger" type="prismatic"><parent link="hand"/>'
        '<child link="tip"/><mimic joint="lift" multiplier="2"/>'
        '<limit lower="0" upper="9" velocity="1" effort="1"/></joint></robot>'
    )
    (folder / "arm.urdf").write_text(ARM.replace("</robot>", finger))
    problem_in(folder, scene(), request({**START, "finger": 0.4}, {"elbow": 0.0}))
    with pytest.raises(
        ScenarioError, match=r"'finger' is 0.5, but it follows 'lift'; expected 0.4"
    ):
        problem_in(folder, scene(), request({**START, "finger": 0.5}, {"elbow": 0.0}))
    at = request({**START, "finger": 0.4}, {"elbow": 0.0}, group_name="arm")
    (robot,) = problem_in(folder, scene(), at).build().robots
    np.testing.assert_allclose(robot.forward([0.0, 0.0], "tip")[:3, 3], [0.4, 0, 2.2], atol=1e-9)
