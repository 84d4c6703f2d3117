// Configurations of a robot as they come from NumPy, checked.
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

// Finite, not beyond what sines take, quaternions of length 1 to a thousandth.
Configurations configurations(const Robot& robot, nb::handle value, const char* name);

}  // namespace fgenv
