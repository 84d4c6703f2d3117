// Checks of a drive against a robot.
#pragma once

#include "robot/drive.h"

namespace fgenv {

// Raises ValueError if the drive does not fit the robot.
void check_fits(const Robot& robot, const Drive& drive);

}  // namespace fgenv
