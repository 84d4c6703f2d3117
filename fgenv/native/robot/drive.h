// How a robot moves by its actions: a velocity that is asked for becomes one that its limits let it have,
// and that a configuration at the end of a step.
#pragma once

#include "robot/robot.h"

namespace fgenv {

enum class DriveKind : uint8_t { none, holonomic, differential, car, drone };

// Of one number of an action.
struct ActionLimit {
    double low, high;
    double rate;  // how much it may change in a second, either way; may be infinite
};

// A base's drive, then joints at a velocity each.
struct Drive {
    DriveKind base = DriveKind::none;
    double wheelbase = 1;              // of a car, meters
    std::vector<ActionLimit> limits;   // the base's actions, then the joints'
    std::vector<double> lower, upper;  // of configurations, (nq)

    int32_t n_actions() const { return static_cast<int32_t>(limits.size()); }
};

// How many of the actions are the base's.
static inline int32_t base_actions(DriveKind kind) {
    return kind == DriveKind::none ? 0 : kind == DriveKind::holonomic ? 3 : kind == DriveKind::drone ? 4 : 2;
}

// What is asked for, in [-1, 1] of the limits' middle and half width, as far as `before` may change to in
// dt seconds: the actions in their own units, in force all through the step. `action` may be `before`.
void limited(const Drive& drive, const double* asked, const double* before, double dt, double* action);

// The configuration after dt seconds. The base goes on the arc that its velocity, fixed in its own frame,
// draws; what would leave `lower` and `upper` stops there.
void drive_on(const Robot& robot, const Drive& drive, const double* action, const double* q, double dt, double* out);

// From the base's own frame: where a target's position is, and the turn to its direction (about the vertical).
struct Offset {
    double by[3], turn;
};
Offset offset_to(const Robot& robot, const double* q, const double* target);

// Velocity of the base's origin in its own frame, by the actions in force.
Vec3 velocity_of(const Drive& drive, const double* action);

// What to ask for to get to a configuration, slowing down in time: straight where the drive can, else
// turning towards it first, a car on arcs that end in its direction. It looks at no obstacles.
void toward(const Robot& robot, const Drive& drive, const double* q, const double* target, double dt, double* asked);

// A way point asked for, in [-1, 1]: x, y (z of a drone) and yaw of the base from where it is, in its own
// frame, then the joints; how many numbers, and the configuration. As far as the speeds reach in `seconds`.
int32_t way_point_size(const Robot& robot, const Drive& drive);
void way_point(const Robot& robot, const Drive& drive, const double* q, const double* asked, double seconds,
               double* out);

}  // namespace fgenv
