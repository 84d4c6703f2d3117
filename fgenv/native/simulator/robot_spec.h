// A robot of a scenario: its kinematic tree, drive and sensor, and where its episodes begin and end. Meters, radians.
#pragma once

#include <memory>
#include <vector>

#include "robot/drive.h"
#include "world/world.h"

namespace fgenv {

struct Lidar {
    double range = 0;
    Vec3 position{0, 0, 0};        // on the root link
    std::vector<Vec3> directions;  // in the root link's frame
};

// The same in all worlds.
struct RobotSpec {
    BodyId id = -1;
    std::shared_ptr<const Robot> robot;
    Drive drive;
    Lidar lidar;
    double position_tolerance = 0.1, angle_tolerance = 0.2;  // of the goal
    double radius = 0;                                       // of the robot's farthest point from its base
    std::vector<std::vector<double>> starts, goals;          // per case
    std::vector<BodyId> parts;                               // sorted

    int32_t base_size() const { return size(robot->joints[0].kind); }
    // Coordinates that measure the distance to the goal: the base's position, or the joints of a fixed base.
    int32_t position_size() const { return base_size() == 3 ? 2 : base_size() == 7 ? 3 : robot->nq(); }
    // Distance between two configurations over these coordinates.
    double distance(const double* from, const double* to) const;
};

}  // namespace fgenv
