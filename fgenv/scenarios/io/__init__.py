"""Files of other programs: MoveIt, ROS maps, MovingAI, OctoMap, point clouds, OMPL.app."""

from . import map_server, moveit, moving_ai, octomap, ompl_app, point_cloud

__all__ = ["map_server", "moveit", "moving_ai", "octomap", "ompl_app", "point_cloud"]
