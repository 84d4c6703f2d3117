"""Planning scenes of MoveIt: objects, attached objects, allowed collisions and robot state."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from fgenv.arrays import Floats
from fgenv.robots import Robot
from fgenv.scenarios.errors import short
from fgenv.scenarios.schema import Attachment, Body, Placement
from fgenv.scenarios.shapes.bodies import AnyForm

from .attached_objects import AttachedObject, apply_attached
from .collision_matrix import CollisionMatrix, matrix_of
from .collision_objects import WORLD, CollisionObject, Parts, SceneObjects
from .message_types import check_message
from .ros import joints, mounted, placement, transform_of
from .yaml_node import Node


@dataclass(frozen=True)
class PlanningScene:
    """The content of a scene.

    Attributes:
        objects: static objects by id.
        attached: objects that links carry, by id.
        matrix: pairs of links and objects that may touch; None: those of the SRDF.
        state: values of the joints that the scene lists, by name.
        mount: frame of the robot's base in the world; None if the scene has none.
    """

    name: str
    objects: dict[str, CollisionObject] = field(default_factory=dict)
    attached: dict[str, AttachedObject] = field(default_factory=dict)
    matrix: CollisionMatrix | None = None
    state: dict[str, float] = field(default_factory=dict)
    mount: Placement | None = None

    @cached_property
    def shapes(self) -> dict[str, AnyForm]:
        """Shapes by name; equal ones are one."""
        return {name: form for form, name in self._names.items()}

    @cached_property
    def bodies(self) -> tuple[Body, ...]:
        """Static bodies, named as the scene names its objects; their poses are in the world."""
        bodies: list[Body] = []
        for key, item in self.objects.items():
            groups = (label_of(key),) if len(item.parts) > 1 else ()
            for name, form, pose in _named_parts(key, item.parts):
                if any(body.name == name for body in bodies):
                    item.place.fail(f"{name!r} names two objects", "rename one")
                at = placement(item.pose @ pose)
                shape = self._names[form]
                bodies.append(
                    Body(name=name, shape=shape, position=at.position, rpy=at.rpy, groups=groups)
                )
        return tuple(bodies)

    @cached_property
    def attachments(self) -> tuple[Attachment, ...]:
        """The attached objects in the schema's terms."""
        return tuple(
            Attachment(
                name=name,
                link=item.link,
                shape=self._names[form],
                touch_links=item.touch_links,
                **dict(placement(pose)),
            )
            for key, item in self.attached.items()
            for name, form, pose in _named_parts(key, item.parts)
        )

    def attached_names(self) -> dict[str, list[str]]:
        """Names of the attachments of each attached object, by its id."""
        return {
            key: [name for name, _, _ in _named_parts(key, item.parts)]
            for key, item in self.attached.items()
        }

    @cached_property
    def _names(self) -> dict[AnyForm, str]:
        names: dict[AnyForm, str] = {}
        static = [item.parts for item in self.objects.values()]
        for parts in (*static, *(item.parts for item in self.attached.values())):
            for form, _ in parts:
                names.setdefault(form, f"{form.kind} {len(names) + 1}")
        return names


def label_of(key: str) -> str:
    """Name of a body for the id of an object."""
    return key.replace("/", ":")


def _named_parts(key: str, parts: Parts) -> Iterator[tuple[str, AnyForm, Floats]]:
    label = label_of(key)
    for i, (form, pose) in enumerate(parts):
        yield (label if len(parts) == 1 else f"{label} {i + 1}"), form, pose


def scene_of(top: Node, robot: Robot | None = None, q: ArrayLike | None = None) -> PlanningScene:
    """The scene in a file; see `load_scene`."""
    check_message(top, "PlanningScene")
    world = top.find("world")
    if world is None:
        top.fail("has no world", "add world: {collision_objects: []}, with the objects in the list")
    _refuse_unsupported(top)
    state_node = top.find("robot_state")
    state, mount = state_of(state_node)
    links = {}
    if robot is not None:
        robot = robot if mount is None else robot.replace(mount=mount.pose)
        links = link_poses(robot, configuration(robot, state) if q is None else q)
    objects = SceneObjects(fixed_frames(top, links))
    for item in world.items("collision_objects"):
        objects.apply(item)
    attached: dict[str, AttachedObject] = {}
    attach_all(state_node, objects, attached, links)
    matrix = matrix_of(top)
    return PlanningScene(top.path.stem, objects.by_id, attached, matrix, state, mount)


