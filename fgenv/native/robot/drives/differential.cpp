// Differential drive: the action is the speed along x, and the yaw rate.
#include "math/trig.h"
#include "robot/drives/kernel.h"

namespace fgenv {
namespace {

constexpr double max_course = 0.6;  // radians: farther off the course, the robot turns in place

Twist twist(const Drive&, const double* action) { return {action[0], 0, 0, action[1]}; }

void approach(const Drive& drive, const Offset& target, double dt, double* action) {
    const double d = std::sqrt(target.by[0] * target.by[0] + target.by[1] * target.by[1]);
    const bool away = d > arrival_distance;
    const double course = away ? arc_tangent(target.by[1], target.by[0]) : target.turn;
    const bool drives = away && std::fabs(course) < max_course;
    action[0] = drives ? stopping_speed(target.by[0], drive.limits[0].rate, dt) : 0;
    action[1] = stopping_speed(course, drive.limits[1].rate, dt);
}

const RegisterDrive differential{{"differential", 2, 0, twist, approach, limit_base}};

}  // namespace
}  // namespace fgenv
