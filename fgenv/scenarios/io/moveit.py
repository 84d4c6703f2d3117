"""Scenes and problems of MoveIt: planning scenes and motion plan requests as YAML.

>>> from fgenv.scenarios.io.moveit import load_problem, load_scene
>>> scene = load_scene("scene0001.yaml")                       # shapes and bodies
>>> scenario = load_problem(scene, "request0001.yaml", urdf="panda.urdf", srdf="panda.srdf")

A file holds what `rostopic echo` shows of a moveit_msgs/PlanningScene or MotionPlanRequest. Meters,
radians; quaternions are x, y, z, w. Positions and orientations may be lists or tables.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from fgenv.arrays import Floats
from fgenv.robots import Drive, JointVelocity, Robot
from fgenv.scenarios.build import urdf_path
from fgenv.scenarios.drive_specs import DriveSpec
from fgenv.scenarios.scenario import Scenario
from fgenv.scenarios.schema import Body, Model, RobotSpec, Tolerance
from fgenv.scenarios.shapes.bodies import AnyForm

from .ros import joints, mounted, placement, pose_of
from .yaml_node import Node

BOX, SPHERE, CYLINDER, CONE = "box", "sphere", "cylinder", "cone"
NUMBERED = {1: BOX, 2: SPHERE, 3: CYLINDER, 4: CONE}  # of shape_msgs/SolidPrimitive
SIZES = {  # how `dimensions` goes
    BOX: ("x", "y", "z"),
    SPHERE: ("radius",),
    CYLINDER: ("height", "radius"),
    CONE: ("height", "radius"),
}
WORLD = ("", "world", "/world")  # frames that poses may be in
ATTACHED = ("robot_state", "attached_collision_objects")
FORMS: TypeAdapter[AnyForm] = TypeAdapter(AnyForm)
NEAR = 0.01  # m and rad: how near to its goal a robot has arrived


@dataclass(frozen=True)
class PlanningScene:
    """The static bodies of a scene.

    Attributes:
        shapes: by name; equal ones are one.
        bodies: named as the scene names its objects; their poses are in the world.
    """

    name: str
    shapes: dict[str, AnyForm] = field(default_factory=dict)
    bodies: tuple[Body, ...] = ()


def load_scene(path: str | Path) -> PlanningScene:
    """The collision objects of a planning scene.

    Boxes, spheres, cylinders, cones and meshes that are written out. Round ones are enclosed: see
    the kinds of shapes that they become. An object's pose goes before those of its parts.

    Raises:
        ScenarioError: the problems by line: not YAML, a missing key, a size or pose that
            makes no sense, planes, octomaps, attached objects, poses in another frame.
        FileNotFoundError: no such file.
    """
    return scene_of(Node.read(path))


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

    The start is the request's start state; the goal the first of its goal constraints, joints that
    it does not name keep their start values. `Scenario.problems` reports collisions of either.

    Args:
        scene: a scene, or its file.
        request: a file.
        urdf: the robot's file, relative to where the process is, or package://NAME/PATH.
        srdf: a file with pairs of links that may touch, likewise.
        drive: of the joints; at the speeds that the URDF limits them to if left out.
        name: of the scenario; that of the scene if left out.
        tolerance: meters or radians, of each joint, that count as arrived.

    Raises:
        ScenarioError: the problems by line; goals that are not joint values.
        ValueError, OSError, ImportError: of the robot's files.
    """
    stands = scene if isinstance(scene, PlanningScene) else load_scene(scene)
    arm = Model(
        urdf=str(urdf),
        srdf=None if srdf is None else str(srdf),
        drive=DriveSpec.of(drive or JointVelocity()),
    )
    return problem_of(stands, Node.read(request), arm, name or stands.name, tolerance)


def scene_of(top: Node) -> PlanningScene:
    """The scene in a file."""
    for keys in (("world", "octomap", "octomap", "data"), ATTACHED):
        if (found := top.find(*keys)) is not None and found.value:
            found.fail("is not read", "make collision objects of it")
    shapes: dict[str, AnyForm] = {}
    names: dict[AnyForm, str] = {}
    bodies: list[Body] = []
    for item in top.items("world", "collision_objects"):
        parts = list(parts_of(item))
        label = item.get("id").text().replace("/", ":")
        for i, (form, pose) in enumerate(parts):
            if form not in names:
                names[form] = f"{form.kind} {len(names) + 1}"
                shapes[names[form]] = form
            own = label if len(parts) == 1 else f"{label} {i + 1}"
            if any(body.name == own for body in bodies):
                item.get("id").fail(f"{own!r} names two objects", "rename one")
            at = placement(pose)
            bodies.append(Body(name=own, shape=names[form], position=at.position, rpy=at.rpy))
    return PlanningScene(top.path.stem, shapes, tuple(bodies))


