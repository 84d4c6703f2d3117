"""Scenes and problems of MoveIt: planning scenes and motion plan requests.

>>> from fgenv.scenarios.io.moveit import load_problem, load_scene
>>> scene = load_scene("scene0001.yaml")                       # shapes and bodies
>>> scenario = load_problem("scene0001.yaml", "request0001.yaml", urdf="panda.urdf",
...                         srdf="panda.srdf")

A file holds what `rostopic echo` shows of a moveit_msgs/PlanningScene or MotionPlanRequest, in
YAML; `.scene` files are the text that RViz saves. Meters, radians; quaternions are x, y, z, w.
Positions and orientations may be lists or tables.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from numpy.typing import ArrayLike

from fgenv.arrays import Floats
from fgenv.robots import Drive, JointVelocity, Robot
from fgenv.scenarios.build import urdf_path
from fgenv.scenarios.drive_specs import DriveSpec
from fgenv.scenarios.registry import OWN_KEYS, file_format
from fgenv.scenarios.scenario import Scenario
from fgenv.scenarios.schema import Model, Placement, RobotSpec, Tolerance

from .collision_matrix import CollisionMatrix
from .message_types import MESSAGES, check_message
from .motion_request import check_request, first_goal, goal_of, moving_joints, start_of
from .planning_scene import PlanningScene, configuration, label_of, merged, scene_of, state_of
from .scene_text import read_scene_text
from .yaml_node import Node

NEAR = 0.01  # m and rad: how near to its goal a robot has arrived
__all__ = ["PlanningScene", "load_problem", "load_scene", "problem_of", "scene_of"]


def load_scene(
    path: str | Path, *, robot: Robot | None = None, q: ArrayLike | None = None
) -> PlanningScene:
    """The objects of a planning scene.

    Boxes, spheres, cylinders, cones, planes, and meshes that are written out; their operations ADD,
    REMOVE, APPEND and MOVE are applied in order. Round ones are enclosed: see the kinds of shapes
    that they become. A plane becomes a box of 1 mm that encloses it within 1 km of the point that
    is nearest to its origin. Colors and object types have no effect.

    Args:
        robot: its links are known as frames, and may carry objects.
        q: (nq,), its configuration; None: that of the scene's robot_state, over `robot.rest`.

    Raises:
        ScenarioError: the problems by line: not YAML, an unknown or missing key, a size or pose
            that makes no sense, an unknown frame, octomaps, link padding and scale, prisms.
        FileNotFoundError: no such file.
    """
    if Path(path).suffix.lower() == ".scene":
        return read_scene_text(Path(path))
    return scene_of(Node.read(path), robot, q)


def _scenario_of(scene: PlanningScene, path: Path) -> Scenario:
    """The static bodies of a scene."""
    if scene.matrix is not None:
        scene.matrix.place.fail("is for a robot", "use load_problem, or remove it")
    return Scenario(
        version=1,
        name=scene.name or path.stem,
        description="Planning scene of MoveIt.",
        shapes=scene.shapes,
        bodies=scene.bodies,
    ).at(path.parent)


@file_format("MoveIt scene as text", ".scene")
def scene_text(path: Path) -> Scenario:
    """The objects of a .scene file; see `read_scene_text`."""
    return _scenario_of(read_scene_text(path), path)


@file_format("MoveIt planning scene", keys=MESSAGES["PlanningScene"].keys() - OWN_KEYS - {"name"})
def planning_scene(path: Path) -> Scenario:
    """The objects of a planning scene in YAML; see `load_scene`."""
    return _scenario_of(load_scene(path), path)


def load_problem(
    scene: PlanningScene | str | Path,
    request: str | Path,
    *,
    urdf: str | Path,
    srdf: str | Path | None = None,
    drive: Drive | None = None,
    name: str | None = None,
    tolerance: float = NEAR,
) -> Scenario:
    """A scenario of one arm from a scene and a motion plan request.

    The start is the request's start state, over the scene's robot_state; the goal the first of its
    goal constraints, joints that it does not name keep their start values. Joints outside the
    request's group are locked. The allowed collision matrix of the scene replaces the pairs of the
    SRDF. Links are frames: where the scene's robot_state puts them, or else the start.
    `Scenario.problems` reports collisions of start or goal.

    Args:
        scene: a scene, or its file.
        request: a file.
        urdf: the robot's file, relative to where the process is, or package://NAME/PATH.
        srdf: a file with pairs of links that may touch, and with groups, likewise.
        drive: of the joints; at the speeds that the URDF limits them to if left out.
        name: of the scenario; that of the scene if left out.
        tolerance: meters or radians, of each joint, that count as arrived.

    Raises:
        ScenarioError: the problems by line; goals that are not joint values, joints that the robot
            or the group does not have, constraints of the path, limits of speed.
        ValueError, OSError, ImportError: of the robot's files.
    """
    asked = Node.read(request)
    check_request(asked)
    if not isinstance(scene, PlanningScene) and Path(scene).suffix.lower() == ".scene":
        scene = read_scene_text(Path(scene))
    elif not isinstance(scene, PlanningScene):
        top = Node.read(scene)
        scene = scene_of(top, *_placed(top, asked, arm_of(str(urdf))))
    arm = Model(
        urdf=str(urdf),
        srdf=None if srdf is None else str(srdf),
        drive=DriveSpec.of(drive or JointVelocity()),
    )
    return problem_of(scene, asked, arm, name or scene.name, tolerance)


def _placed(top: Node, request: Node, robot: Robot) -> tuple[Robot, Floats]:
    """The robot and its configuration for the frames of a scene."""
    check_message(top, "PlanningScene")
    state, _ = state_of(top.find("robot_state"))
    start, mount = state_of(request.find("start_state"))
    robot = robot if mount is None else robot.replace(mount=mount.pose)
    return robot, configuration(robot, state or start)


def problem_of(
    scene: PlanningScene, request: Node, arm: Model, name: str, tolerance: float = NEAR
) -> Scenario:
    """The scenario of a scene and the top of a request's file; see `load_problem`."""
    check_request(request)
    robot = arm_of(arm.urdf or "")
    values, mount = state_of(request.find("start_state"))
    goal = first_goal(request)
    mount = mount or scene.mount or Placement()
    start = start_of(request, robot, {**scene.state, **values})
    placed = robot.replace(mount=mount.pose)
    scene = merged(scene, request.find("start_state"), placed, configuration(robot, start))
    srdf = None if arm.srdf is None else urdf_path(arm.srdf, None, "srdf")
    moving = moving_joints(request, robot, srdf)
    expected = {**start, **goal_of(goal, moving)}
    locked = {joint: value for joint, value in start.items() if joint not in moving}
    changes: dict[str, object] = {"locked": locked, "attached": scene.attachments}
    pairs: tuple[tuple[str, str], ...] = ()
    if scene.matrix is not None:
        own, pairs = allowed_pairs(scene, scene.matrix, robot)
        changes |= {"srdf": None, "allowed": (*arm.allowed, *own)}
    spec = RobotSpec(
        name=robot.name,
        model="arm",
        start=tuple(start[joint] for joint in moving),
        goal=tuple(expected[joint] for joint in moving),
        mount=mount,
        goal_tolerance=Tolerance(position=tolerance, angle=tolerance),
    )
    return Scenario(
        version=1,
        name=name,
        shapes=scene.shapes,
        models={"arm": arm.model_copy(update=changes)},
        robots=(spec,),
        bodies=scene.bodies,
        allowed=pairs,
    )


Pairs = tuple[tuple[str, str], ...]


def allowed_pairs(
    scene: PlanningScene, matrix: CollisionMatrix, robot: Robot
) -> tuple[Pairs, Pairs]:
    """Pairs that a matrix allows: of links and attached objects, and of these with objects."""
    links = [link.name for link in robot.links]
    matrix.check_names([*links, *scene.attached, *scene.objects])
    labels = {**{name: [name] for name in links}, **scene.attached_names()}
    own = [(a, b) for x, y in matrix.allowed(labels) for a in labels[x] for b in labels[y]]
    mixed = [
        (f"{robot.name}/{part}", label_of(key))
        for name, parts in labels.items()
        for key in scene.objects
        if matrix(name, key)
        for part in parts
    ]
    return tuple(own), tuple(mixed)


def arm_of(urdf: str) -> Robot:
    """The robot in a URDF file, for its name, joints and links."""
    path = urdf_path(urdf, None)
    return _read(path, path.stat().st_mtime_ns)


@lru_cache(maxsize=32)
def _read(path: Path, changed: int) -> Robot:
    """Read again where the file is another one."""
    return Robot.load(path)
