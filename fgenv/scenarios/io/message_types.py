"""Types of ROS messages, and the check of a file against them: unknown keys, wrong kinds of values.

The table has the fields of ROS 1 and ROS 2. A message whose fields are all numbers may also be a
list of them, as MotionBenchMaker writes it. Missing fields have their defaults.
"""

from __future__ import annotations

from collections.abc import Iterator

from fgenv.scenarios.errors import Problem, ScenarioError, near, short

from .yaml_node import Node

DEFINITIONS = """
PlanningScene: PlanningSceneWorld world, string name, RobotState robot_state,
  string robot_model_name,
  TransformStamped[] fixed_frame_transforms, AllowedCollisionMatrix allowed_collision_matrix,
  LinkPadding[] link_padding, LinkScale[] link_scale, ObjectColor[] object_colors,
  bool is_diff
PlanningSceneWorld: CollisionObject[] collision_objects, OctomapWithPose octomap
CollisionObject: Header header, Pose pose, string id, ObjectType type, SolidPrimitive[] primitives,
  Pose[] primitive_poses, Mesh[] meshes, Pose[] mesh_poses, Plane[] planes, Pose[] plane_poses,
  string[] subframe_names, Pose[] subframe_poses, code operation
AttachedCollisionObject: string link_name, CollisionObject object, string[] touch_links,
  JointTrajectory detach_posture, number weight
RobotState: JointState joint_state, MultiDOFJointState multi_dof_joint_state,
  AttachedCollisionObject[] attached_collision_objects, bool is_diff
JointState: Header header, string[] name, number[] position, number[] velocity, number[] effort
MultiDOFJointState: Header header, string[] joint_names, Transform[] transforms, Twist[] twist,
  Wrench[] wrench
MotionPlanRequest: WorkspaceParameters workspace_parameters, RobotState start_state,
  Constraints[] goal_constraints, Constraints path_constraints,
  TrajectoryConstraints trajectory_constraints, GenericTrajectory[] reference_trajectories,
  string pipeline_id, string planner_id, string group_name, number num_planning_attempts,
  number allowed_planning_time, number max_velocity_scaling_factor,
  number max_acceleration_scaling_factor, string cartesian_speed_end_effector_link,
  string cartesian_speed_limited_link, number max_cartesian_speed
WorkspaceParameters: Header header, Vector3 min_corner, Vector3 max_corner
Constraints: string name, JointConstraint[] joint_constraints,
  PositionConstraint[] position_constraints, OrientationConstraint[] orientation_constraints,
  VisibilityConstraint[] visibility_constraints
JointConstraint: string joint_name, number position, number tolerance_above,
  number tolerance_below, number weight
PositionConstraint: Header header, string link_name, Vector3 target_point_offset,
  BoundingVolume constraint_region, number weight
OrientationConstraint: Header header, Quaternion orientation, string link_name,
  number absolute_x_axis_tolerance, number absolute_y_axis_tolerance,
  number absolute_z_axis_tolerance, number parameterization, number weight
VisibilityConstraint: number target_radius, PoseStamped target_pose, number cone_sides,
  PoseStamped sensor_pose, number max_view_angle, number max_range_angle,
  code sensor_view_direction, number weight
BoundingVolume: SolidPrimitive[] primitives, Pose[] primitive_poses, Mesh[] meshes,
  Pose[] mesh_poses
TrajectoryConstraints: Constraints[] constraints
GenericTrajectory: Header header, JointTrajectory[] joint_trajectory,
  any[] cartesian_trajectory
JointTrajectory: Header header, string[] joint_names, any[] points
AllowedCollisionMatrix: string[] entry_names, AllowedCollisionEntry[] entry_values,
  string[] default_entry_names, bool[] default_entry_values
AllowedCollisionEntry: bool[] enabled
LinkPadding: string link_name, number padding
LinkScale: string link_name, number scale
ObjectColor: string id, any color
ObjectType: string key, string db
OctomapWithPose: Header header, Pose origin, Octomap octomap
Octomap: Header header, bool binary, string id, number resolution, any[] data
SolidPrimitive: code type, number[] dimensions, Polygon polygon
Polygon: any[] points
Mesh: MeshTriangle[] triangles, Vector3[] vertices
MeshTriangle: number[] vertex_indices
Plane: number[] coef
Header: number seq, any stamp, string frame_id
TransformStamped: Header header, string child_frame_id, Transform transform
Transform: Vector3 translation, Quaternion rotation
PoseStamped: Header header, Pose pose
Pose: Vector3 position, Quaternion orientation
Twist: Vector3 linear, Vector3 angular
Wrench: Vector3 force, Vector3 torque
Vector3: number x, number y, number z
Quaternion: number x, number y, number z, number w
"""


def _fields(text: str) -> dict[str, str]:
    """Types of the fields of a message by name."""
    return {name: kind for kind, name in (part.split() for part in text.split(","))}


MESSAGES: dict[str, dict[str, str]] = {
    name: _fields(text)
    for name, _, text in (
        line.partition(": ") for line in DEFINITIONS.strip().replace("\n  ", " ").split("\n")
    )
}
LISTS = {"AllowedCollisionEntry", "MeshTriangle", "Vector3", "Quaternion"}  # lists as well
PLAIN: dict[str, tuple[tuple[type, ...], str]] = {
    "string": ((str,), "a name, in quotes if it is a number"),
    "number": ((int, float), "a number"),
    "bool": ((bool,), "true or false"),
    "code": ((int, str), "a number or a name"),
}


def check_message(node: Node, kind: str) -> None:
    """Raise a ScenarioError with all unknown keys and wrong kinds of values of a message."""
    problems = list(_problems(node, kind))
    if problems:
        problems.sort(key=lambda problem: problem.line or 0)
        raise ScenarioError(node.path, problems)


def _problems(node: Node, kind: str) -> Iterator[Problem]:
    value = node.value
    if value is None or kind == "any":
        return
    if kind.endswith("[]"):
        if isinstance(value, list):
            for i, item in enumerate(value):
                yield from _problems(node.child(i, item), kind[:-2])
        else:
            yield node.problem(f"is {short(value)}", "expected a list")
    elif kind in PLAIN:
        types, expected = PLAIN[kind]
        if not isinstance(value, types) or (isinstance(value, bool) and bool not in types):
            yield node.problem(f"is {short(value)}", f"expected {expected}")
    elif not (kind in LISTS and isinstance(value, list)):
        yield from _field_problems(node, kind)


def _field_problems(node: Node, kind: str) -> Iterator[Problem]:
    fields = MESSAGES[kind]
    if not isinstance(node.value, dict):
        yield node.problem(f"is {short(node.value)}", f"expected a table with {', '.join(fields)}")
        return
    for key, value in node.value.items():
        if key in fields:
            yield from _problems(node.child(key, value), fields[key])
        else:
            yield node.child(key, value).problem("is no known key", near(key, fields))
