// Holonomic drive: the action is the velocity along x and y, and the yaw rate.
#include "robot/drives/kernel.h"

namespace fgenv {
namespace {

Twist twist(const Drive&, const double* action) { return {action[0], action[1], 0, action[2]}; }

void approach(const Drive& drive, const Offset& target, double dt, double* action) {
    stopping_velocity(drive.limits.data(), target.by, 2, dt, action);
    action[2] = stopping_speed(target.turn, drive.limits[2].rate, dt);
}

const RegisterDrive holonomic{{"holonomic", 3, 0, twist, approach, limit_base}};

}  // namespace
}  // namespace fgenv
