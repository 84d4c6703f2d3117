// Mecanum drive: the action is the velocity along x and y, and the yaw rate; limits hold for the four wheels.
// Model: P. Muir and C. Neuman, "Kinematic modeling for feedback control of an omnidirectional wheeled mobile
// robot", 1987; K. Lynch and F. Park, "Modern Robotics", section 13.2.
#include "robot/drives/kernel.h"

namespace fgenv {
namespace {

struct Wheels {
    double arm;     // half track plus half wheelbase, meters
    double radius;  // meters
    double speed, acceleration;

    explicit Wheels(const Drive& drive)
        : arm(drive.parameters[0]),
          radius(drive.parameters[1]),
          speed(drive.parameters[2]),
          acceleration(drive.parameters[3]) {}

    // Speed of the fastest wheel: the wheels have all combinations of the signs.
    double fastest(const double* a) const {
        return (std::fabs(a[0]) + std::fabs(a[1]) + arm * std::fabs(a[2])) / radius;
    }
};

// Factor that brings a magnitude down to its limit.
double reduction(double magnitude, double limit) { return magnitude > limit ? limit / magnitude : 1; }

Twist twist(const Drive&, const double* action) { return {action[0], action[1], 0, action[2]}; }

// Half of the wheels' acceleration stops the translation, half the turn.
void approach(const Drive& drive, const Offset& target, double dt, double* action) {
    const Wheels wheels(drive);
    const double d = std::sqrt(target.by[0] * target.by[0] + target.by[1] * target.by[1]);
    const double rate = 0.5 * wheels.acceleration * wheels.radius;
    const double share = d > 0 ? (std::fabs(target.by[0]) + std::fabs(target.by[1])) / d : 1;
    const double speed = stopping_speed(d, rate / share, dt);
    for (int i = 0; i < 2; ++i) action[i] = d > 0 ? target.by[i] / d * speed : 0;
    action[2] = stopping_speed(target.turn, rate / wheels.arm, dt);
    const double factor = reduction(wheels.fastest(action), wheels.speed);
    for (int i = 0; i < 3; ++i) action[i] *= factor;
}

// Scales the desired velocity to the wheels' speed, then its change to their acceleration. Both keep the limits:
// velocities within the wheels' speed are a convex set.
void limit(const Drive& drive, const double* desired, const double* before, double dt, double* action) {
    const Wheels wheels(drive);
    const double factor = reduction(wheels.fastest(desired), wheels.speed);
    double change[3];
    for (int i = 0; i < 3; ++i) change[i] = factor * desired[i] - before[i];
    const double part = reduction(wheels.fastest(change), wheels.acceleration * dt);
    for (int i = 0; i < 3; ++i) action[i] = part < 1 ? before[i] + part * change[i] : factor * desired[i];
}

const RegisterDrive mecanum{{"mecanum", 3, 4, twist, approach, limit}};

}  // namespace
}  // namespace fgenv
