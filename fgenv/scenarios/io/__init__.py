"""Files of other programs: YAML with line numbers, MoveIt scenes, ROS messages."""
