// Drone: the action is the velocity along x, y and z, and the yaw rate.
#include "robot/drives/kernel.h"

namespace fgenv {
namespace {

Twist twist(const Drive&, const double* action) { return {action[0], action[1], action[2], action[3]}; }

void approach(const Drive& drive, const Offset& target, double dt, double* action) {
    stopping_velocity(drive.limits.data(), target.by, 3, dt, action);
    action[3] = stopping_speed(target.turn, drive.limits[3].rate, dt);
}

const RegisterDrive drone{{"drone", 4, 0, twist, approach, limit_base}};

}  // namespace
}  // namespace fgenv