def attach_all(
    state: Node | None,
    objects: SceneObjects,
    attached: dict[str, AttachedObject],
    links: Mapping[str, Floats],
) -> None:
    """Apply the attached objects of a robot state."""
    for item in state.items("attached_collision_objects") if state is not None else ():
        if not links:
            item.fail("needs the robot", "use load_scene(..., robot=...) or load_problem")
        apply_attached(item, objects, attached, links)


def state_of(state: Node | None) -> tuple[dict[str, float], Placement | None]:
    """Values of joints of a robot state, and the pose of its base; None without transforms."""
    if state is None:
        return {}, None
    joint_state = state.find("joint_state")
    base = state.find("multi_dof_joint_state")
    has_base = base is not None and next(base.items("transforms"), None) is not None
    return joints(joint_state), mounted(base) if has_base else None


def configuration(robot: Robot, values: Mapping[str, float]) -> Floats:
    """The configuration with values of joints by name; other joints are as in `rest`."""
    q = np.array(robot.rest, dtype=np.float64)
    for i, name in enumerate(robot.coordinates):
        q[i] = values.get(name, q[i])
    return q


def link_poses(robot: Robot, q: ArrayLike) -> dict[str, Floats]:
    """Poses (4, 4) in the world of all links at a configuration (nq,), by name."""
    poses = robot.forward(q)
    return {link.name: poses[i] for i, link in enumerate(robot.links)}


def fixed_frames(top: Node, links: Mapping[str, Floats]) -> dict[str, Floats]:
    """Poses in the world of links, and of the frames that the scene defines."""
    frames = dict(links)
    for item in top.items("fixed_frame_transforms"):
        parent, child = item.find("header", "frame_id"), item.get("child_frame_id")
        above = "" if parent is None else str(parent.value).removeprefix("/")
        pose = transform_of(item.find("transform"))
        if above not in (*WORLD, *frames):
            item.fail(f"is in {short(above)}, which is no known frame", "expected the world")
        pose = pose if above in WORLD else frames[above] @ pose
        name = str(child.value).removeprefix("/")
        if name not in (*WORLD, *links):
            frames[name] = pose
        elif not np.allclose(pose, links.get(name, np.eye(4)), rtol=0.0, atol=1e-6):
            child.fail(f"is {name!r}, which has another pose", "leave the transform out")
    return frames


def _refuse_unsupported(top: Node) -> None:
    """Raise a ScenarioError for parts of a scene that have an effect but are not supported."""
    for key, neutral in (("padding", 0), ("scale", 1)):
        for item in top.items(f"link_{key}"):
            value = item.find(key)
            if value is not None and value.value != neutral:
                value.fail(f"is {short(value.value)}, which is not supported", "enlarge the meshes")
    data = top.find("world", "octomap", "octomap", "data")
    if data is not None and data.value:
        data.fail("is not read here", "save the map as a .bt file, and read that")


def merged(scene: PlanningScene, state: Node | None, robot: Robot, q: Floats) -> PlanningScene:
    """The scene with the attached objects of a request's start state, in which the robot is at q.

    As in MoveIt, they replace those of the scene where the state says is_diff: false.
    """
    links = link_poses(robot, q)
    objects = SceneObjects(links, dict(scene.objects))
    flag = None if state is None else state.find("is_diff")
    attached = dict(scene.attached) if flag is None or flag.value else {}
    attach_all(state, objects, attached, links)
    return PlanningScene(
        scene.name, objects.by_id, attached, scene.matrix, scene.state, scene.mount
    )
