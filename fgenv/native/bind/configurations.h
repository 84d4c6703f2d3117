// Checked configurations of a robot from NumPy.
#pragma once

#include "bind/arrays.h"
#include "robot/robot.h"

namespace fgenv {

struct Configurations {
    Array<double> array;
    Dims dims;  // without the last
    int32_t nq;

    const double* row(int64_t i) const { return array.data() + i * nq; }
};

// Checks that values are finite and within the limit of sin_cos, and that quaternions have length 1 to 0.001.
Configurations configurations(const Robot& robot, nb::handle value, const char* name);

}  // namespace fgenv
