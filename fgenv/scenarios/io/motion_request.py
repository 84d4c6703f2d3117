"""Motion plan requests of MoveIt: start and goal of the joints of a group."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path

from fgenv.robots import Robot
from fgenv.robots.srdf import read_srdf
from fgenv.scenarios.errors import ScenarioError, near, short

from .message_types import check_message
from .yaml_node import Node

MIMIC_TOLERANCE = 1e-3  # rad or m
NEUTRAL: dict[str, tuple[object, ...]] = {  # values without effect; others are not supported
    "max_velocity_scaling_factor": (0, 1),
    "max_acceleration_scaling_factor": (0, 1),
    "max_cartesian_speed": (0,),
    "cartesian_speed_end_effector_link": ("",),
    "cartesian_speed_limited_link": ("",),
}
CONSTRAINTS = ("position_constraints", "orientation_constraints", "visibility_constraints")


def check_request(request: Node) -> None:
    """Raise a ScenarioError for unknown keys, and for parts of a request that are not supported.

    The settings of MoveIt's own planners (planner_id, pipeline_id, num_planning_attempts,
    allowed_planning_time) do not change the problem. Nor do the bounds of the workspace, which hold
    for floating and planar joints: the base of the robot is fixed.
    """
    check_message(request, "MotionPlanRequest")
    for key, neutral in NEUTRAL.items():
        item = request.find(key)
        if item is not None and item.value not in neutral:
            item.fail(f"is {short(item.value)}, which is not supported", "set limits by the drive")
    paths = [
        request.find("path_constraints"),
        *request.items("trajectory_constraints", "constraints"),
    ]
    for item in paths:
        for key in ("joint_constraints", *CONSTRAINTS):
            if item is not None and (found := item.find(key)) is not None and found.value:
                found.fail("is not supported", "remove the constraints of the path")
    if (found := request.find("reference_trajectories")) is not None and found.value:
        found.fail("is not supported", "remove it")


def start_of(request: Node, robot: Robot, values: Mapping[str, float]) -> dict[str, float]:
    """Values of all moving joints by name at the start.

    Args:
        values: of joints by name; those of fixed joints have no effect.

    Raises:
        ScenarioError: a joint that is missing, unknown, or not where its mimicked joint puts it.
    """
    place = request.find("start_state", "joint_state") or request
    known = {joint.name: joint for joint in robot.joints}
    missing = [name for name in robot.coordinates if name not in values]
    problems = [place.problem(f"has no {name!r}", "add it") for name in missing]
    problems += [
        place.problem(f"{short(name)} is no joint of {robot.name!r}", near(name, known))
        for name in values
        if name not in known
    ]
    if problems:
        raise ScenarioError(request.path, problems)
    for name, value in values.items():
        if known[name].mimic is not None and known[name].moves:
            source, multiplier, offset = robot.mimic_sources[name]
            expected = multiplier * values[source.name] + offset
            if abs(value - expected) > MIMIC_TOLERANCE:
                text = f"{name!r} is {value:g}, but it follows {source.name!r}"
                place.fail(text, f"expected {expected:g}")
    return {name: values[name] for name in robot.coordinates}


def first_goal(request: Node) -> Node:
    """The first of a request's goal constraints, which are alternatives."""
    goal = next(request.items("goal_constraints"), None)
    if goal is None:
        request.fail("has no goal_constraints", "add joint constraints")
    for other in CONSTRAINTS:
        if (found := goal.find(other)) is not None and found.value:
            found.fail("is not read", "expected joint_constraints: solve for joint values first")
    return goal


def goal_of(goal: Node, joints: Collection[str]) -> dict[str, float]:
    """Values of joints by name, of goal constraints.

    Args:
        joints: names of the joints that move.
    """
    named: dict[str, float] = {}
    for item in goal.items("joint_constraints"):
        name = item.get("joint_name").text()
        if name not in joints:
            item.get("joint_name").fail(f"{name!r} is no joint that moves here", near(name, joints))
        if name in named:
            item.get("joint_name").fail(f"{name!r} stands twice", "keep one")
        named[name] = item.get("position").number()
    if not named:
        goal.fail("has no joint_constraints", "add one for each joint")
    return named


def moving_joints(request: Node, robot: Robot, srdf: Path | None) -> tuple[str, ...]:
    """Names of the joints with a coordinate in the request's group; all without a group.

    Raises:
        ScenarioError: a group without an SRDF, or one that the SRDF does not define.
    """
    place = request.find("group_name")
    if place is None or place.value == "":
        return robot.coordinates
    if srdf is None:
        place.fail(f"is {short(place.value)}", "expected srdf=, the file that defines the group")
    semantics = read_srdf(srdf, robot.name, robot.links, robot.joints)
    group = str(place.value)
    if group in semantics.faulty_groups:
        place.fail(f"is {short(group)}: {semantics.faulty_groups[group]}", f"correct {srdf.name}")
    if group not in semantics.groups:
        remedy = near(group, semantics.groups)
        place.fail(f"{short(group)} is no group of {srdf.name}", remedy)
    inside = semantics.groups[group]
    own = tuple(name for name in robot.coordinates if name in inside)
    if not own:
        place.fail(f"{short(place.value)} has no moving joint", "expected a group of the arm")
    return own
