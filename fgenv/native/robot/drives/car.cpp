// Car: the action is the speed along x, and the steering angle.
#include "math/trig.h"
#include "robot/drives/kernel.h"

namespace fgenv {
namespace {

double wheelbase(const Drive& drive) { return drive.parameters[0]; }

Twist twist(const Drive& drive, const double* action) {
    double s, c;
    sin_cos(action[1], s, c);
    return {action[0], 0, 0, action[0] * s / (c * wheelbase(drive))};
}

// Pure pursuit (R. Coulter, 1992) of a point before the target, on the line of the final heading, which moves to
// the target as the car does.
void approach(const Drive& drive, const Offset& target, double dt, double* action) {
    const double d = std::sqrt(target.by[0] * target.by[0] + target.by[1] * target.by[1]);
    double s, c;
    sin_cos(target.turn, s, c);
    const double x = target.by[0] - 0.5 * d * c, y = target.by[1] - 0.5 * d * s, squared = x * x + y * y;
    action[0] = d > arrival_distance ? stopping_speed(d, drive.limits[0].rate, dt) : 0;
    action[1] = squared > 0 ? arc_tangent(2 * y * wheelbase(drive) / squared, 1) : 0;
    if (x < 0) action[1] = y < 0 ? drive.limits[1].low : drive.limits[1].high;  // behind: turn around
}

const RegisterDrive car{{"car", 2, 1, twist, approach, limit_base}};

}  // namespace
}  // namespace fgenv
