// Checks of arguments that several bindings share.
#pragma once

#include "bind/arrays.h"

namespace fgenv {

static inline int threads_of(nb::handle value) {
    if (value.is_none()) return 0;
    int n = 0;
    if (!nb::try_cast(value, n) || n < 1 || n > 4096)
        throw nb::value_error(
            "threads: got a value out of range, expected an integer from 1 to 4096, or None for all cores");
    return n;
}

// Raises unless the value is finite and at least 0.
static inline double meters_of(double value, const char* name) {
    if (!(value >= 0) || std::isinf(value))
        throw nb::value_error(
            (std::string(name) + ": got " + std::to_string(value) + ", expected at least 0 meters").c_str());
    return value;
}

// Unit vector of three numbers that are not all 0. Scaled first: squares of very small or large numbers
// would underflow or overflow.
static inline Vec3 direction_of(const double* v) {
    const double most = greater(greater(std::fabs(v[0]), std::fabs(v[1])), std::fabs(v[2]));
    return unit({v[0] / most, v[1] / most, v[2] / most});
}

static inline Dims rows_of(const Array<double>& points) { return {points.dims.begin(), points.dims.end() - 1}; }

static inline Array<double> directions_of(nb::handle value, const char* name) {
    Array<double> d = points(value, name);
    for (size_t i = 0; i < d.view.size(); i += 3)
        if (d.data()[i] == 0 && d.data()[i + 1] == 0 && d.data()[i + 2] == 0)
            throw nb::value_error(
                (std::string(name) + "[" + std::to_string(i / 3) + "]: got length 0, expected a direction").c_str());
    return d;
}

}  // namespace fgenv
