// The point of a path that lies ahead of a robot.
#pragma once

#include "simulator/episode.h"
#include "simulator/robot_spec.h"

namespace fgenv {

// The configuration at `look_ahead` (meters, or radians of joints) along the path after its point nearest to `q`; the
// end of the path if that is nearer.
std::vector<double> point_ahead(const RobotSpec& spec, const Waypoints& path, const double* q, double look_ahead);

}  // namespace fgenv