def parts_of(item: Node) -> Iterator[tuple[AnyForm, Floats]]:
    """Forms of a collision object, and their poses in the world."""
    frame = item.find("header", "frame_id")
    if frame is not None and frame.value not in WORLD:
        frame.fail(f"is {frame.value!r}", "expected poses in the world's frame")
    if next(item.items("planes"), None) is not None:
        item.get("planes").fail("is not read", "expected boxes, which end somewhere")
    whole = pose_of(item.find("pose"))
    found = False
    for what, form in (("primitives", primitive), ("meshes", mesh)):
        poses = list(item.items("primitive_poses" if what == "primitives" else "mesh_poses"))
        for i, part in enumerate(item.items(what)):
            if i >= len(poses) and (i or item.find("pose") is None):
                part.fail("has no pose", "add one to its poses")
            found = True
            yield form(part), whole @ pose_of(poses[i] if i < len(poses) else None)
    if not found:
        item.fail("has no primitives or meshes", "add one, or leave the object out")


def primitive(part: Node) -> AnyForm:
    """The form of a shape_msgs/SolidPrimitive."""
    kind = part.get("type").value
    kind = NUMBERED.get(kind, kind) if type(kind) is int else str(kind).lower()
    if kind not in SIZES:
        part.get("type").fail(f"is {kind!r}", f"expected one of: {', '.join(SIZES)}")
    sizes = part.get("dimensions").numbers(SIZES[kind])
    named = dict(zip(SIZES[kind], sizes, strict=True))
    if kind == BOX:
        return formed(part.get("dimensions"), kind=kind, size=sizes)
    if kind == CYLINDER:
        named["length"] = named.pop("height")
    return formed(part.get("dimensions"), kind=kind, **named)


def mesh(part: Node) -> AnyForm:
    """The form of a shape_msgs/Mesh."""
    vertices = tuple(v.numbers("xyz") for v in part.get("vertices").items())
    faces = []
    for triangle in part.get("triangles").items():
        inside = triangle.find("vertex_indices") if isinstance(triangle.value, dict) else triangle
        corners = (inside or triangle.get("vertex_indices")).numbers("abc")
        if not all(k == int(k) and 0 <= k < len(vertices) for k in corners):
            triangle.fail(f"is {corners}", f"expected places in {len(vertices)} vertices, from 0")
        faces.append(tuple(map(int, corners)))
    return formed(part, kind="triangles", vertices=vertices, faces=tuple(faces))


def formed(part: Node, **sizes: Any) -> AnyForm:
    """A form of the schema; sizes that make no sense are errors of the file."""
    try:
        return FORMS.validate_python(sizes)
    except ValidationError as error:
        part.fail(f"cannot be a {sizes['kind']}", error.errors()[0]["msg"])


def problem_of(
    scene: PlanningScene, request: Node, arm: Model, name: str, tolerance: float = NEAR
) -> Scenario:
    """The scenario of a scene and the top of a request's file; see `load_problem`."""
    start = joints(request.get("start_state", "joint_state"))
    if (held := request.find("start_state", ATTACHED[1])) is not None and held.value:
        held.fail("is not read", "make a link of the robot of it")
    mount = mounted(request.find("start_state", "multi_dof_joint_state"))
    expected = {**start, **goal_of(request)}
    kinematics = arm_of(arm.urdf or "")
    order = kinematics.coordinates
    for joint in order:
        if joint not in start:
            request.get("start_state", "joint_state").fail(f"has no {joint!r}", "add it")
    robot = RobotSpec(
        name=kinematics.name,
        model="arm",
        start=tuple(start[joint] for joint in order),
        goal=tuple(expected[joint] for joint in order),
        mount=mount,
        goal_tolerance=Tolerance(position=tolerance, angle=tolerance),
    )
    return Scenario(
        version=1,
        name=name,
        shapes=scene.shapes,
        models={"arm": arm},
        robots=(robot,),
        bodies=scene.bodies,
    )


def goal_of(request: Node) -> dict[str, float]:
    """Values of joints by name, of the first of a request's goal constraints."""
    goal = next(request.items("goal_constraints"), None)
    if goal is None:
        request.fail("has no goal_constraints", "add joint constraints")
    for other in ("position_constraints", "orientation_constraints", "visibility_constraints"):
        if (found := goal.find(other)) is not None and found.value:
            found.fail("is not read", "expected joint_constraints: solve for joint values first")
    named = {c.get("joint_name").text(): c.get("position").number()
             for c in goal.items("joint_constraints")}  # fmt: skip
    if not named:
        goal.fail("has no joint_constraints", "add one for each joint")
    return named


def arm_of(urdf: str) -> Robot:
    """The robot in a URDF file, for its name and the order of its joints."""
    path = urdf_path(urdf, None)
    return _read(path, path.stat().st_mtime_ns)


@lru_cache(maxsize=32)
def _read(path: Path, changed: int) -> Robot:
    """Read again where the file is another one."""
    return Robot.from_urdf(path)
