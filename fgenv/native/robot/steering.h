// Steering functions: local motions of a robot in free space, as legs that are straight.
#pragma once

#include "robot/robot.h"

namespace fgenv {

// straight: as `interpolate`. turn_drive_turn: turns in place, drives straight (backward if that turns less),
// turns in place. dubins, reeds_shepp: the shortest path of a car, forward only or in both directions.
enum class SteeringMethod : uint8_t { straight, turn_drive_turn, dubins, reeds_shepp };

struct Steering {
    SteeringMethod method = SteeringMethod::straight;
    double radius = 1;    // a car's turning radius, meters
    bool reverse = true;  // whether turn_drive_turn may drive backward
};

// Configurations at the ends of the legs, row by row (nq each), from q0 to q1 inclusive. A car's arcs are split
// into chords of at most a tenth of a radian. Joints move along the whole motion.
void legs(const Robot& robot, const Steering& steering, const double* q0, const double* q1, std::vector<double>& rows);

}  // namespace fgenv
