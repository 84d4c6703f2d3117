// Motion of a robot by its drive: actions within limits, the configuration after a step, and actions that
// approach a target.
#pragma once

#include "robot/drives/kernel.h"
#include "robot/robot.h"

namespace fgenv {

// The actions in force for a step of dt seconds, in their own units: `command`, in [-1, 1] of the limits, as far
// as limits of rates allow after the actions `before`. `action` may be `before`.
void limit_action(const Drive& drive, const double* command, const double* before, double dt, double* action);

// The configuration after dt seconds. The base moves on the arc of a velocity that is constant in its own frame;
// coordinates stop at `lower` and `upper`.
void drive_forward(const Robot& robot, const Drive& drive, const double* action, const double* q, double dt,
                   double* out);

// A target configuration as seen from the base at q.
Offset base_offset(const Robot& robot, const double* q, const double* target);

// Velocity of the base's origin in its own frame.
Vec3 base_velocity(const Drive& drive, const double* action);

// Command in [-1, 1] that approaches a configuration and stops there: straight if the drive can, else it turns
// first; a car drives arcs that end in the target's heading. Ignores obstacles.
void approach_command(const Robot& robot, const Drive& drive, const double* q, const double* target, double dt,
                      double* command);

// A waypoint command, in [-1, 1]: x, y (z of a free base) and yaw of the base in its own frame, then the joints.
int32_t waypoint_size(const Robot& robot, const Drive& drive);
// The configuration of a waypoint command: at most as far as full speed reaches in `seconds`.
void waypoint_target(const Robot& robot, const Drive& drive, const double* q, const double* command, double seconds,
                     double* out);

}  // namespace fgenv
